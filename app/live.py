"""The live run: buttons and words, the scene, its time line, and cards of plots."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.display import Display
from app.messages import TABLE
from app.state import TABS, PageState
from app.status import figures_line, status_line
from app.templates import html
from app.transport import Transport
from app.views.catalogue import CARDS, LARGE_CARDS
from app.views.layout import shape_of
from app.views.parts import come_last, laid_out_alone
from app.views.scene import Scene
from app.views.timeline import Timeline
from app.views.type_size import TEXT
from app.views.view import View
from app.widgets import MEANINGS, PlainText, changing_text, looks, wrapped

STYLE = (Path(__file__).parents[1] / "static" / "style.css").read_text(encoding="utf-8")
LARGE = 0.026
"""Type size of plots on a projector over the window's height."""
ROOM = 900
"""Height of a window, px, from which all cards have room."""
LOOK = 500
"""Milliseconds between two looks for a picture that got lost, or has not gone yet."""
Kinds = tuple[type[View], ...]
"""Views of one card."""


class Live:
    """The live run on the page: its transport, its display, and its views."""

    def __init__(self, state: PageState, document: Any) -> None:
        self.state = state
        self._document = document
        styles = {"flex": "1 1 240px"}
        self._status = changing_text(
            css_classes=["status"], stylesheets=[STYLE], margin=(4, 6), styles=styles
        )
        self._sentence = PlainText(
            css_classes=["sentence"], stylesheets=[STYLE], margin=(0, 8)
        )
        self._figures = changing_text(
            css_classes=["figures"], stylesheets=[STYLE], margin=(0, 8)
        )
        self._views: list[View] = [Scene(state), Timeline(state)]
        self._known: dict[type[View], View] = {}
        self._cards: list[Card] = []
        self.transport = Transport(state, document)
        self.display = Display(state, document, self._write)
        document.add_root(self.display.pulse)
        document.add_periodic_callback(self.display.catch_up, LOOK)
        self._above = wrapped(
            self.transport.view,
            self._status,
            css_classes=["above"],
            sizing_mode="stretch_width",
        )
        self._scene = column("scene")
        self._plots = column("plots")
        self._timeline = pn.Column(
            sizing_mode="stretch_width", margin=0, **looks("timeline")
        )
        self._times = pn.Row(
            self.transport.play_button,
            pn.Column(
                self._timeline,
                self.transport.iterate,
                self.transport.scrub,
                sizing_mode="stretch_width",
                margin=0,
            ),
            css_classes=["times"],
            sizing_mode="stretch_width",
            margin=0,
        )
        self._is_open = False
        self._has_sheet = False
        self._also: list[str] = []
        look = {"css_classes": ["words"], "sizing_mode": "stretch_width"}
        styles = {"flex-wrap": "wrap", "justify-content": "space-between"}
        below = wrapped(self._sentence, self._figures, styles=styles, **look)
        self.view = column("live", self._above, below)
        state.param.watch(
            lambda *events: self._write(),
            ["running", "message", "refusal", "is_stale"],
        )
        state.param.watch(lambda *events: self._fit(), ["settings", "plots"])

    def prepare(self, kinds: Kinds | None) -> None:
        """Make the figures that will be in sight, while the browser loads."""
        self._choose_cards(kinds)
        for card in self._cards:
            card.fit()
        for view in self._in_sight():
            view.figure  # noqa: B018  # it is made when it is first asked for

    def open(self, kinds: Kinds | None) -> None:
        """Show the figures once the browser has all other widgets."""
        self._is_open = True
        self.arrange(kinds)
        boxes = (self._scene, self._timeline)
        panes = [card.pane for card in self._cards if card.pane is not None]
        for box, view in zip(boxes, self._views, strict=True):
            pane = laid_out_alone(view.figure)
            panes.append(pane)
            box.append(pane)
            view.hold(True)
        # All at once: each change goes through all models of the document.
        with come_last(panes, self._document):
            self.view.extend([self._scene, self._times, self._plots])

    # What changes within a hold is sent at once, and in this order.
    @pn.io.hold()
    def arrange(self, kinds: Kinds | None) -> None:
        """Show the cards, or the plots of a lesson."""
        self._choose_cards(kinds)
        if self.state.view == "present":
            self.transport.present()
        self._magnify(type_size(self.state))
        self._reshape()
        self._fit()

    def _choose_cards(self, kinds: Kinds | None) -> None:
        """Have as many cards as the window has room for, of all views or a lesson's."""
        has_room = self.state.view == "page" and self.state.height >= ROOM
        groups: tuple[Kinds, ...] = LARGE_CARDS
        if kinds is None:
            if has_room:
                groups = CARDS
        elif has_room:
            groups = tuple([(kind,) for kind in kinds])
        else:
            groups = tuple([group for group in (kinds[:1], kinds[1:]) if group])
        if groups == tuple([card.kinds for card in self._cards]):
            return
        # A figure stands in one place only. Cards that have left the page are emptied
        # without a layout of what is there.
        self._plots.clear()
        for card in self._cards:
            card.view.clear()
        self._cards = [
            Card([self._view(kind) for kind in group], self.state) for group in groups
        ]

    def _view(self, kind: type[View]) -> View:
        """The only view of a kind, whichever card shows it."""
        if kind not in self._known:
            self._known[kind] = kind(self.state)
        return self._known[kind]

    def _magnify(self, size: str) -> None:
        """Set the type size of all views, as CSS has it."""
        for view in self._views:
            view.magnify(size)
        for card in self._cards:
            for view in card.views:
                view.magnify(size)

    @property
    def _shape(self) -> list[str]:
        """CSS classes that say what is shown, and where, all in one change.

        Plots, if there are any, are next to a high picture, and below a broad one.
        While the question of a lesson is open, texts that give the answer away are
        hidden. Beside a text that tells what is seen a projector has no sentence on it.
        """
        state = self.state
        classes = ["live", state.view]
        if state.is_asked:
            classes.append("asked")
        if state.lesson or state.case:
            classes.append("told")
        if state.frame is not None and len(state.frame.run.surfaces) > 1:
            classes.append("several")
        if not self._cards:
            classes.append("alone")
        if self._has_sheet:
            classes.append("with-sheet")
        shape = []
        if state.frame is not None:
            shape = [shape_of(state.frame.run.geometry)]
        case = state.trade_case
        if case is not None and case.surroundings is not None:
            if case.surroundings.is_upright:
                shape = ["high", "upright"]
        classes += shape
        return classes

    def _reshape(self) -> None:
        self.view.css_classes = self._shape

    def make_room(self, is_needed: bool) -> None:
        """Make room above the controls where they are a sheet below the picture."""
        self._has_sheet = is_needed
        self._reshape()

    def look(self) -> None:
        """Have the views in sight updated, and no others."""
        if not self._is_open:
            return
        views: list[View] = []
        if self.state.tab == TABS[0]:
            views = self._in_sight()
        self.display.look_at(views, self._also)

    def offer(self, is_offered: bool) -> None:
        """Have frames with all that is taken away, as long as files are offered."""
        self._also = []
        if is_offered:
            self._also.append(TABLE)
        self.look()

    def _in_sight(self) -> list[View]:
        seen = [card.seen for card in self._cards if card.seen is not None]
        return self._views + seen

    def _fit(self) -> None:
        if not self._is_open:
            return
        with pn.io.hold():
            # The tabs of the cards first: of tabs that change while they are being
            # shown some are lost.
            for card in self._cards:
                card.fit()
            # A card without a view would leave its place empty.
            shown = [card.view for card in self._cards if card.seen is not None]
            if list(self._plots) != shown:
                self._plots[:] = shown
            # Without plots the scene has all the height.
            roles = []
            if shown:
                roles = ["plots"]
            self._plots.css_classes = roles
        self.look()

    @pn.io.hold()
    def _write(self) -> None:
        """Set all words on the run to those of the frame: status, figures, sentence."""
        frame = self.state.frame
        self._status.text = escape(status_line(self.state))
        if frame is not None:
            self.transport.name_iterate()
            text = figures_line(frame, self.state.selection)
            self._figures.text = escape(text)
            sentence = frame.run.sentence
            if self.state.trade_case is not None:
                sentence = self.state.trade_case.sentence_on(sentence)
            self._sentence.object = sentence
            self._reshape()


