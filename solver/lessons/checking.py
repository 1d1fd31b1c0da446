"""Testing what a lesson claims, by runs of the engine."""

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
class Said:
    """A verdict, and what the status of the run says."""

    checkpoint: EndingClaim
    words: str

    @property
    def holds(self) -> bool:
        """Whether the claim holds."""
        return self.checkpoint.says in self.words


def check(lesson: Lesson) -> Iterator[CheckedClaim | Said]:
    """Measure what a lesson claims, in order; checkpoints of equal settings share a run."""
    wanted: defaultdict[str, set[str | None]] = defaultdict(set)
    for one in lesson.checkpoints:
        reads = one.reading.quantity.reads if isinstance(one, Claim) else None
        wanted[dump(one.settings)].add(reads)
    runs: dict[str, FinishedRun] = {}
    for one in lesson.checkpoints:
        key = dump(one.settings)
        if key not in runs:
            every = wanted[key]
            runs[key] = finished_run(
                one.settings, errors="errors" in every, indicators="indicators" in every
            )
        yield _outcome(one, runs[key], lesson.instant)


def _outcome(one: Claim | EndingClaim, run: FinishedRun, instant: float) -> CheckedClaim | Said:
    if isinstance(one, EndingClaim):
        return Said(one, run.solution.status.advice)
    taken = one.reading.quantity.at_instant
    place = round(instant * (run.problem.n_instants - 1))
    return CheckedClaim(one, one.reading(run), None if taken is None else taken(run, place))
