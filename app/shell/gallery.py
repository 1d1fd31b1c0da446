"""The plots of the run, each on a card under its name and legend; the browser makes them.

Their figures are the same on every page. A server that made them for each, as Panel does, would
spend half of what a page costs it on them.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Sequence
from functools import cache
from typing import Any

import param
from bokeh.document import Document

from app.components.form import item_of
from app.components.innards import Plain
from app.components.panes import looks, script
from app.languages.language import Language
from app.picture.glossary import ENGLISH
from app.picture.units import steps
from app.shell.layout import layout
from app.views.catalogue import VIEWS, beside
from app.views.drawing.drawing import View
from app.views.drawing.figures import make_figure
from app.worker.painter import PLOTS
from solver.scenes import behind
from solver.settings import Settings

NEEDED = "label", "start", "end", "step", "log", "whole"
"""Of a slider, for whoever drags its setting elsewhere."""


class Gallery(Plain):
    """The cards; messages from the browser are `{kind, value}`, what was chosen and where.

    Attributes
    ----------
    figures
        As JSON, for every view by its slug: Bokeh's document, its name, and what it chooses.
    shown
        Of every view that is seen, in order: slug, area of the grid, and names of the views that
        share its card, itself among them.
    grid
        The grid, and its rows beyond the window, as CSS has them; whether the first is a band.
    magnified
        How much larger the type of plots is than it usually is.
    sliders
        What the slider of every setting is that may be dragged in a picture, by its name.
    said
        Slug of every plot, and a sentence of what it shows; pictures bring it.
    keeps, recalls
        A scene and names of views that the browser is to keep for it; all that it has kept.
    bathtub
        Iterations over k, which stand in a corner of Convergence; pictures bring it.
    caption
        Which run and moment is seen; pictures bring it.
    """

    figures = param.String(default="{}")
    shown = param.List(default=[])
    grid = param.List(default=["none", "auto", False])
    sliders = param.Dict(default={})
    magnified = param.Number(default=1.0)
    said = param.List(default=[])
    keeps = param.List(default=[])
    recalls = param.Dict(default={})
    bathtub = param.List(default=[])
    caption = param.String(default="")

    _esm = script(
        *("say.js", "elements.js", "values.js"),
        *("shell/handles.js", "shell/bathtub.js", "shell/gallery.js"),
    )

    def offer(self, views: Sequence[View], settings: Settings, *, has_tabs: bool) -> None:
        """Show these views and no others, each with those that may stand in its place."""
        found, seen = layout(views, settings), set(views)
        shown = []
        for view, area in zip(views, found.areas, strict=True):
            tabs = [one for one in beside(view, settings) if one is view or one not in seen]
            shown.append([view.slug, area, [one.name for one in tabs] if has_tabs else []])
        grid = [found.template, found.row, found.is_long]
        self.param.update(shown=shown, grid=grid)

    def let_drag(self, settings: Settings, names: Collection[str], units: str) -> None:
        """Have what stands behind these settings dragged, as far as it is in the picture."""
        definitions = settings.definitions()
        items = [
            item_of(name, definitions[name]) or {}
            for name in behind(settings).values()
            if name in names
        ]
        self.sliders = {
            item["name"]: {key: item[key] for key in NEEDED}
            | {"steps": [list(one) for one in steps(item["unit"], units)]}
            for item in items
        }


def gallery(choices: dict[str, Callable[[Any], None]], say: Language = ENGLISH) -> Gallery:
    """Give plots, of which none is seen yet.

    Parameters
    ----------
    choices
        What a tap or a drag on a plot tells, by what it chooses: "instant" and "time" with a
        time, s, "substructure" with a number, "interface" with a name, "place" with a position,
        m, "drag" with what the slider of a setting tells, "tab" with the names of a view and of
        the one that is to stand in its place, and "bathtub" where more of that is asked for.
    say
        Says what stands in them.
    """
    made = Gallery(name=PLOTS, figures=figures(say), **{**looks("plots"), "margin": 0})
    made.on_msg(lambda message: choices[message.data["kind"]](message.data["value"]))
    return made


@cache
def figures(say: Language = ENGLISH) -> str:
    """Give the figures of all views as JSON, made once."""
    described = {view.slug: _described(view, say) for view in VIEWS}
    return json.dumps(described, separators=(",", ":"))


def _described(view: View, say: Language) -> dict[str, Any]:
    document = Document()
    document.add_root(make_figure(view, say))
    made = document.to_json(deferred=False)
    # Bokeh adds what every component of Panel's is made of, ten times as much as all figures, and
    # a title and options that a figure has no use for.
    return {
        "json": {"version": made["version"], "roots": made["roots"]},
        "name": view.name,
        "chooses": view.plot.chooses,
    }
