"""What a lesson claims, tested by runs of the engine."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass

from solver.checked import dump
from solver.lessons.lesson import Claim, EndingClaim, Lesson
from solver.study.quantities.finished import FinishedRun, finished_run


@dataclass(frozen=True, eq=False)
class CheckedClaim:
    """A checkpoint, and what was measured, in the unit of its quantity.

    Attributes
    ----------
    seen
        The same at the instant at which the plots of the lesson stand, for what is of one instant.
    """

    checkpoint: Claim
    value: float
    seen: float | None = None

    @property
    def holds(self) -> bool:
        """Whether the claim holds, and plots show it."""
        values = [self.value] if self.seen is None else [self.value, self.seen]
        return all(map(self.checkpoint.expected.holds, values))


@dataclass(frozen=True, eq=False)
class CheckedEnding:
    """A claim about how a run ends, and what the status of the run says."""

    checkpoint: EndingClaim
    message: str

    @property
    def holds(self) -> bool:
        """Whether the claim holds."""
        return self.checkpoint.says in self.message


def check(lesson: Lesson) -> Iterator[CheckedClaim | CheckedEnding]:
    """Measure what a lesson claims, in order; checkpoints of equal settings share a run."""
    wanted: defaultdict[str, set[str | None]] = defaultdict(set)
    for claim in lesson.checkpoints:
        reads = claim.reading.quantity.reads if isinstance(claim, Claim) else None
        wanted[dump(claim.settings)].add(reads)
    runs: dict[str, FinishedRun] = {}
    for claim in lesson.checkpoints:
        key = dump(claim.settings)
        if key not in runs:
            kinds = wanted[key]
            runs[key] = finished_run(
                claim.settings, errors="errors" in kinds, indicators="indicators" in kinds
            )
        run = runs[key]
        if isinstance(claim, EndingClaim):
            yield CheckedEnding(claim, run.solution.status.advice)
            continue
        at_instant = claim.reading.quantity.at_instant
        place = round(lesson.instant * (run.problem.n_instants - 1))
        seen = None if at_instant is None else at_instant(run, place)
        yield CheckedClaim(claim, claim.reading(run), seen)
