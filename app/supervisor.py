"""The supervisor of a page's worker, which restarts a worker that ends or hangs."""

from __future__ import annotations

import time
from collections import deque
from typing import Any

from app.messages import Alive, Order, Report, Start
from app.server import PAGES
from app.state import PageState
from app.worker.process import Worker

LOOK = 1000
"""Time between two looks at the worker, ms."""
STUCK = 3.0
"""Longest time that a worker may take to begin another run, s."""
ENDED = "The solver's process ended; the run was started anew."
HANGS = "The solver gave no sign of life for some seconds; the run was started anew."
GIVEN_UP = (
    "The solver's process ended twice in this run: change a setting, or choose fewer "
    "elements and instants."
)


class Supervisor:
    """Link between a page and its worker: orders to the worker, reports to the page.

    A worker that ends, hangs, or does not begin a run in time is replaced, and the run
    begins again; a run that has failed twice waits for another setting.
    """

    def __init__(self, state: PageState, document: Any) -> None:
        self._state = state
        self._document = document
        self._worker: Worker | None = None
        self._asked = time.monotonic()
        # How often the run of this number has failed.
        self._failed = 0
        self._failed_in = 0
        self._reports: deque[tuple[Worker, Report | None]] = deque()
        self._is_open = False
        document.add_periodic_callback(self._look, LOOK)

    def begin(self) -> None:
        """Start the worker."""
        self._state.send = self._send
        self._worker = Worker(self._on_report, others=max(PAGES.count - 1, 0))
        self._state.send_needs()

    def open(self) -> None:
        """Process reports from now on, as the browser is connected."""
        self._is_open = True
        self._asked = time.monotonic()
        self.take()

    def end(self) -> None:
        """End the worker."""
        if self._worker is not None:
            self._worker.end()
            self._worker = None

    def take(self) -> None:
        """Process the reports that have arrived."""
        while self._reports:
            worker, report = self._reports.popleft()
            if worker is not self._worker:
                # The last words of a worker that was replaced.
                continue
            if report is None:
                self._restart(ENDED)
            else:
                self._state.take(report)

    def _send(self, order: Order) -> None:
        """Send an order, and store the time of an ordered run."""
        if isinstance(order, Start):
            self._asked = time.monotonic()
        if self._worker is not None:
            self._worker.send(order)

    def _on_report(self, worker: Worker, report: Report | None) -> None:
        """Pass a report to the thread of the document, after the page has loaded."""
        if not isinstance(report, Alive):
            self._reports.append((worker, report))
            if self._is_open:
                # A callback that is added while a session is created gets lost.
                self._document.add_next_tick_callback(self.take)

    def _look(self) -> None:
        """Replace a worker that hangs, or does not begin the next run in time."""
        if self._worker is None or not self._is_open:
            return
        is_stuck = self._state.began != self._state.number
        if self._worker.hangs:
            self._restart(HANGS)
        elif is_stuck and time.monotonic() - self._asked > STUCK:
            self._restart("")

    def _restart(self, message: str) -> None:
        """Run the settings in a new process, unless two processes have failed."""
        state = self._state
        self.end()
        # Without a message the worker was only slow: that is no failure of the run.
        if message and state.number == self._failed_in:
            self._failed += 1
        else:
            self._failed = 1
        self.begin()
        if self._failed > 2:
            state.message = GIVEN_UP
            return
        state.run()
        self._failed_in = state.number if message else 0
        state.message = message
