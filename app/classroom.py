"""Classes: one page leads, the others show its frames, which are computed once.

Pages have no names, and nothing is left of a class that has ended. A class whose leader
is gone waits some minutes: a page that is loaded again is gone for a moment.
"""

from __future__ import annotations

import math
import secrets
import time
from collections.abc import Mapping, Sequence
from typing import Any

import param
from panel.io.state import set_curdoc

from app.history import History
from app.lessons.catalogue import LESSONS
from app.messages import Needs, Order, Ready
from app.state import PageState, Poll
from app.supervisor import Supervisor

LETTERS = "ABCDEFGHJKLMNPQRSTUVWXYZ"
"""Letters of a code; none of them is taken for a digit."""
LENGTH = 4
"""Number of letters of a code."""
KEPT = 300.0
"""Time for which a class waits for its leader, s."""
RESUMED = "settings", "selection", "lesson", "case", "plots"
"""Parts of the state that the next leader takes over from the last one."""
SHARED = *RESUMED, "frame", "newest", "ghost", "iteration", "running"
"""Parts of the leader's state that followers show."""


class Classroom:
    """A class: its leader, its followers, and the state that they share.

    A page with `key` may lead: the page that began the class, after it was loaded
    again. `leader` is None while no page leads; `state` is the leader's, or a copy of
    the last leader's. `members` follow. `opened` is the lesson whose counts all may
    see.
    """

    def __init__(self, code: str, leader: ClassMember) -> None:
        self.code = code
        self.key = secrets.token_hex(8)
        self.leader: ClassMember | None = leader
        self.state = leader.state
        self.members: list[ClassMember] = []
        self._gone_at: float | None = None
        self.opened = ""

    @property
    def is_over(self) -> bool:
        """Check whether the class was ended, or its leader stayed away."""
        return self._gone_at is not None and time.monotonic() - self._gone_at > KEPT

    def lead(self, member: ClassMember) -> None:
        """Make a page the leader of the class."""
        self.leader = member
        self._gone_at = None
        self.state = member.state
        self.notify()

    def part(self, member: ClassMember) -> None:
        """Remove a follower; or wait for a leader whose page is closed."""
        if member is self.leader:
            self._let_go(time.monotonic())
        elif member in self.members:
            self.members.remove(member)
        self.notify()

    def end(self) -> None:
        """End the class; followers keep the last picture."""
        # As if the leader had left long ago, so that nobody waits.
        self._let_go(-math.inf)
        self.notify()

    def _let_go(self, now: float) -> None:
        """Copy the parts of the leader's state that followers show.

        The state itself would keep the whole page of the leader in memory.
        """
        self.leader = None
        self._gone_at = now
        last = self.state
        self.state = PageState(**_values(last, (*SHARED, "prediction")))
        # These are no parameters, so the copy does not have them.
        self.state.history = last.history
        self.state.number = last.number

    def poll_for(self, member: ClassMember) -> Poll | None:
        """Predictions of the class as a page sees them; None without a question."""
        leader = self.state
        if leader.lesson not in LESSONS or self.is_over:
            return None
        votes = []
        for follower in self.members:
            if follower.state.lesson == leader.lesson:
                votes.append(follower.state.prediction)
        choices = range(len(LESSONS[leader.lesson].choices))
        counts = tuple([votes.count(choice) for choice in choices])
        return Poll(
            leads=member.leads,
            predicted=sum(counts),
            present=len(self.members),
            counts=counts if self.opened == leader.lesson else (),
            is_answered=leader.prediction is not None,
        )

    def notify(self) -> None:
        """Make all pages show the present state.

        Counts of another lesson are closed again.
        """
        if self.opened != self.state.lesson:
            self.opened = ""
        for member in self.members:
            member.notify()
        if self.leader is not None:
            self.leader.notify()


CLASSROOMS: dict[str, Classroom] = {}
"""The classes of the server, by their codes."""


def begin_with_class(state: PageState) -> None:
    """Begin a page with the state of the class in its address.

    Widgets are made with these values: what changes once they are on the screen would
    be written over what a person types there.
    """
    room = find(state.room.partition(".")[0])
    if room is not None:
        _update(state, _values(room.state, RESUMED))


def _values(state: PageState, names: Sequence[str]) -> dict[str, Any]:
    return {name: getattr(state, name) for name in names}


def _update(state: PageState, values: Mapping[str, Any]) -> None:
    """Set only the values that have changed, so that few watchers are called."""
    present = _values(state, [*values])
    changed = {name: value for name, value in values.items() if value != present[name]}
    state.param.update(**changed)


def forget() -> None:
    """Remove the classes that are over, with their leaders' data."""
    for code in [code for code, room in CLASSROOMS.items() if room.is_over]:
        del CLASSROOMS[code]


def find(code: str) -> Classroom | None:
    """The class of a code, unless it has ended."""
    room = CLASSROOMS.get(code.strip().upper())
    if room is None or room.is_over:
        return None
    return room


def no_class(code: str) -> str:
    """Sentence on a code that no class has."""
    return f"There is no class {code[:20]}: ask for it; it may have ended."


