"""A class: one page leads, and the pages that follow show its frames, which are computed once.

Nobody has a name, and nothing is left of a class that has ended. One whose leader is
gone waits some minutes, as whoever loads a page again is gone as well.
"""

from __future__ import annotations

import math
import secrets
import time
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param
import segno
from panel.io.state import set_curdoc

from app.lessons.catalogue import LESSONS
from app.messages import Needs, Order, Ready
from app.server import address_for_others, how_to_open
from app.state import History, PageState, Poll
from app.supervisor import Supervisor
from app.widgets import button, dialog

LETTERS = "ABCDEFGHJKLMNPQRSTUVWXYZ"
"""Of a code; none of them is taken for a digit."""
LENGTH = 4
KEPT = 300.0
"""Seconds for which a class waits for its leader."""
RESUMED = "settings", "selection", "lesson", "case", "plots"
"""What the next leader has of the last one's state."""
SHARED = *RESUMED, "frame", "newest", "ghost", "iteration", "running"
"""What followers have of the leader's state."""


class Classroom:
    """What the pages of a class have in common.

    Whoever has `key` may lead: the page that began the class, after it was loaded
    again. `leader` is None while nobody does; `state` is the leader's, or what the last
    one left. `members` follow. `opened` is the lesson whose counts all may see.
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
    def is_alone(self) -> bool:
        """Whether nobody leads it at present."""
        return self.leader is None

    @property
    def is_over(self) -> bool:
        """Whether it was ended, or its leader has not come back."""
        return self._gone_at is not None and time.monotonic() - self._gone_at > KEPT

    def lead(self, member: ClassMember) -> None:
        """Have a page lead it, in place of the one that did."""
        self.leader = member
        self._gone_at = None
        self.state = member.state
        self.notify()

    def part(self, member: ClassMember) -> None:
        """Wait for a leader whose page is closed, or let a follower go."""
        if member is self.leader:
            self._let_go(time.monotonic())
        elif member in self.members:
            self.members.remove(member)
        self.notify()

    def end(self) -> None:
        """End it; followers keep the last picture."""
        self._let_go(-math.inf)
        self.notify()

    def _let_go(self, now: float) -> None:
        """Keep of the leader what followers see: the state itself would keep the whole page."""
        self.leader = None
        self._gone_at = now
        last = self.state
        self.state = PageState(
            **{name: getattr(last, name) for name in (*SHARED, "prediction")}
        )
        self.state.history = last.history
        self.state.number = last.number

    def poll_for(self, member: ClassMember) -> Poll | None:
        """What the class predicts, as one of its pages sees it; None without a question."""
        leader = self.state
        if leader.lesson not in LESSONS or self.is_over:
            return None
        states = (follower.state for follower in self.members)
        votes = [state.prediction for state in states if state.lesson == leader.lesson]
        choices = range(len(LESSONS[leader.lesson].choices))
        counts = [votes.count(choice) for choice in choices]
        return Poll(
            leads=member.leads,
            predicted=sum(counts),
            present=len(self.members),
            counts=tuple(counts) if self.opened == leader.lesson else (),
            is_answered=leader.prediction is not None,
        )

    def notify(self) -> None:
        """Have all pages take what is new; another lesson is predicted anew."""
        if self.opened != self.state.lesson:
            self.opened = ""
        for member in self.members:
            member.notify()
        if self.leader is not None:
            self.leader.notify()


CLASSROOMS: dict[str, Classroom] = {}
"""The classes of the server, by their codes."""


def forget() -> None:
    """Forget the classes that are over, and what their leaders left."""
    for code in [code for code, room in CLASSROOMS.items() if room.is_over]:
        del CLASSROOMS[code]


def find(code: str) -> Classroom | None:
    """The class of a code, unless it has ended."""
    room = CLASSROOMS.get(code.strip().upper())
    return None if room is None or room.is_over else room


class ClassMember(param.Parameterized):
    """The part of a page in a class: it leads one, follows one, or neither.

    Its worker is ended while it follows. `room` is the class that is led or followed,
    `left` the code of the one that was followed last.
    """

    message = param.String(doc="What is to be said of the class, in a sentence.")

    def __init__(self, state: PageState, supervisor: Supervisor, document: Any) -> None:
        super().__init__()
        self.state = state
        self._supervisor = supervisor
        self._document = document
        self.room: Classroom | None = None
        self.left = ""
        self._is_due = False
        state.param.watch(lambda *events: self.leads and self.room.notify(), SHARED)
        state.param.watch(lambda event: self.room and self.room.notify(), "prediction")
        state.param.watch(lambda event: self._on_address(event.new), "room")

    @property
    def leads(self) -> bool:
        """Whether this page leads a class."""
        room = self.room
        return room is not None and room.leader is self

    @property
    def follows(self) -> bool:
        """Whether this page shows what another one does."""
        return self.room is not None and self in self.room.members

    def enter(self, address: str) -> bool:
        """Follow the class of an address, or lead it on with its key; whether the page follows.

        Where there is no such class, `message` says so, and all stays as it is.
        """
        code, _, key = address.partition(".")
        room = find(code)
        if room is None:
            if code:
                self.message = (
                    f"There is no class {code[:20]}: ask for it; it may have ended."
                )
            self.state.room = self._address()
        elif secrets.compare_digest(room.key.encode(), key.encode()):
            last = room.state
            self.state.param.update(**{name: getattr(last, name) for name in RESUMED})
            self.state.prediction = last.prediction
            self._lead(room)
        elif room is not self.room:
            self.leave()
            self._follow(room)
        return room is not None and self.follows

    def begin(self) -> None:
        """Begin a class that sees what this page shows; those that are over are forgotten."""
        if self.room is not None:
            return
        forget()
        code = ""
        while not code or code in CLASSROOMS:
            code = "".join(secrets.choice(LETTERS) for _ in range(LENGTH))
        CLASSROOMS[code] = Classroom(code, self)
        self._lead(CLASSROOMS[code])

    def leave(self) -> None:
        """End the class that this page leads, or go on with a run of its own."""
        room = self.room
        state = self.state
        followed = self.follows
        if room is None:
            return
        self.room = state.poll = None
        self.left = room.code if followed else ""
        state.room = self._address()
        if followed:
            self.message = f"You have left class {room.code}."
        else:
            self.message = ""
        if not followed:
            room.end()
            return
        room.part(self)
        # The leader's history stays the leader's, and so do its numbers.
        state.history = History()
        if state.newest is not None:
            state.history.add(state.newest)
        self._supervisor.begin()
        state.run()

    def open_counts(self) -> None:
        """Have all see how many predicted what."""
        self.room.opened = self.state.lesson
        self.room.notify()

    def close(self) -> None:
        """Leave nothing behind of a page that is closed."""
        if self.room is not None:
            self.room.part(self)
            self.room = None
        forget()

    def notify(self) -> None:
        """Take what is new on the page's own next tick: of several news the last."""
        if not self._is_due:
            self._is_due = True
            # Else the tick would take the page that told it for its own.
            with set_curdoc(self._document):
                self._document.add_next_tick_callback(self._take)

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
        """Go on alone once a run is ordered; pictures need no answer."""
        if not isinstance(order, Ready | Needs):
            self.leave()

    def _take(self) -> None:
        """Show what the leader shows."""
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
            values |= {name: getattr(leader, name) for name in SHARED}
        # Watchers of what is as it was have nothing to do.
        changed = {
            name: value
            for name, value in values.items()
            if value != getattr(state, name)
        }
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

    def _address(self) -> str:
        """What the page's address has of the class: its code; of one that is led its key, too."""
        if self.room is None:
            return ""
        if self.leads:
            return f"{self.room.code}.{self.room.key}"
        return self.room.code

    def _on_address(self, address: str) -> None:
        """Follow, or leave, as the browser goes back and on."""
        if address == self._address() or self.leads:
            return
        if address:
            self.enter(address)
        else:
            self.leave()


