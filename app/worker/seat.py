"""A session's place in the pool: what it wants to run, and how far that has come."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from app.worker.orders import Pace, Run, Seek, Step, Watch
from app.worker.reports import Died, Report

if TYPE_CHECKING:
    from app.worker.pool import Pool
    from app.worker.post import Post

Change = Pace | Step | Seek | Watch
Listener = Callable[[Report], None]

QUANTUM = 0.5
"""Seconds of work, once set up, after which a run makes room for one that waits."""

RESTARTS = 2
"""Times that a run is started again after its process died."""

AGAIN = "The worker stopped unexpectedly; the run was started again."
GIVEN_UP = (
    "The worker stopped unexpectedly several times; the run was given up. Lower the numbers of "
    "elements and instants, or start it again."
)


class Seat:
    """One session's place: at most one run, which the pool gives a process when it can.

    Attributes without documentation belong to the roster, and are guarded by the pool's lock.

    Parameters
    ----------
    pool
        Where it is a place in.
    listener
        Takes the reports of its runs, on a thread of the pool. A report that was on its way may
        still come just after another run was ordered; its ticket tells.
    """

    def __init__(self, pool: Pool, listener: Listener) -> None:
        self._pool = pool
        self.listener = listener
        self.closed = False
        self.ticket = -1
        self.first: Run | None = None
        self.next: Run | None = None
        self.pending: list[Change] = []
        self.post: Post | None = None
        self.held = False
        self.done = 0
        self.restarts = 0
        self.unanswered = 0
        self.fruitless = 0

    def run(self, order: Run) -> None:
        """Run this in place of the former run of this seat."""
        self._pool.run(self, order)

    def send(self, order: Change) -> None:
        """Pass an order to the run with its ticket; a run that is not at work is put to work."""
        self._pool.send(self, order)

    def close(self) -> None:
        """Stop the run and free its process; afterwards all orders are ignored."""
        self._pool.leave(self)

    @property
    def parked(self) -> Run | None:
        """The order that would go on with a run that is not at work, or that it started from."""
        if self.next is None or self.post is not None:
            return None
        return replace(self.next, previous=None) if self.next.resume else self.next.previous

    @property
    def others_at_work(self) -> int:
        """Runs of other seats that are at work, and not only waiting."""
        return self._pool.at_work_beside(self)

    def begin(self, order: Run) -> None:
        """Take up a new run."""
        self.ticket = order.ticket
        self.first = self.next = order
        self.pending = []
        self.held = False
        self.done = order.resume.iteration if order.resume else 0
        self.restarts = self.unanswered = self.fruitless = 0

    def forget(self) -> None:
        """Give up the run."""
        self.first = self.next = None
        self.pending = []
        self.held = False

    def lose(self) -> Died:
        """Go back to the beginning after the process died, or give up; say which."""
        self.restarts += 1
        again = self.restarts <= RESTARTS
        if again:
            self.next, self.done, self.pending, self.held = self.first, 0, [], True
        else:
            self.forget()
        return Died(self.ticket, AGAIN if again else GIVEN_UP, again)

    def note(self, change: Change) -> None:
        """Remember what a restart of the run has to know."""
        if self.first is None:
            return
        match change:
            case Pace(pace=0):
                self.first = replace(self.first, pause_after=max(self.done, 1))
            case Pace(pace=pace):
                self.first = replace(self.first, pace=pace, pause_after=None)
            case Step():
                self.first = replace(self.first, pause_after=self.done + 1)
            case Watch(watch=watch, substructure=substructure, look=look):
                self.first = replace(self.first, watch=watch, substructure=substructure, look=look)

    def postpone(self, change: Change) -> None:
        """Keep an order for when the run is at work; it takes the place of its like."""
        if not isinstance(change, Step):
            self.pending = [kept for kept in self.pending if type(kept) is not type(change)]
        self.pending.append(change)
