"""The lesson of a page: offered in a line, opened, its question asked and answered, and left."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any, ClassVar

import param

from app.components.form import ENDS, LADDERS_SCRIPT, STYLE, UNITS
from app.components.innards import Plain
from app.components.panes import script
from app.controls.sidebar import Sidebar
from app.lessons.lesson import LESSONS, NO_CHOICE, content, offered, readings
from app.session.classroom import Poll, Room
from app.session.session import Session
from app.views.catalogue import VIEWS
from solver.lessons.lesson import Lesson

CHOICE, COUNT = "the-choice", "the-count"
"""Messages that tell what was predicted, and that all may see how often; they name no setting."""
OWN_STYLE = """
:host { font-size: var(--prose, 15px); line-height: 1.45; }
h2 { margin: 0 0 6px; font-size: max(20px, 1.15em); line-height: 1.25; }
p { margin: 8px 0; }
article { padding: 2px 10px 10px; }
summary { margin: 4px 0; }
small { opacity: 0.8; }
.question, .why { padding-left: 10px; border-left: 4px solid #1976d2; }
.question { font-weight: 600; }
.why { outline: none; }
.why.right { border-color: #009E73; }
.why.wrong { border-color: #D55E00; }
button { width: auto; padding: 5px 12px; margin: 3px 8px 3px 0; text-align: left; }
button:hover { background: color-mix(in srgb, currentColor 8%, transparent); }
button.main { color: #fff; background: #1565c0; border-color: #1565c0; }
.choices button[aria-pressed=true] { border-color: #1976d2; outline: 2px solid #1976d2; }
.choices button, .counts li { background: border-box linear-gradient(to right,
  color-mix(in srgb, var(--bar, #1976d2) 40%, transparent) var(--share, 0%),
  transparent var(--share, 0%)); }
.votes { font-weight: 700; }
.counts { padding: 0; list-style: none; }
.counts li { padding: 4px 12px; margin: 4px 0; border-radius: 4px;
  border: 1px solid color-mix(in srgb, currentColor 30%, transparent); }
.counts .right { --bar: #009E73; border: 3px solid #009E73; font-weight: 700; }
.choices button { display: block; width: 100%; padding: 7px 12px; margin: 6px 0; }
figure { margin: 6px 0; max-width: 480px; }
figcaption { font-size: 0.85em; opacity: 0.8; }
.pad { display: block; width: 100%; cursor: crosshair; user-select: none; }
.strip figure { max-width: 340px; }
.ask { display: flex; flex-wrap: wrap; gap: 0 20px; }
.ask figure { flex: 0 1 360px; }
.ask .choices { flex: 1 1 220px; }
.why ~ details .pad { cursor: default; }
.value { font-weight: 600; white-space: nowrap; font-variant-numeric: tabular-nums; }
sup { line-height: 0; }
.control { display: inline-block; vertical-align: bottom; padding: 0 8px; border-radius: 6px;
  background: color-mix(in srgb, #1976d2 14%, transparent); }
.control[hidden] { display: none; }
.control input[type=range] { width: 200px; max-width: 100%; margin: 0 0 4px; }
.control select { display: inline-block; width: auto; margin: 2px 0; }
.control select ~ div { display: none; }
.control label { display: inline-block; margin-right: 6px; white-space: nowrap; }
.strip { padding: 4px 0 4px 10px; }
.strip:has(nav) { display: flex; align-items: start; gap: 20px; }
.strip > div { flex: 1; }
.strip > div[hidden] { display: none; }
.strip p { margin: 0 0 6px; }
.strip .control input[type=range] { width: 260px; }
.strip .counts { display: grid; grid-template-columns: repeat(auto-fit, minmax(200px, 1fr));
  gap: 6px 12px; margin: 0; }
.strip .counts li { margin: 0; font-size: 24px; line-height: 1.15; }
.strip .choices button { padding: 12px 16px; margin: 10px 0; font-size: 30px; }
nav { white-space: nowrap; }
nav span { margin: 0 8px 0 0; }
nav button:disabled { opacity: 0.4; }
.offer { display: flex; align-items: start; padding: 0 10px; font-size: 14px; line-height: 1.3; }
.offer details { flex: 1; }
.offer summary { margin: 2px 0; }
.offer h4 { margin: 8px 0 0; }
.offer ol { margin: 2px 0; }
.offer li { margin: 4px 0; }
.offer li button { padding: 2px 8px; font-weight: 600; }
.offer > button { border: 0; padding: 0 10px; margin: 2px 0; }
"""


class LessonPane(Plain):
    """A lesson, or where there is none, the offer of one.

    Messages from the browser are those of a `Form`; also `CHOICE` with the index of what was
    predicted, `COUNT`, and the sidebar's choice of a lesson.

    Attributes
    ----------
    offered
        Name, title, question and subject of every lesson.
    lesson
        What is shown of the one that is open, as `content` says it; empty if there is none.
    shown
        As in `Form`, for the controls of the lesson.
    values
        Name and text of every quantity in its sentences; pictures bring them.
    poll
        What the class predicts: whether this page `leads` it, how many have `predicted` and `of`
        how many, and the `counts` of all choices once they are to be seen; empty without a class.
    is_strip
        Whether one thing is said at a time, for a projector.
    recalls
        Whether what was predicted before a page was loaded again holds on; the browser knows it.
    """

    offered = param.List(default=[])
    lesson = param.Dict(default={})
    shown = param.Dict(default={})
    values = param.List(default=[])
    poll = param.Dict(default={})
    is_strip = param.Boolean(default=False)
    recalls = param.Boolean(default=False)

    _esm = LADDERS_SCRIPT + script(
        *("say.js", "elements.js", "exports.js", "values.js", "points.js", "controls.js"),
        *("teaching/curve.js", "teaching/handout.js", "teaching/lesson.js"),
    )
    _stylesheets: ClassVar[list[str]] = [STYLE, OWN_STYLE]


class Teaching:
    """The lesson that a page is in, if it is in one.

    Parameters
    ----------
    session
        Is given the settings of a lesson.
    sidebar
        Is told what the controls of a lesson say, and shows what holds.

    Attributes
    ----------
    view
        What stands on the page.
    """

    def __init__(self, session: Session, sidebar: Sidebar) -> None:
        self._session = session
        self._sidebar = sidebar
        self.view = LessonPane(
            name="lesson",
            offered=offered(session.say),
            css_classes=["lesson"],
            sizing_mode="stretch_width",
            margin=0,
        )
        self.view.on_msg(lambda message: self._hear(**message.data))
        sidebar.view.param.watch(lambda event: self._show(), "shown")
        watch = session.param.watch
        watch(lambda *events: self._tell(), ["lesson", "choice", "room", "is_left"])
        watch(lambda *events: self._follow(), ["wanted", "in_class"])

    @property
    def controls(self) -> Collection[str]:
        """Names of the settings that one may change beside the plots: a lesson has but its own."""
        return (self.view if self._session.lesson else self._sidebar.view).shown

    @property
    def _waits(self) -> bool:
        """Whether the answer comes with the class that is followed."""
        room = self._session.attendance.follows
        return room is not None and room.poll is not None and not room.poll.is_answered

    def open(self, name: str) -> None:
        """Begin a lesson, with its scene and settings; without a name, leave all as it is."""
        with self._session.together():
            if name in LESSONS:
                self._session.start(LESSONS[name].settings, is_alone=True)
                self._session.watch(phase=LESSONS[name].instant)
                self._session.go()
            self.take(name)

    def take(self, name: str) -> None:
        """Be in a lesson whose settings are there already, or in none."""
        lesson = LESSONS.get(name)
        with self._session.together():
            self._session.param.update(lesson=lesson, choice=None)
            self._session.draw_for(lesson)
            if lesson is not None:
                self._session.watch(interface=lesson.interface)

    def _follow(self) -> None:
        """Leave a lesson for another scene; show it to the class, or that of the class."""
        session, attendance = self._session, self._session.attendance
        if session.lesson is not None and session.wanted.scene != session.lesson.settings.scene:
            self.open("")
        if attendance.follows is not None:
            self._attend(attendance.follows)
        self._show_class()

    def _show_class(self) -> None:
        """Have the class asked what the lesson asks, and say how many have predicted."""
        if (led := self._session.attendance.leads) is not None:
            led.ask(name_of(self._session.lesson), is_answered=not self._session.asks)
        self.view.poll = self._polled()

    def _attend(self, room: Room) -> None:
        poll = room.poll
        session, name = self._session, poll.lesson if poll is not None else ""
        if name != name_of(session.lesson):
            # The settings of another scene come with a picture.
            if not name or LESSONS[name].settings.scene == room.settings.scene:
                self.take(name)
        elif poll is not None and poll.is_answered and "choice" not in self.view.lesson:
            session.choice = NO_CHOICE if session.choice is None else session.choice
            self._tell()

    def _polled(self) -> dict[str, Any]:
        attendance = self._session.attendance
        room, poll = attendance.room, attendance.poll
        lesson = self._session.lesson
        if room is None or poll is None or lesson is None:
            return {}
        counts = poll.counts(len(lesson.choices)) if poll.is_open else []
        leads = attendance.leads is not None
        return {"leads": leads, "predicted": poll.predicted, "of": room.present, "counts": counts}

    def _tell(self) -> None:
        """Show what there is of the lesson, and have no more told than it needs."""
        session, lesson = self._session, self._session.lesson
        session.asks = lesson is not None and (session.choice is None or self._waits)
        choice = None if session.asks else session.choice
        session.watch(readings=readings(lesson, choice) if lesson else ())
        self.view.lesson = self._content(lesson, choice) if lesson else {}
        self._show_class()

    def _content(self, lesson: Lesson, choice: int | None) -> dict[str, Any]:
        slugs = [view.slug for view in VIEWS if view.name in lesson.views]
        return {**content(lesson, choice, self._session.say), "slugs": slugs, **self._in_class()}

    def _in_class(self) -> dict[str, Any]:
        """Say what else there is of a lesson that is followed: its ends are the leader's.

        Whoever was left alone with a question may see the answer.
        """
        session = self._session
        if session.room is None:
            return {}
        return {"follows": True, "chosen": session.choice, "alone": session.is_left}

    def _hear(self, name: str, value: Any, hand: bool, count: float) -> None:
        poll = self._session.attendance.poll
        if name == COUNT and poll is not None:
            poll.open()
        elif name == CHOICE and self._session.asks:
            self._predict(value, poll)
        elif name not in (CHOICE, COUNT):
            self._sidebar.hear(name, value, hand, count)

    def _predict(self, choice: int, poll: Poll | None) -> None:
        """Take what was predicted; whoever was left alone by a class goes on without it."""
        session = self._session
        with session.together():
            if self._waits and session.is_left:
                session.start(session.settings.replace())
                if session.choice is not None and choice == NO_CHOICE:
                    return
            elif poll is not None and self._waits:
                poll.vote(self, choice)
            session.choice = choice

    def _show(self) -> None:
        """Show on the lesson's controls what those of the sidebar show."""
        holds = self._sidebar.view.shown
        lesson = self._session.lesson
        names = ("", ENDS, UNITS, *lesson.controls) if lesson else ()
        self.view.shown = {name: holds[name] for name in names if name in holds}


def name_of(lesson: Lesson | None) -> str:
    """Give the name of a lesson, or nothing for none."""
    return lesson.name if lesson else ""
