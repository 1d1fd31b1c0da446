"""What stands at the side: the settings, and the choice of scene, views and lesson."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from typing import Any

from app.components.form import ENDS, NAMED, POINTS, UNITS, USUAL, Form, shown_value
from app.controls.comparing import choice_of, pair
from app.controls.items import (
    BROUGHT,
    COMPARE,
    LESSON,
    NOTE,
    SCENE,
    VIEWS,
    WARM,
    items,
)
from app.controls.refusals import last_that_holds, refused
from app.picture.usual import usual_value
from app.reports.report import Report
from app.session.session import Session
from app.session.uploads import brought_in
from app.views.catalogue import drawn, fitting
from app.wire.orders import Bring
from solver.definitions import SettingError, about
from solver.phrases import joined
from solver.scenes import ends_of, points_of
from solver.settings import Settings

MOMENT = 0.025
"""Seconds within which of several moves of a control the newest counts."""


class Sidebar:
    """The controls of a session.

    Parameters
    ----------
    session
        Is told what the user changes, and shown.
    teach
        Opens a lesson by its name; an empty one leaves that which is open.

    Attributes
    ----------
    view
        What stands on the page.
    """

    def __init__(
        self,
        session: Session,
        teach: Callable[[str], None],
    ) -> None:
        self._session = session
        self._teach = teach
        self._report: Report | None = None
        self._asked: dict[str, Any] = {}
        self._in_hand: set[str] = set()
        self._ends: set[str] = set()
        self._drag = 1
        self._moment = session.turns.timer(self.obey)
        self._heard = self._answered = 0.0
        self.view = Form(sizing_mode="stretch_width", margin=(4, 10))
        self.view.on_msg(lambda message: self.hear(**message.data))
        shown = ["wanted", "twin", "brought", "warm_start", "chosen", "lesson", "refusal"]
        session.param.watch(lambda *events: self._show(), shown)
        session.param.watch(self._on_look, "look")
        self._show()

    def _on_look(self, event: Any) -> None:
        if event.new.units != event.old.units:
            self._show()

    def show_for(self, report: Report | None) -> None:
        """Show the settings of a report that is looked at alone, or those of the run."""
        self._report = report
        self._show()

    def _show(self) -> None:
        """Show the settings that hold."""
        session = self._session
        settings: Settings = session.wanted
        definitions, lesson, brought = settings.definitions(), session.lesson, session.brought
        acting = (
            [name for name, one in definitions.items() if about(one).applies(settings)]
            if self._report is None
            else self._report.acting()
        )
        values = {name: shown_value(getattr(settings, name)) for name in acting}
        views = [view.name for view in fitting(settings)]
        seen = [view.name for view in drawn(settings, session.chosen)]
        own = {
            SCENE: settings.scene,
            LESSON: lesson.name if lesson else "",
            COMPARE: choice_of(session.twin, settings),
            BROUGHT: brought.source if brought and brought.scene == settings.scene else "",
            WARM: session.warm_start,
            VIEWS: [views, seen],
            UNITS: session.look.units,
            "": self._answered,
            ENDS: ends_of(settings),
            NAMED: [*(lesson.controls if lesson else ()), *self._told_of(acting)],
        }
        if self._report is not None:
            kept = {SCENE, ENDS, NAMED, UNITS, ""} if acting else {""}
            own = {NOTE: self._report.note, **{name: own[name] for name in kept}}
        changes: dict[str, Any] = {"shown": {**values, **own}}
        # Param takes longer to compare the controls with themselves than to pass on the values.
        if (controls := items(type(settings))) is not self.view.items:
            changes["items"] = controls
        self.view.param.update(**changes)

    def _told_of(self, names: Iterable[str]) -> list[str]:
        """Give the settings of which the page says that they are refused, or in the way."""
        definitions = self._session.wanted.definitions()
        said = f"{self._session.refusal} {self._session.look.complaint}".lower()
        titles = {name: re.escape(about(definitions[name]).title.lower()) for name in names}
        return [name for name in names if re.search(rf"(?<!\w){titles[name]}(?!\w)", said)]

    def hear(self, name: str, value: Any, hand: bool, count: float) -> None:
        """Follow what the user does with a control."""
        self._heard = count
        if name == SCENE:
            self._on_scene(value)
        elif name == LESSON:
            self.obey()
            self._teach(value)
        elif name == COMPARE:
            self._on_compare(value)
        elif name == BROUGHT:
            self._on_brought(value)
        elif name == WARM:
            self._session.warm_start = value
        elif name == VIEWS:
            self._session.draw(value)
        elif name == UNITS:
            self._session.watch(units=value)
        elif value is None:
            self._let_go(name)
        elif value == POINTS:
            self._on_setting(name, points_of(self._session.wanted, name))
        elif value == USUAL:
            self._on_setting(name, usual_value(self._session.wanted, name))
        else:
            self._on_setting(name, value, by_hand=hand)

    def obey(self) -> None:
        """Make the changes that were asked for; those of the next moment wait for its end."""
        asked, self._asked = self._asked, {}
        self._answered = self._heard
        if not asked:
            self._moment.stop()
            return
        self._moment.set(MOMENT)
        with self._session.together():
            said = [self._change(name, value) for name, value in asked.items()]
            if None not in said:
                self._session.refusal = joined(" ", list(filter(None, said)))
        self._answer()

    def _answer(self) -> None:
        """Show what holds, unless that was done: the controls wait for the number of their move."""
        if self.view.shown[""] != self._answered:
            self._show()

    def _change(self, name: str, value: Any) -> str | None:
        """Change a setting; say why not, or nothing if that was said already.

        A slider that is dragged beyond what holds goes as far as it can.
        """
        session, by_hand = self._session, name in self._in_hand
        if by_hand:
            session.drag = self._drag
        try:
            session.change(name, value, by_hand=by_hand)
        except SettingError as refusal:
            if name in self._ends:
                return None
            if by_hand:
                self._ends.add(name)
                end = last_that_holds(session.wanted, name, value)
                if end is not None:
                    session.change(name, end, by_hand=True)
            return refused(refusal, session.wanted, name, value, session.look.units)
        self._ends.discard(name)
        return ""

    def _on_scene(self, scene: str) -> None:
        self.obey()
        self._session.choose_scene(scene)
        self._answer()

    def _on_compare(self, choice: str) -> None:
        self.obey()
        session = self._session
        try:
            with session.together():
                session.twin, settings = pair(choice, session.wanted)
                session.start(settings)
        except SettingError as refusal:
            session.refusal = refused(refusal, session.wanted, units=session.look.units)
        self._answer()

    def _on_brought(self, file: tuple[str, str | None] | None) -> None:
        """Lay results of another program beside the runs of this scene, or take them away."""
        self.obey()
        session = self._session
        try:
            found = brought_in(*file, session.wanted) if file else None
        except SettingError as refusal:
            session.refusal = refused(refusal, session.wanted, units=session.look.units)
        else:
            session.brought, session.refusal = found, ""
            session.worker.send(Bring(found))
        self._answer()

    def _let_go(self, name: str) -> None:
        """Follow the end of a drag."""
        self._in_hand.discard(name)
        self.obey()
        self._ends.discard(name)
        self._drag, self._session.drag = self._drag + 1, 0
        self._session.let_go()
        # A slider whose move was refused waits for the answer to this, its last message.
        self._answer()

    def _on_setting(self, name: str, value: Any, *, by_hand: bool = False) -> None:
        """Make the first change at once, and of those of the next moment the newest then.

        A slider that is dragged sends more of them than the server could obey.
        """
        self._asked[name] = value
        (self._in_hand.add if by_hand else self._in_hand.discard)(name)
        if not self._moment.is_set:
            self.obey()
