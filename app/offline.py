"""A run as one page that needs nothing beside it: its plots at all instants, and its numbers."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from html import escape
from typing import Any

import numpy as np
from bokeh.embed import file_html
from bokeh.layouts import column, grid
from bokeh.model import Model
from bokeh.models import (
    Column,
    ColumnDataSource,
    CustomJS,
    Div,
    PointDrawTool,
    Range1d,
    Renderer,
    SaveTool,
    Slider,
    Span,
)
from bokeh.models.annotations import TextAnnotation
from bokeh.resources import INLINE
from jinja2 import Template

from app.charts import library
from app.frame import Frame, Selection
from app.units import unit_for
from app.views.view import View
from app.worker.geometry import thinned
from solver.checked import dump

MOST_INSTANTS = 60
HEIGHTS = {"Scene": 260, "Load path": 70}
HEIGHT = 300
"""Pixels of a figure."""
MOVING: dict[type[Model], list[str]] = {
    ColumnDataSource: ["data"],
    Range1d: ["start", "end"],
    Span: ["location"],
    TextAnnotation: ["text"],
    Div: ["text"],
    Renderer: ["visible"],
}
"""What an instant may change in a figure."""
PAGE = """<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{{ title }}</title>
{{ library }}
<body>{% from macros import embed %}{{ embed(docs[0].roots[0]) }}{{ plot_script }}</body>
</html>
"""
"""As `file_html` takes it, whose own has what Panel would have a page load."""
SHOW = """
const i = cb_obj.value
models.forEach((model, n) => { model[names[n]] = values[n][i] })
"""
Values = dict[tuple[Model, str], Any]


def offline_page(
    frame: Frame,
    views: Sequence[View],
    selection: Selection,
    ghost: Frame | None,
    tables: Mapping[str, str],
    backend: str = "canvas",
) -> str:
    """The page (HTML), whose slider moves through the instants.

    Parameters
    ----------
    frame, ghost
        What is shown, and what it is compared with.
    views
        Those in sight; they are not touched.
    selection
        What is looked at.
    tables
        CSV by the name of its file.
    backend
        Of Bokeh's figures: "canvas" or "svg".
    """
    copies = _copies(views, backend)
    columns = thinned(len(frame.run.instants), MOST_INSTANTS).tolist()
    at = int(np.argmin(np.abs(np.array(columns) - frame.run.column(selection.phase))))
    caption = Div(text="", sizing_mode="stretch_width")
    models = {model for view in copies for model in view.figure.references()} | {caption}
    instants: list[Values] = []
    # The one that is looked at comes last, so that the page begins with it.
    for number in [*range(len(columns)), at]:
        phase = _phase(frame, columns[number])
        caption.text = f"{escape(frame.run.sentence)} {_words(frame, phase)}"
        for view in copies:
            view.update(frame, replace(selection, phase=phase), ghost)
        instants.append(_values(models))
    slider = _slider(instants[:-1], at)
    below = Div(text=_below(frame, tables), sizing_mode="stretch_width")
    page = _arranged(copies, slider, caption, below)
    return file_html(
        page,
        INLINE,
        f"Slipfront: {frame.run.settings.scene}",
        template=Template(PAGE),
        template_variables={"library": library("bokeh-widgets")},
        # What is dragged or tapped there does nothing.
        suppress_callback_warning=True,
    )


def _copies(views: Sequence[View], backend: str) -> list[View]:
    """Views of the same kinds, with figures of their own."""
    copies = [type(view)(view.state) for view in views]
    for view in copies:
        view.figure.output_backend = backend
        for tool in view.figure.select({"type": SaveTool}):
            tool.filename = view.name
    return copies


def _phase(frame: Frame, column: int) -> float:
    end = float(frame.run.instants[-1])
    return float(frame.run.instants[column]) / end if end else 0.0


def _words(frame: Frame, phase: float) -> str:
    end = float(frame.run.instants[-1])
    unit = unit_for(end, "s")
    return f"At {unit(phase * end)} of {unit(end)}."


def _slider(instants: Sequence[Values], at: int) -> Slider:
    """What moves through the instants, and begins with one of them."""
    last = len(instants) - 1
    slider = Slider(start=0, end=last, value=at, title="Instant", sizing_mode="stretch_width")
    moving = [key for key in instants[0] if _differs(key, instants)]
    arguments = {
        "models": [model for model, _ in moving],
        "names": [name for _, name in moving],
        "values": [[values[key] for values in instants] for key in moving],
    }
    slider.js_on_change("value", CustomJS(args=arguments, code=SHOW))
    return slider


def _arranged(views: Sequence[View], slider: Slider, caption: Div, below: Div) -> Column:
    """The scene and its load path over the whole width, and plots two in a row."""
    for view in views:
        made = view.figure
        made.sizing_mode, made.height = "stretch_width", HEIGHTS.get(view.name, HEIGHT)
        # What is dragged there moves nothing here.
        made.tools = [tool for tool in made.tools if not isinstance(tool, PointDrawTool)]
    wide = [view.figure for view in views if view.name in HEIGHTS]
    rest = [view.figure for view in views if view.name not in HEIGHTS]
    plots = grid(rest, ncols=2, sizing_mode="stretch_width")
    return column(slider, caption, *wide, plots, below, sizing_mode="stretch_width")


def _values(models: Iterable[Model]) -> Values:
    """All that an instant changes in them."""
    return {
        (model, name): dict(model.data) if name == "data" else getattr(model, name)
        for model in models
        for kind, names in MOVING.items()
        if isinstance(model, kind)
        for name in names
    }


def _differs(key: tuple[Model, str], instants: Sequence[Values]) -> bool:
    """Whether a value is not the same at all instants."""
    first = instants[0][key]
    others = [values[key] for values in instants[1:]]
    if not isinstance(first, dict):
        return any(value != first for value in others)
    return any(
        value.keys() != first.keys() or not all(_is_equal(value[n], first[n]) for n in first)
        for value in others
    )


def _is_equal(one: Any, other: Any) -> bool:
    if len(one) != len(other):
        return False
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return np.array_equal(one, other, equal_nan=one.dtype.kind == "f")
    return all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


def _below(frame: Frame, tables: Mapping[str, str]) -> str:
    """Numbers and settings (HTML)."""
    links = ", ".join(
        f'<a download="{escape(name)}" href="data:text/csv;base64,'
        f'{b64encode(text.encode()).decode()}">{escape(name)}</a>'
        for name, text in tables.items()
    )
    settings = escape(dump(frame.run.settings))
    below = f"<details><summary>All settings</summary><pre>{settings}</pre></details>"
    return f"<p>Numbers: {links}.</p>{below}"
