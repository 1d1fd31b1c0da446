"""The part of a page in a class: it leads one, follows one, or neither."""

from __future__ import annotations

import secrets

from app.session.classroom import ROOMS, Poll, Room
from app.session.keeper import Hire, Keeper
from app.wire.reports import Picture
from solver.settings import Settings


class Attendance:
    """What a page leads and follows.

    Parameters
    ----------
    keeper
        Has what does the page's work: a process, or a seat in a class.
    hire
        Gives a process.

    Attributes
    ----------
    follows
        The class whose pictures this page shows.
    left
        The class that was followed last, and may be again.
    """

    def __init__(self, keeper: Keeper, hire: Hire) -> None:
        self._leads: Room | None = None
        self.follows: Room | None = None
        self.left: Room | None = None
        self._keeper = keeper
        self._hire = hire

    @property
    def leads(self) -> Room | None:
        """The class that sees what this page shows; another page may have taken it over."""
        led = self._leads
        return led if led is not None and led.is_led_by(self) else None

    @property
    def poll(self) -> Poll | None:
        """What the class is asked at present that is led or followed here."""
        return self.room.poll if self.room is not None else None

    @property
    def room(self) -> Room | None:
        """The class that is led or followed here."""
        return self.leads if self.leads is not None else self.follows

    def lead(self, settings: Settings) -> None:
        """Begin a class."""
        if self.leads is None:
            self._leads = ROOMS.open(settings)
            self._leads.lead(self)

    def resume(self, ticket: str) -> bool:
        """Lead a class again by what `ticket` gave before the page was loaded anew; tell."""
        code, _, key = ticket.partition(" ")
        room = ROOMS.find(code)
        if room is None or not secrets.compare_digest(room.key.encode(), key.encode()):
            return False
        room.lead(self)
        self._leads = room
        return True

    @property
    def ticket(self) -> str:
        """What leads the class again that is led here, or nothing."""
        return f"{self.leads.code} {self.leads.key}" if self.leads is not None else ""

    def end(self) -> None:
        """End the class that this page leads."""
        if self.leads is not None:
            ROOMS.end(self.leads)
            self._leads = None

    def close(self) -> None:
        """Leave the class that this page leads, which waits for it."""
        if self.leads is not None:
            self.leads.part(self)

    def follow(self, room: Room) -> None:
        """Take a seat; what the class shows is given as soon as a run with its settings starts."""
        self.follows = room
        self._keeper.change(room.seat)

    def heed(self, settings: Settings) -> None:
        """Leave the class that is followed for a run of one's own, unless it is the class's."""
        if self.follows is not None and settings is not self.follows.settings:
            self.left, self.follows = self.follows, None
            self._keeper.change(self._hire)

    def share(self, settings: Settings, views: tuple[str, ...], picture: Picture) -> None:
        """Give a picture of this page to the class that it leads."""
        if self.leads is not None:
            self.leads.show(settings, views, picture)
