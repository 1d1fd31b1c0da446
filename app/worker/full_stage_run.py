"""The full linear stage beside a run on separated bases: what the bases are measured against."""

from __future__ import annotations

from solver.discrete import Problem
from solver.latin import Ending, Record, StopRules, record
from solver.latin.warm import Start, iterations_from
from solver.reference.distance import Distance
from solver.scenes.method import method_of
from solver.settings import Settings


class FullStageRun:
    """The same run with the full linear stage, iteration by iteration, on a clock of its own.

    Parameters
    ----------
    problem, settings
        Of the run on separated bases.
    start
        Where the run on separated bases started, if that was chosen: this one starts there too.
    """

    def __init__(self, problem: Problem, settings: Settings, start: Start | None) -> None:
        full = settings.replace(linear_stage="full", finish="none")
        self._number = 0
        self._rules = StopRules(method_of(full))
        self._ended = False
        self._generator = iterations_from(problem, method_of(full), start, None)

    def follow(self, number: int, distance: Distance | None) -> list[Record]:
        """Catch up with an iteration, unless it has ended before; give the new records."""
        records: list[Record] = []
        while not self._ended and self._number < number:
            iterate = next(self._generator)
            verdict = self._rules.judge(iterate)
            status = verdict.status
            self._ended = status is not None
            if status is None or status.ending is not Ending.DIVERGED:
                self._number = iterate.number
                records.append(record(iterate, verdict, distance))
        return records
