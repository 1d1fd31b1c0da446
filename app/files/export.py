"""Files that a person takes away from the page: tables, a program, a page of plots."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pprint import pformat
from textwrap import indent
from typing import Any

import numpy as np
import pandas as pd
import panel_material_ui as pmui
from bokeh.document import Document
from bokeh.embed import file_html
from bokeh.layouts import column, grid
from bokeh.model import Model
from bokeh.models import CustomJS, Div, PointDrawTool, SaveTool, Slider
from bokeh.resources import INLINE

from app.charts import library
from app.frame import Frame, Selection
from app.state import PageState
from app.units import unit_for
from app.views.view import View
from app.widgets import TEMPLATES, download, html
from app.worker.geometry import thinned
from app.worker.references import has_reference
from solver.files.saved import dump
from solver.settings.scene import Settings

LOOK: dict[str, Any] = {"size": "small", "width": 340, "margin": (4, 8)}
PROGRAM = """\
from solver.files import scene_settings
from solver.study.quantities.finished import finished_run

settings = scene_settings("{scene}").checked(
    {values}
)
solution = finished_run(settings, errors={errors}).solution
for record in solution.records:
    print(record.iteration, record.indicator, record.error_force)
print(solution.status.ending)
"""
MOST_INSTANTS = 60
"""Largest number of instants on the page that is saved."""
HEIGHTS = {"Scene": 260, "Load path": 70}
HEIGHT = 300
"""Heights of figures by the name of their view, and of all other figures, px."""
SHOW = """
const i = cb_obj.value
models.forEach((model, n) => { model[names[n]] = values[n][i] })
"""


def program(settings: Settings) -> str:
    """A Python program that repeats a run, with all its settings."""
    values = indent(pformat(settings.values(), sort_dicts=False), "    ").lstrip()
    return PROGRAM.format(
        scene=settings.scene, values=values, errors=has_reference(settings)
    )


def history_table(frame: Frame) -> str:
    """Scalars of every iteration of a run (CSV, with comments that begin with #)."""
    head = ["one line an iteration; seconds of run time"]
    return _csv(frame, head, pd.DataFrame(dict(frame.history)))


def plot_table(view: View, frame: Frame) -> str:
    """Points of a plot's curves, a line each (CSV, with comments that begin with #).

    Columns are those of the plot's sources, in the units of its axes; paths are
    numbered, and a curve has the name of its source.
    """
    axes = [*view.figure.xaxis[:1], *view.figure.yaxis[:1]]
    names = [f"{n}: {axis.axis_label}" for n, axis in zip("xy", axes, strict=False)]
    tables = []
    for key, source in view.sources.items():
        columns = {name: list(column) for name, column in source.data.items()}
        table = pd.DataFrame(columns)
        paths = [name for name, cells in columns.items() if any(map(np.ndim, cells))]
        # A cell of a path has all its points: they become rows.
        if paths:
            table[paths] = table[paths].map(np.ravel)
            table = table.explode(paths).rename_axis("path").reset_index()
        table.insert(0, "curve", key)
        tables.append(table)
    return _csv(frame, [view.name, *names], pd.concat(tables))


def _csv(frame: Frame, head: list[str], table: pd.DataFrame) -> str:
    settings = frame.run.settings
    at = f"iteration {frame.iteration}"
    if frame.is_answer:
        at = "answer"
    first = [
        f"Slipfront, {settings.scene}, {at}",
        *head,
        "settings:",
        *dump(settings).splitlines(),
    ]
    comments = "".join([f"# {line}\n" for line in first])
    return comments + table.to_csv(index=False)


def offline_page(
    frame: Frame, views: Sequence[View], selection: Selection, ghost: Frame | None
) -> str:
    """A run as a page that loads nothing (HTML), with its plots at all instants.

    Views and ghost are those in sight; they are not changed. The save buttons of the
    plots write SVG.
    """
    copies = _copies(views)
    instants = frame.run.instants
    end = float(instants[-1])
    columns = thinned(len(instants), MOST_INSTANTS)
    selected = int(np.argmin(np.abs(columns - frame.run.column(selection.phase))))
    slider = Slider(
        start=0,
        end=len(columns) - 1,
        value=selected,
        title="Instant",
        sizing_mode="stretch_width",
    )
    caption = Div(text="", render_as_text=True, sizing_mode="stretch_width")
    page = _document(slider, caption, copies, frame.run.settings)

    def show(number: int) -> None:
        time = float(instants[columns[number]])
        unit = unit_for(end, "s")
        caption.text = f"{frame.run.sentence} At {unit(time)} of {unit(end)}."
        phase = 0.0
        if end:
            phase = time / end
        for view in copies:
            view.update(frame, replace(selection, phase=phase), ghost)

    slider.js_on_change("value", _replay(page, len(columns), show))
    # The page begins with the selected instant.
    show(selected)
    return file_html(
        page,
        INLINE,
        f"Slipfront: {frame.run.settings.scene}",
        template=TEMPLATES.get_template("files/export.html"),
        template_variables={"library": library("bokeh-widgets")},
        # Handlers of drags and taps do nothing there.
        suppress_callback_warning=True,
    )


def _document(
    slider: Slider, caption: Div, views: Sequence[View], settings: Settings
) -> Document:
    """The page: wide figures, a grid of plots, and settings, one below the other."""
    wide = [view.figure for view in views if view.name in HEIGHTS]
    plots = [view.figure for view in views if view.name not in HEIGHTS]
    page = Document()
    page.add_root(
        column(
            slider,
            caption,
            *wide,
            grid(plots, ncols=2, sizing_mode="stretch_width"),
            Div(text=html("files/settings.html", settings=dump(settings))),
            sizing_mode="stretch_width",
        )
    )
    return page


def _copies(views: Sequence[View]) -> list[View]:
    """Views of the same kinds with new figures, in which nothing is dragged."""
    # Models of a figure cannot stand in two documents.
    copies = [type(view)(view.state) for view in views]
    for view in copies:
        plot = view.figure
        plot.output_backend = "svg"
        plot.sizing_mode = "stretch_width"
        plot.height = HEIGHTS.get(view.name, HEIGHT)
        plot.tools = [
            tool for tool in plot.tools if not isinstance(tool, PointDrawTool)
        ]
        for tool in plot.select({"type": SaveTool}):
            tool.filename = view.name
    return copies


def _replay(page: Document, count: int, show: Callable[[int], None]) -> CustomJS:
    """A script that shows one of several pictures, from the values that differ."""
    changes: dict[tuple[Model, str], list[Any]] = {}
    page.on_change(lambda event: changes.setdefault((event.model, event.attr), []))
    # The first round finds the properties that change, the second one their values.
    for number in range(count):
        show(number)
    for number in range(count):
        show(number)
        for (model, name), values in changes.items():
            value = getattr(model, name)
            if name == "data":
                value = dict(value)
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


def offers(state: PageState, views: Sequence[View]) -> list[Any]:
    """Buttons that save the run, and the data of the plots in sight."""
    frame = state.frame
    if frame is None:
        return [pmui.Typography("There is no run yet.")]
    page = partial(offline_page, frame, views, state.selection, state.ghost)
    files = {
        "The run as one page, plots as SVG (.html)": (".html", page),
        "The run as a program (.py)": (".py", partial(program, frame.run.settings)),
    }
    tables = {"All iterations": partial(history_table, frame)}
    tables |= {view.name: partial(plot_table, view, frame) for view in views}
    for title, make in tables.items():
        slug = title.lower().replace(" ", "-").replace("/", "-")
        files[f"{title} (.csv)"] = f"-{slug}.csv", make
    name = f"slipfront-{frame.run.settings.scene}"
    return [
        download(label, name + end, make, **LOOK)
        for label, (end, make) in files.items()
    ]
