"""What one takes away from the page: tables, pictures, a program, a page."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from html import escape
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
from jinja2 import Template

from app.charts import library
from app.frame import Frame, Selection
from app.state import PageState
from app.units import unit_for
from app.views.view import View
from app.widgets import download
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
HEIGHTS = {"Scene": 260, "Load path": 70}
HEIGHT = 300
"""Pixels of a figure."""
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


def program(settings: Settings) -> str:
    """A Python program that gives the numbers of a run again, with all its settings."""
    values = indent(pformat(settings.values(), sort_dicts=False), "    ").lstrip()
    return PROGRAM.format(
        scene=settings.scene, values=values, errors=has_reference(settings)
    )


def history_table(frame: Frame) -> str:
    """Scalars of every iteration of a run (CSV, with comments that begin with #)."""
    head = ["one line an iteration; seconds of run time"]
    return _csv(frame, head, pd.DataFrame(dict(frame.history)))


def plot_table(view: View, frame: Frame) -> str:
    """What a plot shows (CSV, with comments that begin with #): a line for each point of a curve.

    Columns are those of the plot's sources, in the units of its axes; paths are
    numbered, and a curve has the name of its source.
    """
    axes = [*view.figure.xaxis[:1], *view.figure.yaxis[:1]]
    names = [f"{n}: {axis.axis_label}" for n, axis in zip("xy", axes, strict=False)]
    tables = []
    for key, source in view.sources.items():
        table = pd.DataFrame(
            {name: list(column) for name, column in source.data.items()}
        )
        paths = [name for name in table if any(np.ndim(cell) for cell in table[name])]
        if paths:
            table[paths] = table[paths].map(np.ravel)
            table = table.explode(paths).rename_axis("path").reset_index()
        table.insert(0, "curve", key)
        tables.append(table)
    return _csv(frame, [view.name, *names], pd.concat(tables))


def _csv(frame: Frame, head: list[str], table: pd.DataFrame) -> str:
    settings = frame.run.settings
    if frame.is_answer:
        at = "answer"
    else:
        at = f"iteration {frame.iteration}"
    first = [
        f"Slipfront, {settings.scene}, {at}",
        *head,
        "settings:",
        *dump(settings).splitlines(),
    ]
    return "".join(f"# {line}\n" for line in first) + table.to_csv(index=False)


def offline_page(
    frame: Frame, views: Sequence[View], selection: Selection, ghost: Frame | None
) -> str:
    """A run as one page that needs nothing beside it (HTML): its plots at all instants.

    Views and ghost are those in sight, which are not touched. The save buttons of the
    plots write SVG.
    """
    copies = _copies(views)
    settings = escape(dump(frame.run.settings))
    instants = frame.run.instants
    end = float(frame.run.instants[-1])
    columns = thinned(len(instants), MOST_INSTANTS)
    at = int(np.argmin(np.abs(columns - frame.run.column(selection.phase))))
    slider = Slider(
        start=0,
        end=len(columns) - 1,
        value=at,
        title="Instant",
        sizing_mode="stretch_width",
    )
    caption = Div(text="", sizing_mode="stretch_width")
    rest = [view.figure for view in copies if view.name not in HEIGHTS]
    page = Document()
    page.add_root(
        column(
            slider,
            caption,
            *(view.figure for view in copies if view.name in HEIGHTS),
            grid(rest, ncols=2, sizing_mode="stretch_width"),
            Div(
                text=f"<details><summary>All settings</summary><pre>{settings}</pre></details>"
            ),
            sizing_mode="stretch_width",
        )
    )

    def show(place: int) -> None:
        time = float(instants[columns[place]])
        unit = unit_for(end, "s")
        caption.text = f"{escape(frame.run.sentence)} At {unit(time)} of {unit(end)}."
        for view in copies:
            view.update(
                frame, replace(selection, phase=time / end if end else 0.0), ghost
            )

    slider.js_on_change("value", _replay(page, len(columns), show))
    # The page begins with the one that is looked at.
    show(at)
    return file_html(
        page,
        INLINE,
        f"Slipfront: {frame.run.settings.scene}",
        template=Template(PAGE),
        template_variables={"library": library("bokeh-widgets")},
        # What is dragged or tapped there does nothing.
        suppress_callback_warning=True,
    )


def _copies(views: Sequence[View]) -> list[View]:
    """Views of the same kinds, with figures of their own, in which nothing is dragged."""
    copies = [type(view)(view.state) for view in views]
    for view in copies:
        made = view.figure
        made.output_backend = "svg"
        made.sizing_mode = "stretch_width"
        made.height = HEIGHTS.get(view.name, HEIGHT)
        made.tools = [
            tool for tool in made.tools if not isinstance(tool, PointDrawTool)
        ]
        for tool in made.select({"type": SaveTool}):
            tool.filename = view.name
    return copies


def _replay(page: Document, count: int, show: Callable[[int], None]) -> CustomJS:
    """What shows one of so many pictures, with the values of all that differs between them."""
    changes: dict[tuple[Model, str], list[Any]] = {}
    page.on_change(lambda event: changes.setdefault((event.model, event.attr), []))
    # At first it is found out what changes at all.
    for place in range(count):
        show(place)
    for place in range(count):
        show(place)
        for (model, name), values in changes.items():
            value = getattr(model, name)
            values.append(dict(value) if name == "data" else value)
    changes = {
        key: v for key, v in changes.items() if len(set(map(pickle.dumps, v))) > 1
    }
    models, names = ([key[i] for key in changes] for i in (0, 1))
    moved = {"models": models, "names": names, "values": list(changes.values())}
    return CustomJS(args=moved, code=SHOW)


def offers(state: PageState, views: Sequence[View]) -> list[Any]:
    """Buttons that save what there is of what is seen: the run, and what the views show."""
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
