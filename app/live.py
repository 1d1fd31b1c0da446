"""The live run: buttons and words, the scene, its time line, and cards of plots."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.browser import Display
from app.state import TABS, PageState
from app.status import figures_line, status_line
from app.transport import Transport
from app.views.catalogue import CARDS
from app.views.layout import is_high
from app.views.scene import Scene
from app.views.timeline import Timeline
from app.views.view import TEXT, View
from app.widgets import PlainText, looks, wrapped

STYLE = (Path(__file__).parents[1] / "static" / "style.css").read_text(encoding="utf-8")
LARGE = 0.026
"""Type size of plots on a projector over the window's height."""
LOW = 56
HIGH = 0.13
"""Height of the time line: px on the page, share of the window's on a projector."""
LOOK = 1000
"""Milliseconds between two looks for a picture that got lost."""
PRESENTED = 2
"""Number of plots beside the scene on a projector."""


class Live:
    """The live run on the page: its transport, its display, and its views."""

    def __init__(self, state: PageState, document: Any) -> None:
        self.state = state
        self._document = document
        self._status = _words("status", margin=(4, 6), styles={"flex": "1 1 240px"})
        self._sentence = PlainText(
            css_classes=["sentence"], stylesheets=[STYLE], margin=(0, 8)
        )
        self._figures = _words("figures")
        self._views: list[View] = [Scene(state), Timeline(state)]
        self._all = self._cards = [Card(kinds, state) for kinds in CARDS]
        self.transport = Transport(state, document)
        self.display = Display(state, document, self._write)
        document.add_root(self.display.pulse)
        document.add_periodic_callback(self.display.catch_up, LOOK)
        # While the browser loads.
        document.add_next_tick_callback(self.prepare)
        self._above = wrapped(
            self.transport.view, self._status, sizing_mode="stretch_width"
        )
        self._scene = column("scene")
        self._plots = column("plots")
        self._timeline = pn.Row(
            self.transport.play_button,
            sizing_mode="stretch_width",
            height=LOW,
            margin=0,
        )
        self._is_open = False
        look = {"css_classes": ["words"], "sizing_mode": "stretch_width"}
        styles = {"flex-wrap": "wrap", "justify-content": "space-between"}
        below = wrapped(self._sentence, self._figures, styles=styles, **look)
        self.view = column("live", self._above, below)
        state.param.watch(
            lambda *events: self._write(), ["running", "message", "refusal"]
        )
        state.param.watch(lambda event: self._fade(), "is_stale")
        state.param.watch(lambda *events: self._fit(), ["settings", "plots"])

    def prepare(self) -> None:
        """Make the figures in sight."""
        for card in self._cards:
            card.fit()
        for view in self._in_sight():
            view.figure  # noqa: B018  # it is made when it is first asked for

    def open(self, kinds: tuple[type[View], ...] | None) -> None:
        """Show the figures once the browser has all other widgets.

        It would lay the figures out anew for each widget that follows.
        """
        self._is_open = True
        self.arrange(kinds)
        boxes = (self._scene, self._timeline)
        for box, view in zip(boxes, self._views, strict=True):
            box.append(pn.pane.Bokeh(view.figure, margin=0, sizing_mode="stretch_both"))
        # All at once: each change goes through all models of the document.
        self.view.extend([self._scene, self._timeline, self._plots])

    # What changes within a hold is sent at once, and in this order.
    @pn.io.hold()
    def arrange(self, kinds: tuple[type[View], ...] | None) -> None:
        """Show the cards, or the plots of a lesson.

        While its question is open, texts that give the answer away are hidden.
        """
        state = self.state
        self._cards = self._all
        if kinds is not None:
            self._cards = [Card((kind,), state) for kind in kinds]
        elif state.view != "page":
            self._cards = self._all[:PRESENTED]
        self._above.visible = not state.is_asked
        self._figures.visible = not state.is_asked
        # Without plots the scene has all the height.
        if self._cards:
            self._plots.css_classes = ["plots"]
        else:
            self._plots.css_classes = []
        # The tabs of the cards first: of tabs that change while they are being shown
        # some are lost.
        self._fit()
        if self._is_open:
            self._plots[:] = [card.view for card in self._cards]
        self.transport.view.visible = state.view == "page"
        size = TEXT
        self._timeline.height = LOW
        if state.view == "present":
            size = f"{LARGE * state.height:.0f}px"
            self._timeline.height = int(HIGH * state.height)
        self._magnify(size)
        self._reshape()

    def _magnify(self, size: str) -> None:
        """Set the type size of all views, as CSS has it."""
        for view in self._views:
            view.magnify(size)
        for card in self._cards:
            for view in card.views:
                view.magnify(size)

    @property
    def _shape(self) -> list[str]:
        """CSS classes: plots stand beside a high picture, unless a text does."""
        state = self.state
        classes = ["live", state.view]
        has_text = bool(state.lesson or state.case)
        if not has_text and state.frame is not None:
            if is_high(state.frame.run.geometry):
                classes.append("high")
        case = state.trade_case
        if case is not None and case.surroundings is not None:
            if case.surroundings.is_upright:
                classes += ["high", "upright"]
        if state.is_stale:
            classes.append("stale")
        return classes

    def _reshape(self) -> None:
        self.view.css_classes = self._shape

    def _fade(self) -> None:
        """Fade what is of a run before the present one."""
        self._reshape()
        self._write()

    def look(self) -> None:
        """Have the views in sight updated, and no others."""
        if self._is_open and self.state.tab == TABS[0]:
            self.display.look_at(self._in_sight())
        else:
            self.display.look_at([])

    def _in_sight(self) -> list[View]:
        seen = [card.seen for card in self._cards if card.seen is not None]
        return self._views + seen

    def _fit(self) -> None:
        if self._is_open:
            with pn.io.hold():
                for card in self._cards:
                    card.fit()
            self.look()

    def _write(self) -> None:
        """Set the status, the key figures and the sentence to those of the frame."""
        frame = self.state.frame
        self._status.object = status_line(self.state)
        if frame is not None:
            self._figures.object = figures_line(frame, self.state.selection)
            sentence = frame.run.sentence
            if self.state.trade_case is not None:
                sentence = self.state.trade_case.sentence_on(sentence)
            self._sentence.object = sentence
            if self._shape != self.view.css_classes:
                # In one step with new data the browser would paint the old ones in the
                # new shape.
                self._document.add_next_tick_callback(self._reshape)


