"""The page: controls at the side, the scene, its load path as time line, and four plots."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.cards import Card
from app.class_dialog import ClassDialog
from app.classroom import Member
from app.controls import Controls
from app.display import Display
from app.keys import listen
from app.lessons.panel import LessonPanel
from app.link import Link, read, show, wait_at
from app.pages import FULL, PAGES
from app.state import TABS, PageState
from app.status import figures_line, status_line
from app.supervisor import Supervisor
from app.transport import Transport
from app.views.catalogue import CARDS
from app.views.scene import Scene
from app.views.timeline import Timeline
from app.views.view import View

STYLE = (Path(__file__).parents[1] / "static" / "style.css").read_text(encoding="utf-8")
HEADER = 52
"""Pixels that the header takes."""
COMPACT = {"& .MuiToolbar-root": {"minHeight": f"{HEADER}px !important"}}
BARE = {"& .header, & .main .MuiToolbar-root": {"display": "none"}}
IN_HEADER = {
    "& button": {
        "color": "#fff",
        "borderColor": "#ffffff80",
        "textTransform": "none",
        "padding": "3px 10px",
        "whiteSpace": "nowrap",
    },
    "& button.Mui-selected, & button.Mui-selected:hover": {
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
        Link(state)
        document = pn.state.curdoc
        self._supervisor = Supervisor(state, document)
        self._status = words("status", margin=(8, 6))
        self._sentence, self._figures = words("sentence"), words("figures", width_policy="min")
        self.display = Display(state, self._say)
        document.add_root(self.display.pulse)
        state.param.watch(lambda *e: self._say(), ["running", "message", "refusal", "is_costly"])
        self._scene, self._timeline = Scene(state), Timeline(state)
        self._cards = self._all_cards = [Card(kinds, state, self._look) for kinds in CARDS]
        self._transport = Transport(state, document)
        state.param.watch(lambda event: self._fit(), "settings")
        self.controls = Controls(state)
        self.member = Member(state, self._supervisor, document)
        self.classroom = ClassDialog(self.member)
        self.live = self._make_live()
        self.lesson = LessonPanel(
            state, self._transport, self._arrange, lambda: self.member.open_counts()
        )
        self.lesson.view.stylesheets = [STYLE]
        beside = pn.Row(
            self.lesson.view,
            self.live,
            sizing_mode="stretch_width",
            css_classes=["beside"],
            margin=0,
            stylesheets=[STYLE],
        )
        dialogs = self.lesson.dialog, self.classroom.dialog
        self._main = pn.Column(
            self.classroom.view, beside, *dialogs, sizing_mode="stretch_width", margin=0
        )
        self._built: dict[str, Any] = {TABS[0]: beside}
        self.template = pmui.Page(
            title="Slipfront",
            sidebar=[self.controls.view],
            sidebar_width=320,
            header=[self._header()],
            main=[self._main],
            busy_indicator=None,
            sx=COMPACT,
        )
        self._arrange()
        keys = {**self._transport.keys(), "p": self._present}
        listen(document, keys)
        state.param.watch(lambda event: self._turn(event.new), "tab")
        state.param.watch(lambda event: self._dress(), "view")
        self._turn(state.tab)
        self._dress()

    def loaded(self) -> None:
        """Start the worker and the first run, now that a browser is there."""
        if self.member.enter(self.state.room):
            return
        self._supervisor.begin()
        if self._iteration:
            wait_at(self.state, self._iteration)
        else:
            self.state.run()

    def end(self, _context: Any) -> None:
        """Leave nothing behind."""
        self.member.close()
        self._supervisor.end()
        PAGES.leave()

    def _make_live(self) -> pn.Column:
        pane = lambda view, **more: pn.pane.Bokeh(view.figure, margin=0, **more)  # noqa: E731
        self._above = above = pn.Row(
            self._transport.view, self._status, sizing_mode="stretch_width", margin=0
        )
        below = pn.FlexBox(self._sentence, self._figures, justify_content="space-between", margin=0)
        scene = pn.Column(
            pane(self._scene, sizing_mode="stretch_both"),
            sizing_mode="stretch_width",
            css_classes=["scene"],
            margin=0,
        )
        timeline = pn.Row(
            self._transport.play_button,
            pane(self._timeline, sizing_mode="stretch_width", height=56),
            sizing_mode="stretch_width",
            margin=0,
        )
        self._plots = plots = pn.Column(
            *(card.view for card in self._cards),
            sizing_mode="stretch_width",
            css_classes=["plots"],
            margin=0,
            stylesheets=[STYLE],
        )
        return pn.Column(
            above,
            below,
            scene,
            timeline,
            plots,
            sizing_mode="stretch_width",
            css_classes=["live"],
            margin=0,
            stylesheets=[STYLE],
        )

    def _header(self) -> pn.Row:
        tabs = pmui.RadioButtonGroup.from_param(
            self.state.param.tab, label="", size="small", margin=(0, 8), sx=IN_HEADER
        )
        present = pmui.IconButton(icon="slideshow", description="Presenter view (p)", color="light")
        present.on_click(lambda event: self._present())
        lessons = pmui.IconButton(icon="school", description="Lessons", color="light")
        lessons.on_click(lambda event: self.lesson.offer())
        together = pmui.IconButton(icon="groups", description="A class", color="light")
        together.on_click(lambda event: self.classroom.open())
        return pn.Row(
            tabs,
            pn.layout.HSpacer(),
            lessons,
            together,
            present,
            sizing_mode="stretch_width",
            align="center",
        )

    def _fit(self) -> None:
        for card in self._cards:
            card.fit(self.state)

    def _arrange(self) -> None:
        """Have the plots of a lesson in place of the others; what gives its answer away waits."""
        if not hasattr(self, "lesson"):
            return
        kinds, is_asked = self.lesson.kinds, self.state.is_asked
        self._cards = self._all_cards
        if kinds is not None:
            self._cards = [Card((kind,), self.state, self._look) for kind in kinds]
        self._above.visible = self._figures.visible = not is_asked
        self._plots.visible = bool(self._cards)
        self._plots[:] = [card.view for card in self._cards]
        self._fit()
        self._look()

    def _look(self) -> None:
        """Have the views in sight updated, and no others."""
        seen: list[View] = []
        if self.state.tab == TABS[0]:
            cards = getattr(self, "_cards", [])
            seen = [self._scene, self._timeline, *(v for card in cards if (v := card.seen))]
        self.display.views = seen

    def _turn(self, tab: str) -> None:
        """Show a tab, which is built when it is first opened."""
        if tab not in self._built:
            self._built[tab] = pn.pane.Markdown(tab)
            self._main.append(self._built[tab])
        for name, view in self._built.items():
            view.visible = name == tab
        self._look()

    def _present(self) -> None:
        self.state.view = "present" if self.state.view == "page" else "page"

    def _dress(self) -> None:
        """Have nothing around the plots in the views for a projector and for a frame."""
        is_bare = self.state.view != "page"
        self.template.param.update(sx=BARE if is_bare else COMPACT, sidebar_open=not is_bare)

    def _say(self) -> None:
        """Bring the words of the run up to the frame."""
        frame = self.state.frame
        self._status.object = status_line(self.state)
        if frame is not None:
            self._figures.object = figures_line(frame, self.state.selection)
            self._sentence.object = frame.run.sentence
            self.lesson.update()


def words(role: str, **more: Any) -> pn.pane.HTML:
    """A pane of words, which tests and style sheets know by its role."""
    return pn.pane.HTML(css_classes=[role], stylesheets=[STYLE], **{"margin": (0, 8), **more})


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