class ClassMember(param.Parameterized):
    """The role of a page in classes: leader, follower, or neither.

    The worker of a follower is ended. `room` is the class that is led or followed,
    `left` the code of the class that was followed last.
    """

    message = param.String(doc="Sentence on the class.")

    def __init__(self, state: PageState, supervisor: Supervisor, document: Any) -> None:
        super().__init__()
        self.state = state
        self._supervisor = supervisor
        self._document = document
        self.room: Classroom | None = None
        self.left = ""
        self._is_due = False
        state.param.watch(lambda *events: self._on_shared(), SHARED)
        state.param.watch(lambda event: self._on_prediction(), "prediction")
        state.param.watch(lambda event: self._on_address(event.new), "room")

    @property
    def leads(self) -> bool:
        """Check whether this page leads a class."""
        room = self.room
        return room is not None and room.leader is self

    @property
    def follows(self) -> bool:
        """Check whether this page follows a class."""
        return self.room is not None and self in self.room.members

    def enter(self, address: str) -> bool:
        """Follow the class of an address, or lead it with its key.

        Return whether the page follows a class. Where there is no such class, a refusal
        says so, and all stays as it is.
        """
        code, _, key = address.partition(".")
        room = find(code)
        if room is None:
            if code:
                refusals = [self.state.refusal, no_class(code)]
                self.state.refusal = " ".join(filter(None, refusals))
            self.state.room = self._address()
        # In constant time: a key is not found letter by letter.
        elif secrets.compare_digest(room.key.encode(), key.encode()):
            last = room.state
            _update(self.state, _values(last, RESUMED))
            self.state.prediction = last.prediction
            self._lead(room)
        elif room is not self.room:
            self.leave()
            self._follow(room)
        return room is not None and self.follows

    def begin(self) -> None:
        """Begin a class with this page as leader; remove classes that are over."""
        if self.room is not None:
            return
        forget()
        code = ""
        # A code that is taken would be that of another class.
        while not code or code in CLASSROOMS:
            code = "".join(secrets.choice(LETTERS) for _ in range(LENGTH))
        CLASSROOMS[code] = Classroom(code, self)
        self._lead(CLASSROOMS[code])

    def leave(self) -> None:
        """End the class that this page leads, or stop following and run alone."""
        room = self.room
        state = self.state
        if room is None:
            return
        has_followed = self.follows
        self.room = None
        state.poll = None
        if not has_followed:
            self.left = ""
            state.room = self._address()
            self.message = ""
            room.end()
            return
        self.left = room.code
        state.room = self._address()
        self.message = f"You have left class {room.code}."
        room.part(self)
        # The leader's history stays the leader's, and so do its numbers.
        state.history = History()
        if state.newest is not None:
            state.history.add(state.newest)
        self._supervisor.begin()
        state.run()

    def open_counts(self) -> None:
        """Show all pages the number of predictions of each choice."""
        self.room.opened = self.state.lesson
        self.room.notify()

    def close(self) -> None:
        """Leave the class when the page is closed."""
        if self.room is not None:
            self.room.part(self)
            self.room = None
        forget()

    def notify(self) -> None:
        """Show the present state on the page's next tick, once for several calls."""
        if not self._is_due:
            self._is_due = True
            # Else the tick would run in the context of the page that caused it.
            with set_curdoc(self._document):
                self._document.add_next_tick_callback(self._take)

    def _on_shared(self) -> None:
        if self.leads:
            self.room.notify()

    def _on_prediction(self) -> None:
        if self.room is not None:
            self.room.notify()

    def _lead(self, room: Classroom) -> None:
        self.room = room
        room.lead(self)
        self.state.room = self._address()

    def _follow(self, room: Classroom) -> None:
        self._supervisor.end()
        self.state.send = self._send
        self.room = room
        room.members.append(self)
        room.notify()
        self.state.room = self._address()
        self._take()

    def _send(self, order: Order) -> None:
        """Leave the class on any order but those of pictures and needs."""
        if not isinstance(order, Ready | Needs):
            self.leave()

    def _take(self) -> None:
        """Show the state of the leader, and the predictions."""
        self._is_due = False
        room = self.room
        state = self.state
        if room is None:
            return
        values: dict[str, Any] = {"poll": room.poll_for(self)}
        if self.follows:
            leader = room.state
            state.history = leader.history
            state.number = leader.number
            values |= _values(leader, SHARED)
        _update(state, values)
        self.message = self._sentence(room)
        # Nobody else tells a page that the class of an absent leader is over.
        if room.leader is None and not room.is_over:
            self._document.add_timeout_callback(self._take, int(1000 * KEPT) + 1000)

    def _sentence(self, room: Classroom) -> str:
        count = len(room.members)
        if self.leads and count == 1:
            return f"Class {room.code}: 1 follows."
        if self.leads:
            return f"Class {room.code}: {count} follow."
        if room.is_over:
            return f"Class {room.code} has ended. Change anything to go on."
        if room.leader is None:
            return f"The leader of class {room.code} is away: it waits some minutes."
        return f"You follow class {room.code}. Change anything to go on by yourself."

    def _address(self) -> str:
        """Part of the address: code of the class, and the key for its leader."""
        if self.room is None:
            return ""
        if self.leads:
            return f"{self.room.code}.{self.room.key}"
        return self.room.code

    def _on_address(self, address: str) -> None:
        """Leave a class when the browser goes back."""
        if self.follows and not address:
            self.leave()
