"""The part of a page in a class: it leads one, follows one, or neither."""

from __future__ import annotations

import secrets
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from app.session.classroom import KEPT, ROOMS, Poll, Room
from app.session.page_worker import Hire, PageWorker
from app.session.state import State
from app.session.turns import Turns
from app.wire.orders import Watch
from app.wire.reports import Picture
from solver.settings import Settings


class Attendance:
    """What a page leads and follows.

    Parameters
    ----------
    state
        Of the page, which is told what is new.
    worker
        Has what does the page's work: a process, or a seat in a class.
    hire
        Gives a process.
    turns
        Of the page, as what is new happens on those of others.
    start
        Starts a run with the settings of the class.

    Attributes
    ----------
    follows
        The class whose pictures this page shows.
    left
        The class that was followed last, and may be again.
    """

    def __init__(
        self,
        state: State,
        worker: PageWorker,
        hire: Hire,
        turns: Turns,
        start: Callable[[Settings], None],
    ) -> None:
        self._leads: Room | None = None
        self.follows: Room | None = None
        self.left: Room | None = None
        self._worker = worker
        self._hire = hire
        self._state, self._start = state, start
        self._news = partial(turns.soon, self.note)
        self._end = turns.timer(self.note)

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
            self._lead(ROOMS.open(settings))

    def resume(self, ticket: str) -> bool:
        """Lead a class again by what `ticket` gave before the page was loaded anew; tell."""
        code, _, key = ticket.partition(" ")
        room = ROOMS.find(code)
        if room is None or not secrets.compare_digest(room.key.encode(), key.encode()):
            return False
        self._lead(room)
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
            self.note()

    def close(self) -> None:
        """Leave the class that this page leads, which waits for it."""
        for room in (self._leads, self.follows, self.left):
            if room is not None:
                room.told.discard(self._news)
        if self.leads is not None:
            self.leads.part(self)

    def follow(self, room: Room) -> None:
        """Take a seat; what the class shows is given as soon as a run with its settings starts."""
        self.follows = room
        self._worker.change(room.seat)
        room.told.add(self._news)
        self.note()

    def heed(self, settings: Settings) -> None:
        """Leave the class that is followed for a run of one's own, unless it is the class's."""
        if self.follows is not None and settings is not self.follows.settings:
            self.left, self.follows = self.follows, None
            self._worker.change(self._hire)
            self.note()

    def share(self, settings: Settings, views: tuple[str, ...], picture: Picture) -> None:
        """Give a picture of this page to the class that it leads."""
        if self.leads is not None:
            self.leads.show(settings, views, picture)

    def note(self) -> None:
        """Take in what is new in the class that is led, or followed; one that waits may end."""
        state, room = self._state, self.follows
        with state.together():
            state.in_class += 1
            if room is not state.room:
                state.room = room
            state.is_left = room is not None and room.is_alone
        if room is not None and state.ticket and room.settings is not state.settings:
            self._start(room.settings)
        # The pictures of a class are made once for each choice of units and language in it.
        others = self.leads.manners if self.leads is not None else ()
        if others != state.look.others:
            state.look = replace(state.look, others=others)
            self._worker.send(Watch(state.look))
        waits = room or self.left
        if waits is not None and waits.is_alone and not waits.is_over:
            self._end.set(KEPT)

    def _lead(self, room: Room) -> None:
        self._leads = room
        room.told.add(self._news)
        room.lead(self)
        self.note()
