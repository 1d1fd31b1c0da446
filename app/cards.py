"""A card holds one view, and others as tabs, which take its place."""

from __future__ import annotations

from collections.abc import Callable

import panel as pn
import panel_material_ui as pmui

from app.state import PageState
from app.views.view import View

TABS = {
    "&.MuiTabs-root, & .MuiTabs-root": {"minHeight": "26px"},
    "& .MuiTab-root": {
        "minHeight": "26px",
        "minWidth": 0,
        "padding": "2px 10px",
        "textTransform": "none",
        "fontSize": "13px",
    },
    "& .MuiTabs-scrollButtons": {"width": "20px"},
}


class Card:
    """The views of one card, of which one is in sight.

    Parameters
    ----------
    kinds
        The views that share the card.
    state
        Of the page.
    changed
        Called when another view comes in sight.

    Attributes
    ----------
    view
        What stands on the page.
    views
        All views that share it.
    """

    def __init__(
        self, kinds: tuple[type[View], ...], state: PageState, changed: Callable[[], None]
    ) -> None:
        self.views = [kind(state) for kind in kinds]
        self._fitting: list[View] = []
        self._chosen: View | None = None
        self._is_fitting = False
        self._state, self._changed = state, changed
        self._panes: dict[View, pn.pane.Bokeh] = {}
        self.tabs = pmui.TabMenu(items=[], margin=0, sx=TABS, sizing_mode="stretch_width")
        self.tabs.param.watch(lambda event: self._choose(), "active")
        self.view = pn.Column(self.tabs, sizing_mode="stretch_both", min_height=170, margin=0)

    @property
    def seen(self) -> View | None:
        """The view in sight."""
        return self._fitting[self.tabs.active or 0] if self._fitting else None

    def fit(self, state: PageState) -> None:
        """Offer the views that say anything about the present settings.

        The one that was chosen last is in sight, wherever it is offered.
        """
        named = [view for view in self.views if view.name in state.plots.split(",")]
        self._chosen = named[0] if named else self._chosen
        fitting = [view for view in self.views if view.applies(state.settings)]
        if fitting == self._fitting and (not named or self.seen in named):
            return
        self._is_fitting = True
        self._fitting = fitting
        self.view.visible = bool(fitting)
        active = fitting.index(self._chosen) if self._chosen in fitting else 0
        self.tabs.param.update(items=[view.name for view in fitting], active=active)
        self._is_fitting = False
        self._turn()

    def _choose(self) -> None:
        if not self._is_fitting:
            self._chosen = self.seen
            self._turn()
            mine = {view.name for view in self.views}
            others = [name for name in self._state.plots.split(",") if name and name not in mine]
            own = [] if self._chosen is self._fitting[0] else [self._chosen.name]
            self._state.plots = ",".join([*others, *own])

    def _turn(self) -> None:
        """Make the figure of the view in sight, where it was not seen yet, and show the frame."""
        view, state = self.seen, self._state
        if view is not None:
            if view not in self._panes:
                pane = pn.pane.Bokeh(view.figure, sizing_mode="stretch_both", margin=0)
                self._panes[view] = pane
            if state.frame is not None:
                view.update(state.frame, state.selection, state.ghost)
            if list(self.view) != [self.tabs, self._panes[view]]:
                self.view[:] = [self.tabs, self._panes[view]]
        self._changed()
