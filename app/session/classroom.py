"""A class: one page leads, and whoever joins follows its pictures, which are computed once.

Nobody has a name or an account, and nothing is left of a class that has ended. One whose leader is
gone waits some minutes, as whoever loads a page again is gone as well.
"""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable

from app.picture.shown import Look, Manner
from app.wire.orders import Order, Ready, Run, Watch
from app.wire.reports import Picture, Report
from solver.settings import Settings

LETTERS = "ABCDEFGHJKLMNPQRSTUVWXYZ"
"""Of a code; none of them is taken for a digit."""
LENGTH = 4
KEPT = 300.0
"""Seconds for which a class waits for its leader, whose page was closed or is loaded again."""


class Poll:
    """What a class predicts of a lesson's question; nobody is asked who predicted what.

    Parameters
    ----------
    lesson
        Its name.
    tell
        Tells the class what is new.

    Attributes
    ----------
    is_answered
        Whether the leader's page has gone on to the answer, and so does everybody's.
    is_open
        Whether all see how many predicted what.
    """

    def __init__(self, lesson: str, tell: Callable[[], None]) -> None:
        self.lesson = lesson
        self.is_answered = self.is_open = False
        self._tell = tell
        self._choices: dict[object, int] = {}

    @property
    def predicted(self) -> int:
        """How many have made a choice."""
        return len(self._choices)

    def vote(self, voter: object, choice: int) -> None:
        """Take what one predicts, in place of what the same one did before."""
        self._choices[voter] = choice
        self._tell()

    def open(self) -> None:
        """Have all see how many predicted what."""
        self.is_open = True
        self._tell()

    def counts(self, choices: int) -> list[int]:
        """Count how often each of so many choices was made."""
        made = list(self._choices.values())
        return [made.count(choice) for choice in range(choices)]


class Room:
    """What all pages of a class have in common.

    Parameters
    ----------
    code
        By which one joins.
    settings
        Of the leader's run.

    Attributes
    ----------
    settings, views
        Of what is shown, as the leader has chosen.
    poll
        What is asked at present, if it is a lesson that the leader shows.
    key
        Who knows it may lead: the page that began the class, after it was loaded again.
    told
        Called, for every page of the class, when anything but the picture is new.
    """

    def __init__(self, code: str, settings: Settings) -> None:
        self.code = code
        self.key = secrets.token_hex(8)
        self.settings = settings
        self.views: tuple[str, ...] = ()
        self.poll: Poll | None = None
        self.told: set[Callable[[], None]] = set()
        self._is_ended = False
        self._leader: object | None = None
        self._alone_since: float | None = None
        self._newest: Picture | None = None
        self._number = 0
        self._seats: set[Seat] = set()

    @property
    def present(self) -> int:
        """How many follow."""
        return len(self._seats)

    @property
    def is_over(self) -> bool:
        """Whether it was ended, or its leader has not come back."""
        since = self._alone_since
        return self._is_ended or (since is not None and time.monotonic() - since > KEPT)

    @property
    def is_alone(self) -> bool:
        """Whether nobody leads it at present."""
        return self._alone_since is not None or self._is_ended

    def lead(self, leader: object) -> None:
        """Have it led by this one, in place of whoever did."""
        self._leader, self._alone_since = leader, None
        self.tell()

    def is_led_by(self, one: object) -> bool:
        """Tell whether this one leads it."""
        return self._leader is one and not self.is_over

    def part(self, leader: object) -> None:
        """Wait for the leader, whose page is closed; another one may lead already."""
        if self._leader is leader:
            self._leader, self._alone_since = None, time.monotonic()
            self.tell()

    def show(self, settings: Settings, views: tuple[str, ...], picture: Picture) -> None:
        """Give all followers a whole picture, each as soon as it has painted the one before."""
        is_new = settings is not self.settings or views != self.views
        self.settings, self.views, self._newest = settings, views, picture
        self._number += 1
        if is_new:
            self.tell()
        for seat in list(self._seats):
            seat.give()

    @property
    def manners(self) -> tuple[Manner, ...]:
        """The units and languages that those who follow have chosen."""
        return tuple(sorted({seat.manner for seat in self._seats}))

    def tell(self) -> None:
        """Tell all pages that something is new."""
        for told in list(self.told):
            told()

    def ask(self, lesson: str, *, is_answered: bool) -> None:
        """Ask what a lesson asks, or nothing without a name."""
        before = self._asked
        if lesson != before[0]:
            self.poll = Poll(lesson, self.tell) if lesson else None
        if self.poll is not None:
            self.poll.is_answered = is_answered
        if self._asked != before:
            self.tell()

    def seat(self, listener: Callable[[Report], None]) -> Seat:
        """Let one more follow; reports go to the listener."""
        found = Seat(self, listener)
        self._seats.add(found)
        self.tell()
        return found

    def leave(self, seat: Seat) -> None:
        """Let one go."""
        self._seats.discard(seat)
        self.tell()

    def end(self) -> None:
        """End the class; who follows keeps the last picture."""
        self._is_ended = True
        self.tell()

    def newer_than(self, number: int) -> tuple[int, Picture | None]:
        """Give the newest picture with its number, if there is one after a number."""
        return self._number, self._newest if self._number > number else None

    @property
    def _asked(self) -> tuple[str, bool]:
        return (self.poll.lesson, self.poll.is_answered) if self.poll is not None else ("", False)


class Seat:
    """What a page that follows has in place of a worker process: the leader's pictures.

    Attributes
    ----------
    manner
        The units and the language of the page: pictures are given in these, once there are such.
    """

    pid = None
    manner = Look().manner

    def __init__(self, room: Room, listener: Callable[[Report], None]) -> None:
        self._room = room
        self._listener = listener
        self._ticket = self._shown = 0
        self._is_ready = False

    def send(self, order: Order) -> None:
        """Heed that the page is ready, and the number that it gives to what it sees."""
        match order:
            case Run():
                # Of the newest picture the run before may have had the news.
                self._ticket, self._shown = order.ticket, 0
            case Ready():
                self._is_ready = True
                self._shown = 0 if order.afresh else self._shown
            case Watch() if order.look.manner != self.manner:
                self.manner, self._shown = order.look.manner, 0
                self._room.tell()
            case _:
                return
        self.give()

    def give(self) -> None:
        """Pass the newest picture on, if the page waits for one and has not seen it."""
        number, picture = self._room.newer_than(self._shown)
        if picture is not None and self._is_ready and self._ticket:
            self._is_ready, self._shown = False, number
            block = picture.others.get(self.manner, picture.block)
            self._listener(Picture(self._ticket, picture.facts, block))

    def close(self) -> None:
        """Follow no more."""
        self._room.leave(self)


class Rooms:
    """The classes of a server, by their codes."""

    def __init__(self) -> None:
        self._open: dict[str, Room] = {}

    def open(self, settings: Settings) -> Room:
        """Begin a class."""
        self._open = {code: room for code, room in self._open.items() if not room.is_over}
        code = ""
        while not code or code in self._open:
            code = "".join(secrets.choice(LETTERS) for _ in range(LENGTH))
        self._open[code] = Room(code, settings)
        return self._open[code]

    def find(self, code: str) -> Room | None:
        """Give a class that has not ended."""
        room = self._open.get(code.strip().upper())
        return None if room is None or room.is_over else room

    def end(self, room: Room) -> None:
        """End a class."""
        room.end()
        self._open.pop(room.code, None)


ROOMS = Rooms()
