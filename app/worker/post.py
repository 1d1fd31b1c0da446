"""A process of the pool, with what it does at present."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from app.worker.reports import Parked, Taken
from app.worker.seat import QUANTUM

if TYPE_CHECKING:
    from app.worker.member import Member
    from app.worker.seat import Seat


@dataclass(eq=False)
class Post:
    """A process with what it does.

    Attributes
    ----------
    ready
        Whether it listens yet; before, no answer is overdue.
    turn
        Ticket of the Run last sent to it.
    since
        When the seat's work here began, not counting the time for setting up.
    set_up_since
        When the run at work was taken, until it is set up; then None.
    idle
        Whether the run has told that it waits.
    awaited, deadline
        Kind of report that has to come, and until when.
    """

    member: Member
    ready: bool = False
    seat: Seat | None = None
    turn: int = 0
    since: float = math.inf
    set_up_since: float | None = None
    idle: bool = False
    awaited: type[Taken] | type[Parked] | None = None
    deadline: float = math.inf

    @property
    def free(self) -> bool:
        """Whether it can take a run."""
        return self.seat is None and self.awaited is None

    @property
    def at_work(self) -> bool:
        """Whether it works at a run, and nothing else is asked of it."""
        return self.seat is not None and self.awaited is None

    @property
    def ripe_at(self) -> float:
        """Time from which the run at work may be asked to make room.

        Setting up is not part of the quantum, or a run would get nowhere on a busy machine; but
        it has a time of its own, which grows each time that it was not enough.
        """
        if self.idle or self.seat is None:
            return -math.inf
        if self.set_up_since is None:
            return self.since + QUANTUM
        return self.since + QUANTUM * 2.0**self.seat.fruitless

    def expect(self, answer: type[Taken] | type[Parked], deadline: float) -> None:
        """Await an answer."""
        self.awaited = answer
        self.deadline = deadline if self.ready else math.inf

    def take(self, now: float) -> None:
        """Count the time of a run that is being set up."""
        self.clear()
        self.since = min(self.since, now)
        self.set_up_since = now

    def begin(self, now: float) -> None:
        """Count the time of a run that is set up."""
        if self.set_up_since is not None:
            self.since += now - self.set_up_since
            self.set_up_since = None

    def stir(self, now: float) -> None:
        """Count the time of a run that waited from now on."""
        if self.idle:
            self.idle, self.since = False, now

    def vacate(self) -> None:
        """Forget the seat."""
        self.seat, self.since, self.set_up_since, self.idle = None, math.inf, None, False

    def clear(self) -> None:
        """Await nothing any more."""
        self.awaited, self.deadline = None, math.inf
