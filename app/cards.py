"""The views that a page has, each on a card under its name and legend."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn

from app.figures import make_figure
from app.panes import column, text
from app.views.drawing import View
from app.views.legend import card_title


class Cards:
    """A card for every view, made when it is first shown.

    Parameters
    ----------
    choices
        What a tap or a drag on a plot tells, by what it chooses: "instant" with a time, s, and
        "substructure" with a number.
    """

    def __init__(self, choices: dict[str, Callable[[float], None]]) -> None:
        self._choices = choices
        self._cards: dict[str, Any] = {}

    def has(self, view: View) -> bool:
        """Tell whether a view's card is made."""
        return view.name in self._cards

    def of(self, view: View) -> Any:
        """Give a view's card."""
        if view.name not in self._cards:
            self._cards[view.name] = self._make(view)
        return self._cards[view.name]

    def _make(self, view: View) -> Any:
        words, tags = card_title(view.name, ()), [f"{view.slug}.title"]
        title = text(words, role="title", tags=tags, margin=(4, 6, 0, 12))
        figure = make_figure(view, self._choices.get(view.plot.chooses, lambda height: None))
        plot = pn.pane.Bokeh(figure, sizing_mode="stretch_both", margin=(0, 4))
        return column(title, plot, role="card", sizing_mode="stretch_both")