class ClassDialog:
    """Begins a class and shows its code, or joins one.

    `view` is the line that stands on the page while it is in a class, or has left one;
    `dialog` is what the header's button opens.
    """

    def __init__(self, member: ClassMember) -> None:
        self._member = member
        self._message = pn.pane.HTML(margin=(4, 8))
        self._again = button(
            "Follow again", lambda: member.enter(member.left), variant="text"
        )
        look = {
            "visible": False,
            "margin": 0,
            "align": "center",
            "css_classes": ["class"],
        }
        self.view = pn.Row(self._message, self._again, **look)
        self.dialog = dialog("A class", width_option="sm")
        member.param.watch(lambda event: self._show(), "message")

    def open(self) -> None:
        """Open the dialog."""
        # It is filled anew: models that were taken off the page are not put on it
        # again.
        if self._member.leads:
            self.dialog[:] = self._led()
        else:
            self.dialog[:] = self._offered()
        self.dialog.open = True

    def _offered(self) -> list[Any]:
        self._field = pmui.TextInput(
            label="Code", max_length=4, size="small", width=120
        )
        join = button("Join", self._join, variant="outlined")
        return [
            pn.pane.Markdown(
                "Whoever joins a class sees what its leader sees, and predicts too."
            ),
            button("Begin a class", self._begin),
            pn.Row(self._field, join, align="end", margin=(12, 0)),
        ]

    def _led(self) -> list[Any]:
        code = self._member.room.code
        large = f'<div style="font-size: 64px; letter-spacing: 8px">{code}</div>'
        address = address_for_others()
        if address:
            link = f"{address}?class={code}"
            svg = segno.make(link, error="m").svg_inline(
                scale=6, light="#fff", omitsize=True
            )
            below = f'<div style="width: 260px">{svg}</div><p>{escape(link)}</p>'
        else:
            below = how_to_open()
        return [pn.pane.HTML(large + below), button("End the class", self._leave)]

    def _begin(self) -> None:
        self._member.begin()
        self.open()

    def _join(self) -> None:
        code = self._field.value_input or self._field.value
        if self._member.enter(code):
            self.dialog.open = False
        else:
            if code:
                refusal = self._member.message
            else:
                refusal = "Write a code."
            self._field.param.update(error_state=True, helper_text=refusal)

    def _leave(self) -> None:
        self._member.leave()
        self.dialog.open = False

    def _show(self) -> None:
        member = self._member
        self._message.object = escape(member.message)
        self._again.visible = member.room is None and bool(member.left)
        self.view.visible = bool(member.message)
