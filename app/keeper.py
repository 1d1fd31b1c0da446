"""The worker process of a page, another one after the last is gone, and what it has said."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from functools import partial

from app.worker.link import Link
from app.worker.orders import Order
from app.worker.reports import Died, Report

Hire = Callable[[Callable[[Report], None]], Link]
"""Gives a worker process, whose reports go to what it is called with."""


class Keeper:
    """At most one process at a time; reports arrive on another thread and wait for `collect`.

    Attributes
    ----------
    link
        The process, if there is one.
    wake
        Called on another thread when a report has come.
    """

    def __init__(self, hire: Hire) -> None:
        self.link: Link | None = None
        self.wake: Callable[[], object] = lambda: None
        self._hire = hire
        self._hired = 0
        self._closed = False
        self._mailbox: deque[tuple[int, Report]] = deque()
        self._lock = threading.Lock()

    def begin(self, *orders: Order) -> None:
        """Have a process; one that is new is given these orders first."""
        if self.link is None and not self._closed:
            self._hired += 1
            self.link = self._hire(partial(self._receive, self._hired))
            for order in orders:
                self.send(order)

    def send(self, order: Order) -> None:
        """Send an order to the process, if there is one."""
        if self.link is not None:
            self.link.send(order)

    def collect(self) -> list[Report]:
        """Take what the present process has said; one that has died is gone afterwards."""
        with self._lock:
            reports = [report for number, report in self._mailbox if number == self._hired]
            self._mailbox.clear()
        if any(isinstance(report, Died) for report in reports):
            self.link = None
        return reports

    def part(self) -> None:
        """End the process, and hear nothing more of it."""
        if self.link is not None:
            self.link.close()
            self.link = None

    def close(self) -> None:
        """End the process for good."""
        self._closed = True
        self.wake = lambda: None
        self.part()

    def _receive(self, number: int, report: Report) -> None:
        with self._lock:
            self._mailbox.append((number, report))
        self.wake()
