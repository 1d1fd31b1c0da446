"""The views that a page has, each on a card under its name and legend."""

from __future__ import annotations

from collections.abc import Callable

import panel as pn

from app.figures import make_figure
from app.innards import NamedColumn
from app.panes import looks, text
from app.views.drawing import View
from app.views.legend import card_title


class Cards(dict[View, pn.Column]):
    """A card for every view, made when it is first asked for.

    Parameters
    ----------
    choices
        What a tap or a drag on a plot tells, by what it chooses: "instant" and "time" with a
        time, s, and "substructure" with a number.
    """

    def __init__(self, choices: dict[str, Callable[[float], None]]) -> None:
        self._choices = choices

    def __missing__(self, view: View) -> pn.Column:
        words, tags = card_title(view.name, ()), [f"{view.slug}.title"]
        title = text(words, role="title", tags=tags, margin=(4, 6, 0, 12))
        choose = self._choices.get(view.plot.chooses, lambda height: None)
        figure = make_figure(view, choose)
        plot = pn.pane.Bokeh(figure, sizing_mode="stretch_both", margin=(0, 4))
        options = {**looks("card"), "sizing_mode": "stretch_both", "margin": 0}
        self[view] = NamedColumn(title, plot, spoken=view.name, **options)
        return self[view]
