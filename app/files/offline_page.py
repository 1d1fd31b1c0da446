"""A page of plots that is saved, and works without a server."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from bokeh.document import Document
from bokeh.embed import file_html
from bokeh.model import Model
from bokeh.models import (
    CustomJS,
    DataRange1d,
    Div,
    Slider,
)
from bokeh.resources import INLINE

from app.charts import library
from app.frame import Run
from app.state import PageState
from app.status import figures_line, status_line
from app.templates import TEMPLATES
from app.views.layout import shape_of
from app.views.pieces import PiecesView
from app.views.rope import WireSection
from app.views.scene import Scene
from app.views.type_size import TEXT, magnify
from app.views.view import View
from app.worker.cells import thinned
from solver.files.amounts import unit_for, unit_of
from solver.files.saved import dump
from solver.settings.definitions import Parameter, title_of
from solver.settings.scene import Settings

MOST_INSTANTS = 60
"""Largest number of instants on the page that is saved."""
WIDE = {"Scene": "scene", "Load path": "timeline"}
"""Names in the page that is saved of the views that are as wide as it."""
LOW = 90
HEIGHT = 300
"""Height of the time line and of plots there, px."""
NARROWEST = 340
WIDEST = 800
"""Widths between which a picture is scaled, px: on a phone it is as wide as the page.
It is laid out for the least, as its words are not scaled."""
HEIGHTS = {
    (False, False): 155.0,
    (False, True): 250.0,
    (True, False): 175.0,
    (True, True): 250.0,
}
"""Heights of pictures, px, by whether they are without loads, and whether the structure
is high."""
PIECES = 200.0
WIDE_PIECES = 400
"""Height of a plot of pieces without words and keys, and its largest width, px: a
broader one would stretch the pieces."""
APART = "span { margin-right: 14px; display: inline-block; }"
"""Style sheet of key figures."""
SHOW = """
const i = cb_obj.value
models.forEach((model, n) => { model[names[n]] = values[n][i] })
"""


def offline_page(state: PageState, views: Sequence[View]) -> str:
    """HTML of the shown run as a page that loads nothing.

    It has the views in sight, which are not changed, at all instants, the status, the
    key figures and all settings, light or dark as the page.
    """
    frame = state.frame
    run = frame.run
    copies = _copies(views, run)
    columns = thinned(len(run.instants), MOST_INSTANTS)
    selected = int(np.argmin(np.abs(columns - run.column(state.selection.phase))))
    slider = Slider(
        start=0,
        # A slider has two ends, also where there is one instant alone.
        end=max(len(columns) - 1, 1),
        visible=len(columns) > 1,
        value=selected,
        title="Instant",
        # The text below says which instant it is.
        show_value=False,
        sizing_mode="stretch_width",
    )
    instant = Div(text="", render_as_text=True, sizing_mode="stretch_width")
    figures = Div(text="", sizing_mode="stretch_width", stylesheets=[APART])
    page = _document(copies, slider=slider, instant=instant, figures=figures)

    def show(number: int) -> None:
        phase = float(run.instants[columns[number]] / run.instants[-1])
        selection = replace(state.selection, phase=phase)
        instant.text = _instant(run, columns[number])
        figures.text = figures_line(frame, selection)
        for view in copies:
            view.update(frame, selection, state.ghost)

    # What is the same at all instants, as a scale of colours, is set beforehand.
    show(selected)
    slider.js_on_change("value", _replay(page, len(columns), show))
    # The page begins with the selected instant.
    show(selected)
    return file_html(
        page,
        INLINE,
        f"Slipfront: {run.settings.scene}",
        template=TEMPLATES.get_template("files/export.html"),
        template_variables={
            "library": library("bokeh-widgets"),
            "is_dark": state.is_dark,
            "widest": WIDEST,
            "sentence": run.sentence,
            "status": status_line(state),
            "plots": {
                view.figure.name: view.name for view in copies if view.name not in WIDE
            },
            "settings": _settings_table(run.settings),
            "saved": dump(run.settings),
        },
        theme="dark_minimal" if state.is_dark else None,
        # Handlers of drags and taps do nothing there.
        suppress_callback_warning=True,
    )


def _instant(run: Run, column: int) -> str:
    """Text of the instant of a column of the run."""
    end = float(run.instants[-1])
    unit = unit_for(end, "s")
    return f"At {unit(float(run.instants[column]))} of {unit(end)}."


def _document(views: Sequence[View], **widgets: Model) -> Document:
    """A Bokeh document of figures and widgets, with names for the template."""
    page = Document()
    for name, widget in widgets.items():
        widget.name = name
        page.add_root(widget)
    for number, view in enumerate(views):
        view.figure.name = WIDE.get(view.name, f"plot-{number}")
        page.add_root(view.figure)
    return page


def _copies(views: Sequence[View], run: Run) -> list[View]:
    """Views of the same kinds with new figures, which do not react to the pointer."""
    # Models of a figure cannot stand in two documents.
    copies = [type(view)(view.state) for view in views]
    for view in copies:
        plot = view.figure
        plot.update(sizing_mode="stretch_width", height=HEIGHT)
        if view.name in WIDE:
            plot.height = LOW
        if isinstance(view, Scene):
            # Nobody tells the size of the figure there: the picture is scaled as one.
            height = HEIGHTS[view.is_bare, shape_of(run.geometry) == "high"]
            view.lay_out(NARROWEST, height)
            plot.update(
                sizing_mode="scale_width",
                aspect_ratio=NARROWEST / height,
                min_width=NARROWEST,
                max_width=WIDEST,
            )
        if isinstance(view, PiecesView):
            # Its words are not scaled either, and their lines are those of a phone.
            view.lay_out(NARROWEST, PIECES)
            plot.max_width = WIDE_PIECES
        if isinstance(view, WireSection):
            # Nobody tells its size either: there it stays in its place.
            ranges = {"x_range": DataRange1d(), "y_range": DataRange1d()}
            plot.update(match_aspect=True, **ranges)
        # Each theme has another type size. Words in a picture are smaller than they are
        # laid out: another machine may have no font but a wide one.
        magnify(plot, TEXT, TEXT)
    return copies


def _settings_table(settings: Settings) -> list[dict[str, str]]:
    """Rows (title, value with unit, name) of the settings that apply."""
    rows = []
    for name, definition in settings.definitions().items():
        if settings.applies(name):
            value = _written(getattr(settings, name), definition)
            rows.append({"title": title_of(definition), "value": value, "name": name})
    return rows


def _written(value: Any, definition: Parameter) -> str:
    """Text of a value of a setting."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float):
        return unit_of(definition)(value, digits=6)
    if isinstance(value, tuple):
        return f"{len(value)} points"
    return str(value)


def _replay(page: Document, count: int, show: Callable[[int], None]) -> CustomJS:
    """JavaScript that shows one of several pictures, from the values that differ."""
    changes: dict[tuple[Model, str], list[Any]] = {}
    page.on_change(lambda event: changes.setdefault((event.model, event.attr), []))
    # The first round finds the properties that change, the second one their values.
    for number in range(count):
        show(number)
    for number in range(count):
        show(number)
        for (model, name), values in changes.items():
            value = getattr(model, name)
            # Lists and mappings of a model refer to it, and continue to change.
            if isinstance(value, dict):
                value = dict(value)
            elif isinstance(value, list):
                value = list(value)
            values.append(value)
    models = []
    names = []
    kept = []
    for (model, name), values in changes.items():
        is_constant = len({pickle.dumps(value) for value in values}) <= 1
        if not is_constant:
            models.append(model)
            names.append(name)
            kept.append(values)
    arguments = {"models": models, "names": names, "values": kept}
    return CustomJS(args=arguments, code=SHOW)
