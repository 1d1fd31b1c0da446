"""A worker process as tests hold it, and the pictures that it should send."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest
from processes import PATIENCE

from app.worker import link
from app.worker.orders import Look, Order
from app.worker.reports import Frame, Progress, Report
from app.worker.sampler import Sampler
from solver.latin import Iterate, Record
from solver.scenes.bar import BarSettings

SHORT = {"method": "paper", "tolerance": 1e-8, "max_iterations": 50}
STALLING = {
    "method": "paper",
    "tolerance": 1e-30,
    "elements": 20,
    "substructures": 4,
    "max_iterations": 150,
}


class Line:
    """A worker process and all that it has said."""

    def __init__(self) -> None:
        self.process, self.connection = link.start()
        self.reports: list[Report] = []

    def close(self) -> None:
        self.process.kill()
        self.process.join()
        self.connection.close()

    def send(self, *orders: Order) -> None:
        for order in orders:
            self.connection.send(order)

    def until(self, *kinds: type, ticket: int = 1) -> Any:
        """Listen until a report of one of these kinds comes."""
        end = time.monotonic() + PATIENCE
        while self.connection.poll(max(end - time.monotonic(), 0.0)):
            report: Any = self.connection.recv()
            self.reports.append(report)
            if report.ticket == ticket and isinstance(report, kinds):
                return report
        pytest.fail(f"no report of kind {kinds}")

    def all(self, kind: type, ticket: int = 1) -> list[Any]:
        said: list[Any] = [report for report in self.reports if isinstance(report, kind)]
        return [report for report in said if report.ticket == ticket]

    def records(self, ticket: int = 1) -> list[Record]:
        return [record for part in self.all(Progress, ticket) for record in part.records]


def shown(iterate: Iterate) -> Frame:
    sampler = Sampler(iterate.problem, BarSettings.checked({"method": "paper"}), Look())
    return sampler.frame(1, iterate, frozenset(), Look())


def is_same_picture(frame: Frame, other: Frame) -> bool:
    return (
        frame.iteration == other.iteration
        and np.array_equal(frame.friction, other.friction)
        and np.array_equal(frame.status, other.status)
        and np.array_equal(frame.end_displacement, other.end_displacement)
    )
