"""The page: controls at the side, the scene, its load path as time line, and four plots."""

from __future__ import annotations

from dataclasses import replace

import panel as pn
import panel_material_ui as pmui

from app.cards import Card
from app.controls import Controls
from app.display import Display
from app.link import Link, read, show, wait_at
from app.messages import Report
from app.state import PageState
from app.views.catalogue import CARDS
from app.views.scene import Scene
from app.views.timeline import Timeline
from app.worker.process import Worker


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
        self._link = Link(state)
        self._document = pn.state.curdoc
        self._worker: Worker | None = None
        self._status = pn.pane.HTML("starting", css_classes=["status"], margin=(8, 8))
        self.display = Display(state, self._say)
        self._document.add_root(self.display.pulse)
        state.param.watch(lambda *e: self._say(), ["running", "message", "refusal", "is_costly"])
        self._scene, self._timeline = Scene(state), Timeline(state)
        self._cards = [Card(kinds, state, self._look) for kinds in CARDS]
        state.param.watch(lambda event: self._fit(), "settings")
        self._fit()
        run = pmui.Button(label="Run", on_click=lambda event: state.go_on())
        step = pmui.Button(label="Step", on_click=lambda event: state.step())
        pace = pmui.Select.from_param(state.param.pace, size="small", width=140)
        scene = pn.pane.Bokeh(self._scene.figure, sizing_mode="stretch_both", margin=0)
        timeline = pn.pane.Bokeh(self._timeline.figure, sizing_mode="stretch_width", height=56, margin=0)
        live = pn.Column(
            pn.Row(run, step, pace, self._status, margin=0),
            pn.Column(scene, sizing_mode="stretch_width", margin=0, styles={"flex": "2 1 0", "min-height": "110px"}),
            timeline,
            pn.Column(
                *(card.view for card in self._cards),
                sizing_mode="stretch_width",
                margin=0,
                styles={
                    "flex": "5 1 0",
                    "display": "grid",
                    "grid-template-columns": "repeat(auto-fit, minmax(min(100%, 400px), 1fr))",
                    "grid-auto-rows": "minmax(170px, 1fr)",
                    "gap": "4px",
                },
            ),
            sizing_mode="stretch_width",
            margin=0,
            styles={"height": "calc(100vh - 68px)", "overflow": "auto"},
        )
        self.template = pmui.Page(title="Slipfront", sidebar=[Controls(state).view], main=[live])

    def _fit(self) -> None:
        for card in self._cards:
            card.fit(self.state)

    def _look(self) -> None:
        """Have the views in sight updated."""
        cards = getattr(self, "_cards", [])
        seen = [view for card in cards if (view := card.seen) is not None]
        self.display.views = [self._scene, self._timeline, *seen]

    def loaded(self) -> None:
        """Start the worker and the first run, now that a browser is there."""
        self._start_worker()
        if self._iteration:
            wait_at(self.state, self._iteration)
        else:
            self.state.run()

    def end(self) -> None:
        """Leave nothing behind."""
        if self._worker is not None:
            self._worker.end()

    def _start_worker(self) -> None:
        self._worker = Worker(self._hear)
        self.state.send = self._worker.send

    def _hear(self, report: Report | None) -> None:
        self._document.add_next_tick_callback(lambda: self._take(report))

    def _take(self, report: Report | None) -> None:
        if report is None:
            self.state.message = "The solver's process has ended; it is started anew."
            self._start_worker()
            self.state.run()
        else:
            self.state.take(report)

    def _say(self) -> None:
        state, newest = self.state, self.state.newest
        if newest is None:
            text = "starting"
        elif newest.status is None:
            text = f"<b>iteration {newest.iteration}</b>"
        else:
            sure = "certified" if newest.is_answer else ""
            text = f"<b>{newest.iteration} iterations</b> {sure} {100 * newest.error:.2g} % wrong"
        self._status.object = " ".join(filter(None, [text, state.message, state.refusal]))


def open_page() -> pmui.Page:
    """The page of one session; its run starts when the browser is there."""
    pn.extension(notifications=True, reconnect=True, respect_explicit_sizing=True)
    location = pn.state.location
    place, refusal = read(location.search if location is not None else "")
    state = PageState(place.settings, refusal=refusal)
    show(state, replace(place, iteration=0))
    page = Page(state, place.iteration)
    if place.theme:
        page.template.dark_theme = place.theme == "dark"
    pn.state.onload(page.loaded)
    pn.state.on_session_destroyed(lambda context: page.end())
    return page.template
