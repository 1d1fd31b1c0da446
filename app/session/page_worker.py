"""The worker process of a page, another one after the last is gone, and what it has said."""

from __future__ import annotations

import logging
import threading
from collections import deque
from collections.abc import Callable
from functools import partial

from app.session.classroom import Seat
from app.wire.orders import Order
from app.wire.reports import Died, Report
from app.worker.link import Link

RESTARTS = 2
"""Times that a run is started again after its process died, without getting any farther."""
AGAIN = "The worker stopped unexpectedly; the run was started again."
GIVEN_UP = (
    "The worker stopped unexpectedly several times; the run was given up. Lower the numbers of "
    "elements and instants, or start it again."
)
_log = logging.getLogger(__name__)
Hire = Callable[[Callable[[Report], None]], Link | Seat]
"""Gives a worker process, or a seat in a class; its reports go to what it is called with."""


class PageWorker:
    """At most one process at a time; reports arrive on another thread and wait for `collect`.

    Attributes
    ----------
    link
        The process, if there is one.
    wake
        Called on another thread when a report has come.
    deaths
        How often it has died since the run began, or since that got farther than ever.
    is_alone
        Whether nobody sees the page.
    """

    def __init__(self, hire: Hire) -> None:
        self.link: Link | Seat | None = None
        self.wake: Callable[[], object] = lambda: None
        self.deaths = self._reached = 0
        self.is_alone = False
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
            self.deaths += 1
            _log.error("A worker process ended, %d in a row.", self.deaths)
        return reports

    def change(self, hire: Hire) -> None:
        """Have the work done elsewhere."""
        self.part()
        self._hire = hire

    @property
    def has_process(self) -> bool:
        """Whether a process works for this page alone."""
        return isinstance(self.link, Link)

    def renew(self) -> None:
        """Take it that another run begins."""
        self.deaths = self._reached = 0

    def note(self, done: int) -> None:
        """Take it that the run has done so many iterations."""
        if done > self._reached:
            self.deaths, self._reached = 0, done

    @property
    def may_try_again(self) -> bool:
        """Whether the run has not been given up yet."""
        return self.deaths <= RESTARTS

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