class Card:
    """Views that share a place as tabs; `seen` is the one in sight, in its `pane`."""

    def __init__(self, views: list[View], state: PageState) -> None:
        self._state = state
        self.views = views
        self.kinds: Kinds = tuple([type(view) for view in views])
        self.seen: View | None = None
        self.pane: pn.pane.Bokeh | None = None
        self._offered: list[View] = []
        # Beside them is the mark of what the plot shows.
        look = {"margin": (0, 28, 0, 0), **looks("small-tabs")}
        look["sizing_mode"] = "stretch_width"
        self.tabs = pmui.TabMenu(items=[], variant="scrollable", **look)
        self.tabs.param.watch(lambda event: self._choose(event.new or 0), "active")
        self._about = pn.pane.HTML(css_classes=["about"], stylesheets=[STYLE], margin=0)
        self.view = pn.Column(
            self.tabs, sizing_mode="stretch_both", min_height=170, margin=0
        )

    def fit(self) -> None:
        """Offer the views that apply to the settings; show the one in the state."""
        state = self._state
        offered = [view for view in self.views if view.applies(state.settings)]
        seen = None
        if offered:
            seen = offered[on_top(offered, state)]
        if offered == self._offered and seen == self.seen:
            return
        is_turned = seen is not self.seen
        self._offered = offered
        self.seen = seen
        active = 0
        if seen is not None:
            active = offered.index(seen)
        # The bounds of `active` follow the items only after its value was checked.
        self.tabs.param.active.bounds = (0, max(len(offered) - 1, 0))
        self.tabs.param.update(items=[view.name for view in offered], active=active)
        if is_turned:
            self.pane = None
            if seen is not None:
                meaning = MEANINGS[seen.name]
                self._about.object = html("term.html", term="?", meaning=meaning)
                self.pane = self._pane(seen)
                self.view[:] = [self.tabs, self._about, self.pane]
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
        pane = laid_out_alone(view.layout)
        # It is painted once it has its size; see `Display`.
        view.hold(True)
        if state.frame is not None:
            view.update(state.frame, state.selection, state.ghost)
        return pane


