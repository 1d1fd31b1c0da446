"""A text beside the page, in which settings are changed: what lessons and cases have alike."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, ClassVar

import panel as pn
import param

from app.controls import SettingControl
from app.lessons.catalogue import plots_of, settings_of
from app.state import PageState
from app.widgets import button, dialog, looks
from solver.lessons import Lesson
from solver.study.cases.case import Case

text_button = partial(button, margin=(3, 8, 3, 0))


class Guide(ABC):
    """The text that a page is in, if it is in one.

    `changed` is called when another one is shown. `view` stands beside the plots, `dialog` is the
    list of all.
    """

    kind: ClassVar[str]
    """What the state calls the name of the one that is open."""
    known: ClassVar[Mapping[str, Lesson | Case]]
    """All of them, by name."""

    def __init__(self, state: PageState, title: str, changed: Callable[[], None]) -> None:
        self._state, self._changed = state, changed
        self._texts: list[tuple[pn.pane.Markdown, Callable[[], str]]] = []
        self._controls: list[SettingControl] = []
        self.view = pn.Column(css_classes=["lesson"], margin=(0, 8), visible=False)
        self.dialog = dialog(title, width_option="md")
        state.param.watch(lambda event: self._follow_settings(), "settings")
        state.param.watch(lambda event: self.update(), "frame")

    def open(self, name: str) -> None:
        """Begin one, with its scene and settings, in place of another."""
        self.dialog.open = False
        places = {"lesson": "", "case": "", "prediction": None, "plots": plots_of(name)}
        with param.parameterized.batch_call_watchers(self._state):
            self._state.param.update(**places | {self.kind: name})
            self._state.adopt(settings_of(self.known[name]))

    def offer(self) -> None:
        """Show the list of all."""
        if not self.dialog.objects:
            self.dialog[:] = [self._list()]
        self.dialog.open = True

    def update(self) -> None:
        """Bring the quantities in its sentences up to the frame."""
        for pane, text in self._texts:
            pane.object = text()

    @abstractmethod
    def show(self) -> None:
        """Show the one that is open, or none."""

    @abstractmethod
    def _list(self) -> Any:
        """What the dialog has."""

    def _fill(self, make: Callable[[], list[Any]], readings: list[str]) -> None:
        """Show what a function makes, which needs quantities of the run; nothing hides the view."""
        self._texts, self._controls = [], []
        if readings or not (self._state.lesson or self._state.case):
            self._state.readings = readings
        parts = make()
        self.view.param.update(objects=parts, visible=bool(parts))
        self._changed()

    def _markdown(self, text: Callable[[], str]) -> pn.pane.Markdown:
        """A pane of text that follows the frame."""
        look = {"margin": 0, "sizing_mode": "stretch_width", **looks("paragraph")}
        pane = pn.pane.Markdown(text(), **look)
        self._texts.append((pane, text))
        return pane

    def _control(self, name: str) -> Any:
        """The control of a setting."""
        self._controls.append(SettingControl(name, self._state))
        return self._controls[-1].view

    def _follow_settings(self) -> None:
        """Leave it for another scene; show its controls as settings are."""
        shown = self.known.get(getattr(self._state, self.kind))
        if shown is not None and self._state.settings.scene != shown.settings.scene:
            self._end()
        for control in self._controls:
            control.update()

    def _end(self) -> None:
        """Leave it; the run stays."""
        self._state.param.update(**{self.kind: ""})
