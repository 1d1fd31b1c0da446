"""A process of the pool, with what it does at present."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from app.worker.protocol import Parked, Taken

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
        When the seat's work here began.
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

    def expect(self, answer: type[Taken] | type[Parked], deadline: float) -> None:
        """Await an answer."""
        self.awaited = answer
        self.deadline = deadline if self.ready else math.inf

    def stir(self, now: float) -> None:
        """Count the time of a run that waited from now on."""
        if self.idle:
            self.idle, self.since = False, now

    def vacate(self) -> None:
        """Forget the seat."""
        self.seat, self.since, self.idle = None, math.inf, False

    def clear(self) -> None:
        """Await nothing any more."""
        self.awaited, self.deadline = None, math.inf
