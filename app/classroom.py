"""A class: one page leads, and the pages that follow show its frames, which are computed once.

Nobody has a name, and nothing is left of a class that has ended. One whose leader is gone waits
some minutes, as whoever loads a page again is gone as well.
"""

from __future__ import annotations

import secrets
import time
from typing import Any

import param

from app.history import History
from app.lessons.catalogue import LESSONS
from app.messages import Needs, Order, Ready
from app.poll import Poll
from app.state import PageState
from app.supervisor import Supervisor

LETTERS = "ABCDEFGHJKLMNPQRSTUVWXYZ"
"""Of a code; none of them is taken for a digit."""
LENGTH = 4
KEPT = 300.0
"""Seconds for which a class waits for its leader."""
SHARED = (
    *("settings", "frame", "newest", "ghost", "iteration", "running"),
    *("selection", "lesson", "plots"),
)
"""What followers have of the leader's state."""
APART = 10_000
"""Runs of a page that has left a class are counted so far from the leader's."""


class Classroom:
    """What the pages of a class have in common.

    Parameters
    ----------
    code
        By which one joins.

    Attributes
    ----------
    key
        Whoever has it may lead: the page that began the class, after it was loaded again.
    leader
        The state that followers see; that of the last leader while there is none.
    members
        The pages that follow.
    """

    def __init__(self, code: str) -> None:
        self.code, self.key = code, secrets.token_hex(8)
        self.leader: PageState | None = None
        self.members: list[Member] = []
        self._guide: Member | None = None
        self._watcher: Any = None
        self._gone_at: float | None = None
        self._is_ended = self._is_open = False
        self._lesson = ""
        self._votes: dict[Member, int] = {}

    @property
    def is_over(self) -> bool:
        """Whether it was ended, or its leader has not come back."""
        gone = self._gone_at is not None and time.monotonic() - self._gone_at > KEPT
        return self._is_ended or gone

    @property
    def is_alone(self) -> bool:
        """Whether nobody leads it at present."""
        return self._gone_at is not None or self._is_ended

    def lead(self, guide: Member) -> None:
        """Have a page lead it, in place of the one that did."""
        if self.leader is not None and self._watcher is not None:
            self.leader.param.unwatch(self._watcher)
        self._guide, self.leader, self._gone_at = guide, guide.state, None
        self._watcher = self.leader.param.watch(
            lambda *events: self._on_leader(), [*SHARED, "prediction"]
        )
        self._on_leader()

    def is_led_by(self, member: Member) -> bool:
        """Whether a page leads it."""
        return self._guide is member and not self.is_over

    def part(self, member: Member) -> None:
        """Wait for a leader whose page is closed, or let a follower go."""
        if self._guide is member:
            self._guide, self._gone_at = None, time.monotonic()
        elif member in self.members:
            self.members.remove(member)
            self._votes.pop(member, None)
        self.tell()

    def join(self, member: Member) -> None:
        """Have one more follow."""
        self.members.append(member)
        self.tell()

    def end(self) -> None:
        """End it; followers keep the last picture."""
        self._is_ended = True
        self.tell()

    def vote(self, member: Member, choice: int) -> None:
        """Take what a follower predicts, in place of what was predicted before."""
        self._votes[member] = choice
        self.tell()

    def open_counts(self) -> None:
        """Have all see how many predicted what."""
        self._is_open = True
        self.tell()

    def poll_for(self, member: Member) -> Poll | None:
        """What the class predicts, as one of its pages sees it; None without a question."""
        leader = self.leader
        if leader is None or leader.lesson not in LESSONS or self.is_over:
            return None
        votes = list(self._votes.values())
        choices = range(len(LESSONS[leader.lesson].choices))
        counts = tuple(votes.count(choice) for choice in choices)
        return Poll(
            leads=self.is_led_by(member),
            predicted=len(votes),
            present=len(self.members),
            counts=counts if self._is_open else (),
            is_answered=leader.prediction is not None,
        )

    def tell(self) -> None:
        """Have all pages take what is new."""
        for member in [*self.members, self._guide]:
            if member is not None:
                member.notify()

    def _on_leader(self) -> None:
        assert self.leader is not None
        if self.leader.lesson != self._lesson:
            self._lesson, self._votes, self._is_open = self.leader.lesson, {}, False
        self.tell()


class Classrooms:
    """The classes of a server, by their codes."""

    def __init__(self) -> None:
        self._open: dict[str, Classroom] = {}

    def begin(self) -> Classroom:
        """A new class."""
        self._open = {code: room for code, room in self._open.items() if not room.is_over}
        code = ""
        while not code or code in self._open:
            code = "".join(secrets.choice(LETTERS) for _ in range(LENGTH))
        self._open[code] = Classroom(code)
        return self._open[code]

    def find(self, code: str) -> Classroom | None:
        """The class of a code, unless it has ended."""
        room = self._open.get(code.strip().upper())
        return None if room is None or room.is_over else room


CLASSROOMS = Classrooms()


