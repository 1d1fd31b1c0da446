"""The views that a page has, each on a card under its name and legend."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn

from app.figures import make_figure
from app.views.drawing import View
from app.views.legend import card_title


class Cards:
    """A card for every view, made when it is first shown.

    Parameters
    ----------
    style
        Style sheet.
    choices
        What a tap or a drag on a plot tells, by what it chooses: "instant" with a time, s, and
        "substructure" with a number.
    """

    def __init__(self, style: str, choices: dict[str, Callable[[float], None]]) -> None:
        self._style = style
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
        title = pn.pane.HTML(
            card_title(view.name, ()),
            tags=[f"{view.slug}.title"],
            css_classes=["title"],
            stylesheets=[self._style],
            sizing_mode="stretch_width",
            margin=(4, 6, 0, 12),
        )
        figure = make_figure(view, self._choices.get(view.plot.chooses, lambda height: None))
        return pn.Column(
            title,
            pn.pane.Bokeh(figure, sizing_mode="stretch_both", margin=(0, 4)),
            sizing_mode="stretch_both",
            css_classes=["card"],
            stylesheets=[self._style],
            margin=0,
        )
