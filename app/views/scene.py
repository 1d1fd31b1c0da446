"""What is looked at in one moment: an iterate of a run, with what it is compared with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from app.picture.bathtub import Bathtub
from app.picture.frames import DrawnFields
from app.picture.recording import Recording
from app.picture.sampler import Frame
from app.picture.shown import Look, instant_of
from solver.phrases import Phrase
from solver.study.other_programs.beside import Beside


@dataclass(frozen=True)
class Scene:
    """What is looked at in one moment.

    Attributes
    ----------
    run, before
        The run at work, and what it is compared with: the last one worth it, or run A.
    past
        Finished runs, oldest first.
    frame
        The fields that are shown.
    instant
        Index of the chosen instant.
    look
        Where one looks.
    is_paired
        Whether `before` is a run A, which goes in step with the run at work, B.
    shadow
        The iterate of `before` that is drawn beside that of the run at work.
    beside
        Results of another program, laid beside the run; None where there are none of its scene.
    bathtub
        Iterations over k of the runs that are like the one at work; None beside a run A.
    """

    run: Recording
    before: Recording | None
    past: Sequence[Recording]
    frame: Frame
    instant: int
    look: Look
    is_paired: bool = False
    shadow: Frame | None = None
    beside: Beside | None = None
    bathtub: Bathtub | None = None

    @property
    def name(self) -> str:
        """What the run at work is called in legends."""
        return "B" if self.is_paired else "LATIN"

    @property
    def other(self) -> str:
        """What it is compared with is called."""
        return "A" if self.is_paired else "run before"

    @property
    def ghost_name(self) -> str:
        """What it is compared with is called where fields are drawn, with their iteration."""
        before = self.before
        return Phrase(
            "{}, {}", self.other, before.called(before.shown) if before else "iteration 0"
        )

    @property
    def length(self) -> float:
        """Length of the bodies, m, or of those of the ghost, if these are longer.

        Of a strand that is bent alike all along, of the wire that is chosen.
        """
        compared = [self.run, self.before] if self.before and self.ghost else [self.run]
        return max(one.stand.length or one.settings.length for one in compared)

    @property
    def ghost(self) -> tuple[Recording, DrawnFields, int] | None:
        """The run before, its fields and its instant, where they are of the same interface."""
        fields = self.before.frame if self.before else None
        if self.before is None or fields is None or fields.interface != self.frame.fields.interface:
            return None
        return self.before, fields, instant_of(self.look.phase, fields.friction.shape[1])