class Member(param.Parameterized):
    """The part of a page in a class: it leads one, follows one, or neither.

    Parameters
    ----------
    state, supervisor, document
        Of the page; its worker is ended while the page follows.

    Attributes
    ----------
    message
        What is to be said of the class, in a sentence.
    room
        The class that is led or followed.
    left
        The class that was followed last.
    """

    message = param.String()

    def __init__(self, state: PageState, supervisor: Supervisor, document: Any) -> None:
        super().__init__()
        self.state, self._supervisor, self._document = state, supervisor, document
        self.room: Classroom | None = None
        self.left: Classroom | None = None
        self._is_due = False
        state.param.watch(lambda event: self._vote(event.new), "prediction")
        state.param.watch(lambda event: self._on_address(event.new), "room")

    @property
    def leads(self) -> bool:
        """Whether this page leads a class."""
        return self.room is not None and self.room.is_led_by(self)

    @property
    def follows(self) -> bool:
        """Whether this page shows what another one does."""
        return self.room is not None and self in self.room.members

    def enter(self, address: str) -> bool:
        """Follow the class of an address, or lead it on with its key; whether the page follows."""
        code, _, key = address.partition(".")
        room = CLASSROOMS.find(code)
        if room is None:
            if code:
                self.message = (
                    f"There is no class {code[:20]}: ask for its code; it may have ended."
                )
            self._set_address("")
        elif secrets.compare_digest(room.key.encode(), key.encode()):
            self._resume(room)
        else:
            self._follow(room)
        return self.follows

    def begin(self) -> None:
        """Begin a class that sees what this page shows."""
        if self.room is None:
            self._lead(CLASSROOMS.begin())

    def end(self) -> None:
        """End the class that this page leads."""
        if self.leads and self.room is not None:
            room, self.room = self.room, None
            self.state.poll = None
            room.end()
            self._set_address("")
            self.message = ""

    def leave(self) -> None:
        """Follow no more, and go on with a run of its own."""
        if self.room is None or not self.follows:
            return
        state, room = self.state, self.room
        self.left, self.room = room, None
        room.part(self)
        # The leader's history stays the leader's, and so do its numbers.
        state.history, newest = History(), state.newest
        if newest is not None:
            state.history.add(newest)
        state.number += APART
        state.poll = None
        self._set_address("")
        self.message = f"You have left class {room.code}."
        self._supervisor.begin()
        state.run()

    def follow_again(self) -> None:
        """Follow the class that was left."""
        if self.left is not None and not self.left.is_over:
            self._follow(self.left)

    def open_counts(self) -> None:
        """Have all see how many predicted what."""
        if self.room is not None and self.leads:
            self.room.open_counts()

    def close(self) -> None:
        """Leave nothing behind of a page that is closed."""
        if self.room is not None:
            self.room.part(self)
            self.room = None

    def notify(self) -> None:
        """Take what is new on the page's own next tick: of several news the last."""
        if not self._is_due:
            self._is_due = True
            self._document.add_next_tick_callback(self._take)

    def _lead(self, room: Classroom) -> None:
        self.room = room
        room.lead(self)
        self._set_address(f"{room.code}.{room.key}")

    def _resume(self, room: Classroom) -> None:
        """Lead a class on, where its last leader was."""
        before = room.leader
        if before is not None:
            names = ("settings", "selection", "lesson", "plots")
            self.state.param.update(**{name: getattr(before, name) for name in names})
            self.state.prediction = before.prediction
        self._lead(room)

    def _follow(self, room: Classroom) -> None:
        self._supervisor.end()
        self.state.send = self._send
        self.room, self.left = room, None
        room.join(self)
        self._set_address(room.code)
        self._take()

    def _send(self, order: Order) -> None:
        """Go on alone once a run is ordered; pictures need no answer."""
        if not isinstance(order, Ready | Needs):
            self.leave()

    def _take(self) -> None:
        """Show what the leader shows."""
        self._is_due = False
        room, state = self.room, self.state
        if room is None:
            return
        values: dict[str, Any] = {"poll": room.poll_for(self)}
        if self.follows and room.leader is not None:
            state.history, state.number = room.leader.history, room.leader.number
            state.began = state.number
            values |= {name: getattr(room.leader, name) for name in SHARED}
        changed = {name: value for name, value in values.items() if value != getattr(state, name)}
        state.param.update(**changed)
        self.message = self._sentence(room)
        if room.is_alone and not room.is_over:
            self._document.add_timeout_callback(self._take, int(1000 * KEPT) + 1000)

    def _sentence(self, room: Classroom) -> str:
        count = len(room.members)
        if self.leads:
            return f"Class {room.code}: {count} follow{'s' * (count == 1)}."
        if room.is_over:
            return f"Class {room.code} has ended. Change anything to go on."
        if room.is_alone:
            return f"The leader of class {room.code} is away: it waits some minutes."
        return f"You follow class {room.code}. Change anything to go on by yourself."

    def _vote(self, choice: int | None) -> None:
        if choice is not None and choice >= 0 and self.follows and self.room is not None:
            self.room.vote(self, choice)

    def _on_address(self, address: str) -> None:
        """Follow, or leave, as the browser goes back and on."""
        if address == self._address or self.leads:
            return
        if address:
            self.enter(address)
        else:
            self.leave()

    _address = ""

    def _set_address(self, address: str) -> None:
        self._address = address
        self.state.room = address
