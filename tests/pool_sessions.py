"""Sessions of a pool as tests hold them: a seat, and what was heard there."""

from __future__ import annotations

import queue
import time
from typing import Any

import pytest
from direct_runs import timeless
from processes import PATIENCE

from app.worker.pool import Pool
from app.worker.reports import Died, Progress, Report
from solver.latin import Record

SOON = 2.0
SMALL = {"method": "paper", "elements": 20, "substructures": 4, "tolerance": 1e-30}
SHORT = {**SMALL, "max_iterations": 60}
ENDLESS = {**SMALL, "max_iterations": 150}


class Session:
    """A seat and what its listener heard, with the time."""

    def __init__(self, pool: Pool) -> None:
        self.heard: queue.SimpleQueue[Report] = queue.SimpleQueue()
        self.reports: list[Report] = []
        self.times: dict[int, float] = {}
        self.seat = pool.seat(self._hear)

    def _hear(self, report: Report) -> None:
        if isinstance(report, Progress):
            self.times.update(
                dict.fromkeys((r.iteration for r in report.records), time.monotonic())
            )
        self.heard.put(report)

    def until(self, *kinds: type, ticket: int = 1, patience: float = PATIENCE) -> Any:
        """Listen until a report of one of these kinds comes."""
        end = time.monotonic() + patience
        while True:
            try:
                report = self.heard.get(timeout=max(end - time.monotonic(), 0.0))
            except queue.Empty:
                said = [type(report).__name__ for report in self.reports]
                pytest.fail(f"no report of kind {kinds} after {said}", pytrace=False)
            self.reports.append(report)
            if isinstance(report, kinds) and report.ticket == ticket:
                return report

    def records(self, ticket: int = 1) -> list[Record]:
        """Give the records since the process last died."""
        found: list[Record] = []
        for report in self.reports:
            if report.ticket == ticket and isinstance(report, Died):
                found.clear()
            elif report.ticket == ticket and isinstance(report, Progress):
                found.extend(timeless(report.records))
        return found

    @property
    def pid(self) -> int:
        assert self.seat.post is not None
        assert self.seat.post.member.pid is not None
        return self.seat.post.member.pid
