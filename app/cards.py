"""A card holds one view, and others as tabs, which take its place."""

from __future__ import annotations

from collections.abc import Callable

import panel as pn
import panel_material_ui as pmui

from app.state import PageState
from app.views.view import View

TABS = {
    "& .MuiTabs-root": {"minHeight": "26px"},
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
    """

    def __init__(
        self, kinds: tuple[type[View], ...], state: PageState, changed: Callable[[], None]
    ) -> None:
        self._all = [kind(state) for kind in kinds]
        self._fitting: list[View] = []
        self._chosen: View | None = None
        self._is_fitting = False
        self._state, self._changed = state, changed
        self.view = pmui.Tabs(
            dynamic=True, sizing_mode="stretch_both", min_height=170, margin=0, sx=TABS
        )
        self.view.param.watch(lambda event: self._choose(), "active")

    @property
    def seen(self) -> View | None:
        """The view in sight."""
        return self._fitting[self.view.active] if self._fitting else None

    def fit(self, state: PageState) -> None:
        """Offer the views that say anything about the present settings.

        The one that was chosen last is in sight, wherever it is offered.
        """
        fitting = [view for view in self._all if view.applies(state.settings)]
        if fitting == self._fitting:
            return
        self._is_fitting = True
        self._fitting = fitting
        self.view.visible = bool(fitting)
        self.view.active = 0
        panes = (pn.Column(sizing_mode="stretch_both", margin=0) for _ in fitting)
        self.view[:] = [(view.name, pane) for view, pane in zip(fitting, panes, strict=True)]
        self.view.active = fitting.index(self._chosen) if self._chosen in fitting else 0
        self._is_fitting = False
        self._turn()

    def _choose(self) -> None:
        if not self._is_fitting:
            self._chosen = self.seen
            self._turn()

    def _turn(self) -> None:
        """Make the figure of the view in sight, where it was not seen yet, and show the frame."""
        view, state = self.seen, self._state
        if view is not None and not self.view[self.view.active].objects:
            pane = pn.pane.Bokeh(view.figure, sizing_mode="stretch_both", margin=0)
            if state.frame is not None:
                view.update(state.frame, state.selection, state.ghost)
            self.view[self.view.active].append(pane)
        self._changed()