class Card:
    """Views that share a place as tabs; `seen` is the one in sight."""

    def __init__(self, kinds: tuple[type[View], ...], state: PageState) -> None:
        self._state = state
        self.views = [kind(state) for kind in kinds]
        self.seen: View | None = None
        self._offered: list[View] = []
        self._panes: dict[View, pn.pane.Bokeh] = {}
        look = {"margin": 0, "sizing_mode": "stretch_width", **looks("small-tabs")}
        self.tabs = pmui.TabMenu(items=[], **look)
        self.tabs.param.watch(lambda event: self._choose(event.new or 0), "active")
        self.view = pn.Column(
            self.tabs, sizing_mode="stretch_both", min_height=170, margin=0
        )

    def fit(self) -> None:
        """Offer the views that apply to the settings; show the one in the state."""
        state = self._state
        offered = [view for view in self.views if view.applies(state.settings)]
        named = [view for view in offered if view.name in state.plots]
        seen = next(iter(named or offered), None)
        if offered == self._offered and seen == self.seen:
            return
        is_turned = seen is not self.seen
        self._offered = offered
        self.seen = seen
        self.view.visible = bool(offered)
        active = 0
        if seen is not None:
            active = offered.index(seen)
        # The bounds of `active` follow the items only after its value was checked.
        self.tabs.param.active.bounds = (0, max(len(offered) - 1, 0))
        self.tabs.param.update(items=[view.name for view in offered], active=active)
        if is_turned:
            if seen is not None:
                self.view[:] = [self.tabs, self._pane(seen)]
            else:
                self.view[:] = [self.tabs]

    def _choose(self, number: int) -> None:
        """Name the view of a tab in the state; the first tab needs no name."""
        view = self._offered[number]
        if view is self.seen:
            return
        mine = {other.name for other in self.views}
        names = [name for name in self._state.plots if name not in mine]
        if number > 0:
            names.append(view.name)
        self._state.plots = names

    def _pane(self, view: View) -> pn.pane.Bokeh:
        """The figure of a view with the frame; the figure is made when first seen."""
        state = self._state
        if view not in self._panes:
            self._panes[view] = pn.pane.Bokeh(
                view.layout, sizing_mode="stretch_both", margin=0
            )
        if state.frame is not None:
            view.update(state.frame, state.selection, state.ghost)
        return self._panes[view]


def column(role: str, *parts: Any) -> pn.Column:
    """A column that style sheets know by its role."""
    return pn.Column(
        *parts,
        css_classes=[role],
        stylesheets=[STYLE],
        sizing_mode="stretch_width",
        margin=0,
    )


def _words(role: str, **more: Any) -> pn.pane.HTML:
    """A pane of words, which tests and style sheets know by its role."""
    return pn.pane.HTML(
        css_classes=[role], stylesheets=[STYLE], **{"margin": (0, 8), **more}
    )
