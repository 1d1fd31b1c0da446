"""Testing what a lesson claims, by runs of the engine."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass

from solver.checked import dump
from solver.lessons.lesson import Checkpoint, Lesson
from solver.study.finished import FinishedRun, finished_run


@dataclass(frozen=True, eq=False)
class Outcome:
    """A checkpoint, and what was measured, in the unit of its quantity."""

    checkpoint: Checkpoint
    value: float

    @property
    def holds(self) -> bool:
        """Whether the claim holds."""
        return self.checkpoint.expected.holds(self.value)


def check(lesson: Lesson) -> Iterator[Outcome]:
    """Measure what a lesson claims, in order; checkpoints of equal settings share a run."""
    wanted: defaultdict[str, set[str | None]] = defaultdict(set)
    for one in lesson.checkpoints:
        wanted[dump(one.settings)].add(one.reading.quantity.reads)
    runs: dict[str, FinishedRun] = {}
    for one in lesson.checkpoints:
        key = dump(one.settings)
        if key not in runs:
            reads = wanted[key]
            runs[key] = finished_run(
                one.settings, errors="errors" in reads, indicators="indicators" in reads
            )
        yield Outcome(one, one.reading(runs[key]))
