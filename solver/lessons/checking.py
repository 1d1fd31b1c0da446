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
        found = [self.value] if self.seen is None else [self.value, self.seen]
        return all(map(self.checkpoint.expected.holds, found))


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
    for one in lesson.checkpoints:
        reads = one.reading.quantity.reads if isinstance(one, Claim) else None
        wanted[dump(one.settings)].add(reads)
    runs: dict[str, FinishedRun] = {}
    for one in lesson.checkpoints:
        key = dump(one.settings)
        if key not in runs:
            kinds = wanted[key]
            runs[key] = finished_run(
                one.settings, errors="errors" in kinds, indicators="indicators" in kinds
            )
        run = runs[key]
        if isinstance(one, EndingClaim):
            yield CheckedEnding(one, run.solution.status.advice)
            continue
        at_instant = one.reading.quantity.at_instant
        place = round(lesson.instant * (run.problem.n_instants - 1))
        seen = None if at_instant is None else at_instant(run, place)
        yield CheckedClaim(one, one.reading(run), seen)