def first_needs(state: PageState, kinds: Kinds | None) -> frozenset[str]:
    """Extras for the views that a browser shows first, of all cards or of a lesson.

    It has not told yet how many cards its window has room for.
    """
    groups: Iterable[Kinds] = (*LARGE_CARDS, *CARDS)
    if kinds is not None:
        groups = [(kind,) for kind in kinds]
    needs = set(Scene.needs)
    for group in groups:
        offered = [kind for kind in group if kind.applies(state.settings)]
        if offered:
            needs |= offered[on_top(offered, state)].needs
    return frozenset(needs)


def on_top(offered: Sequence[View] | Sequence[type[View]], state: PageState) -> int:
    """Index of the view, of those that a card offers, that the state names; or 0."""
    names = [view.name for view in offered]
    named = [names.index(name) for name in state.plots if name in names]
    return next(iter(named), 0)


def large_type(state: PageState) -> int:
    """Type size of plots, and of the text beside them, on a projector, px."""
    return round(LARGE * state.height)


def type_size(state: PageState) -> str:
    """Type size of plots in the present view, as CSS has it."""
    if state.view == "present":
        return f"{large_type(state)}px"
    return TEXT


def column(role: str, *parts: Any) -> pn.Column:
    """A column that style sheets know by its role."""
    return pn.Column(
        *parts,
        css_classes=[role],
        stylesheets=[STYLE],
        sizing_mode="stretch_width",
        margin=0,
    )
