"""The page: its header, the controls at the side, and the tabs of the main area."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.class_dialog import ClassDialog
from app.classroom import Member
from app.controls import Controls
from app.export import TakeAway
from app.keys import dialog, listen
from app.lessons.panel import LessonPanel
from app.link import Link, read, show, wait_at
from app.live import STYLE, Live, column
from app.messages import Pace
from app.pages import FULL, PAGES
from app.reports import Reports
from app.state import PACES, TABS, PageState
from app.supervisor import Supervisor
from app.whatif import WhatIf
from solver.settings import Settings

HEADER = 48
"""Pixels that the header takes."""
COMPACT = {
    "& .MuiToolbar-root": {"minHeight": f"{HEADER}px !important"},
}
BARE = {"& .header, & .main .MuiToolbar-root": {"display": "none"}}
IN_HEADER = {
    "& button": {
        "color": "#fff",
        "borderColor": "#ffffff80",
        "textTransform": "none",
        "padding": "2px 10px",
        "whiteSpace": "nowrap",
    },
    "& button.Mui-selected, & button.Mui-selected:is(:hover, :focus)": {
        "color": "#0b3d66",
        "backgroundColor": "#fff",
    },
}


class Page:
    """One page: its state, its worker, its widgets and views.

    Parameters
    ----------
    state
        Of the page.
    iteration
        At which the first run waits; 0 has it go on.

    Attributes
    ----------
    template
        What is served.
    """

    def __init__(self, state: PageState, iteration: int = 0) -> None:
        self.state, self._iteration = state, iteration
        document = pn.state.curdoc
        link = Link(state)
        self._supervisor = Supervisor(state, document)
        if not state.room:
            self._begin()
        self.live = Live(state, document)
        self.member = Member(state, self._supervisor, document)
        self.lesson = LessonPanel(
            state, self.live.transport, self._arrange, lambda: self.member.open_counts()
        )
        self.classroom = classroom = ClassDialog(self.member)
        self.lesson.view.stylesheets = classroom.view.stylesheets = [STYLE]
        self._beside = column("beside", self.live.view)
        self._tabs: dict[str, Any] = {TABS[0]: self._beside}
        self._main = column("main", self._beside)
        classroom.view.param.watch(lambda event: self._place(), "visible")
        take_away, self._words = TakeAway(state, self.live.display), dialog()
        actions = {
            "Lessons": ("school", self.lesson.offer),
            "A class": ("groups", classroom.open),
            "Presenter view (p)": ("slideshow", self.present),
            "Take away": ("download", take_away.open),
            "Keys and words (?)": ("help_outline", self._help),
        }
        self.template = pmui.Page(
            title="Slipfront",
            sidebar=[Controls(state, link.copy).view],
            sidebar_width=320,
            header=[self._header(actions)],
            main=[
                self._main,
                self.lesson.dialog,
                classroom.dialog,
                take_away.view,
                self._words,
            ],
            busy_indicator=None,
            sx=COMPACT,
        )
        self.lesson.view.param.watch(lambda event: self._on_lesson(), "visible")
        listen(document, {**self.live.transport.keys(), "p": self.present, "?": self._help})
        state.param.watch(lambda event: self._turn(event.new), "tab")
        state.param.watch(lambda event: self._dress(), "view")
        state.param.watch(lambda *events: self.lesson.update(), ["frame", "selection"])
        self.lesson.show()
        self._turn(state.tab)
        self._dress()
        self._supervisor.take()

    def loaded(self) -> None:
        """Let the first run go on, or follow a class, now that a browser is there."""
        self._supervisor.open()
        if not self.state.room:
            if not self._iteration:
                self.state.send(Pace(PACES[self.state.pace]))
        elif not self.member.enter(self.state.room):
            self._begin()
            self.state.run()

    def _begin(self) -> None:
        """Start the worker and a run, whose first picture comes with the page."""
        self._supervisor.begin()
        if self._iteration:
            wait_at(self.state, self._iteration)
        else:
            self.state.open()

    def end(self, _context: Any) -> None:
        """Leave nothing behind."""
        self.member.close()
        self._supervisor.end()
        PAGES.leave()

    def present(self) -> None:
        """Show the page as a projector needs it, or as before."""
        self.state.view = "present" if self.state.view == "page" else "page"

    def _header(self, actions: dict[str, tuple[str, Callable[[], Any]]]) -> pn.Row:
        tabs = pmui.RadioButtonGroup.from_param(
            self.state.param.tab, label="", size="small", margin=(0, 8), sx=IN_HEADER
        )
        buttons = []
        for title, (icon, action) in actions.items():
            button = pmui.IconButton(icon=icon, description=title, color="light", margin=0)
            button.on_click(lambda event, action=action: action())
            buttons.append(button)
        space = pn.layout.HSpacer()
        return pn.Row(tabs, space, *buttons, sizing_mode="stretch_width", align="center")

    def _arrange(self) -> None:
        self.live.arrange(self.lesson.kinds)

    def _turn(self, tab: str) -> None:
        """Show a tab, which is built when it is first opened."""
        if tab not in self._tabs:
            made = WhatIf(self.state, self._open_run) if tab == TABS[1] else Reports(self.state)
            self._tabs[tab] = made.view
        self._place()
        self.live.look()

    def _open_run(self, settings: Settings) -> None:
        """Show a run on the live tab."""
        self.state.tab = TABS[0]
        self.state.adopt(settings)

    def _help(self) -> None:
        self._words.open = True

    def _on_lesson(self) -> None:
        """Give a lesson the room of the controls: it has those that it speaks of."""
        self._place()
        self._dress()

    def _place(self) -> None:
        """Have on the page what is seen: beside what is hidden figures are not painted."""
        # What comes in front is appended, and put there by the style sheet: a column whose children
        # change their order loses some of them.
        lesson, classroom = self.lesson.view, self.classroom.view
        self._beside.css_classes = ["beside", *["taught"] * lesson.visible]
        views = (
            (self._beside, [self.live.view] + [lesson] * lesson.visible),
            (self._main, [self._tabs[self.state.tab]] + [classroom] * classroom.visible),
        )
        for place, objects in views:
            if list(place) != objects:
                place[:] = objects

    def _dress(self) -> None:
        """Have nothing around the plots in the views for a projector and for a frame."""
        is_bare = self.state.view != "page"
        self.template.param.update(
            sx=BARE if is_bare else COMPACT,
            sidebar_open=not (is_bare or self.lesson.view.visible),
        )


def open_page() -> pmui.Page:
    """The page of one session; its run starts when the browser is there."""
    pn.extension(notifications=True, reconnect=True, respect_explicit_sizing=True)
    if not PAGES.enter():
        return pmui.Page(title="Slipfront", main=[pn.pane.HTML(FULL, css_classes=["full"])])
    location = pn.state.location
    place, refusal = read(location.search if location is not None else "")
    state = PageState(place.settings, refusal=refusal)
    show(state, replace(place, iteration=0))
    page = Page(state, place.iteration)
    if place.theme:
        page.template.dark_theme = place.theme == "dark"
    pn.state.onload(page.loaded)
    pn.state.on_session_destroyed(page.end)
    return page.template
