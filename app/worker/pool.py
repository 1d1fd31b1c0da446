"""The pool: all sessions of a server share a few worker processes, and none can hold up another.

At most `size` runs are at work at a time; one more process is kept warm, so that a process that
does not answer is replaced at once. What may happen to runs and processes is written down in
`roster`; here are the threads around it. One lock guards the roster and all seats:

    callers' threads    Seat.run, send, close
    one per process     reports, and the end of the process (`member`)
    the clock's         answers that are overdue, and runs that have had their time

Whoever holds the lock never waits: starting a process and writing to its pipe are left to the
members' threads. Listeners are called without the lock, by the thread that read the report, so
those of one process come in order; a run goes on in another process only after its Parked, or
its Died, was the last of the former one.
"""

from __future__ import annotations

import atexit
import contextlib
import logging
import math
import os
import threading
from collections.abc import Iterator
from time import monotonic

from app.worker.member import Member
from app.worker.orders import Run
from app.worker.reports import Ready, Refused, Report
from app.worker.roster import Delivery, Roster
from app.worker.seat import Change, Listener, Seat

PATIENCE_AT_CLOSE = 5.0

_log = logging.getLogger(__name__)


class Pool:
    """Worker processes shared by seats.

    Parameters
    ----------
    size
        Runs that may be at work at the same time; by default, one per processor.
    """

    def __init__(self, size: int | None = None) -> None:
        self._roster = Roster(size or os.cpu_count() or 1, self._hire)
        self._changed = threading.Condition(threading.Lock())
        self._closed = False
        self._alarm = math.inf
        self._clock: threading.Thread | None = None

    def seat(self, listener: Listener) -> Seat:
        """Give a new session its place, and have a process ready for it."""
        with self._roster_in_order():
            return Seat(self, listener)

    def run(self, seat: Seat, order: Run) -> None:
        """See `Seat.run`."""
        with self._roster_in_order() as roster:
            if roster and not seat.closed:
                roster.run(seat, order)

    def send(self, seat: Seat, change: Change) -> None:
        """See `Seat.send`."""
        with self._roster_in_order() as roster:
            if roster and not seat.closed:
                roster.send(seat, change)

    def leave(self, seat: Seat) -> None:
        """See `Seat.close`."""
        with self._roster_in_order() as roster:
            if roster and not seat.closed:
                roster.leave(seat)
            seat.closed = True

    def at_work_beside(self, seat: Seat) -> int:
        """See `Seat.others_at_work`."""
        with self._changed:
            return 0 if self._closed else self._roster.at_work_beside(seat)

    @property
    def pids(self) -> list[int]:
        """Numbers of the processes that have started."""
        with self._changed:
            members = [] if self._closed else self._roster.members
        return [member.pid for member in members if member.pid is not None]

    def close(self) -> None:
        """End all processes; afterwards all orders are ignored."""
        with self._changed:
            members = [] if self._closed else self._roster.members
            self._closed = True
            self._changed.notify()
        for member in members:
            member.kill()
        for member in members:
            member.join(PATIENCE_AT_CLOSE)

    @contextlib.contextmanager
    def _roster_in_order(self) -> Iterator[Roster | None]:
        """Give the roster, locked, and tend it afterwards; None once the pool is closed."""
        with self._changed:
            if self._closed:
                yield None
                return
            yield self._roster
            self._roster.tend()
            if self._clock is None:
                self._clock = threading.Thread(target=self._watch, name="pool-clock", daemon=True)
                self._clock.start()
            elif self._roster.next_due() < self._alarm:
                self._changed.notify()

    def _watch(self) -> None:
        with self._changed:
            while not self._closed:
                self._roster.tend()
                self._alarm = self._roster.next_due()
                rest = None if self._alarm == math.inf else max(self._alarm - monotonic(), 0.0)
                self._changed.wait(rest)

    def _hire(self) -> Member:
        return Member(self._received, self._gone)

    def _received(self, member: Member, report: Report | Ready) -> None:
        if isinstance(report, Refused) and report.trace:
            _log.error("A run broke.\n%s", report.trace)
        with self._roster_in_order() as roster:
            delivery = roster.report(member, report) if roster else None
        _deliver(delivery)

    def _gone(self, member: Member) -> None:
        with self._roster_in_order() as roster:
            delivery = roster.gone(member) if roster else None
        _deliver(delivery)
        if delivery is not None:
            with self._roster_in_order() as roster:
                if roster:
                    roster.go_on(delivery[0])


def _deliver(delivery: Delivery | None) -> None:
    if delivery is None:
        return
    seat, report = delivery
    try:
        seat.listener(report)
    except Exception:
        _log.exception("A session failed to take a report.")


_shared: list[Pool] = []
_sharing = threading.Lock()


def shared_pool() -> Pool:
    """Give the pool that all sessions of this server share; it ends with the server."""
    with _sharing:
        if not _shared:
            _shared.append(Pool())
            atexit.register(_shared[0].close)
        return _shared[0]
