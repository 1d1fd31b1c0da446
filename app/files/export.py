"""Files that a user saves from the page: tables, a program, a page of plots."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pprint import pformat
from textwrap import indent
from typing import Any

import numpy as np
import pandas as pd
import panel_material_ui as pmui

from app.files.offline_page import offline_page
from app.frame import Frame
from app.state import PageState
from app.views.scene import Scene
from app.views.status_map import StatusMap
from app.views.timeline import Timeline, given_in
from app.views.view import View
from app.widgets import download, up_to
from app.worker.references import has_reference
from solver.laws import OPEN
from solver.settings.scene import Settings
from solver.study.comparison import PER

LOOK: dict[str, Any] = {"size": "small", "margin": (4, 8), **up_to(340)}
PROGRAM = """\
from solver.files import scene_settings
from solver.study.scene_run import finished_run

settings = scene_settings("{scene}").checked(
    {values}
)
solution = finished_run(settings, errors={errors}).solution
for record in solution.records:
    print(record.iteration, record.indicator, record.error_force)
print(solution.status.ending)
"""
LOOKS = "color", "line_color", "line_width", "text_align", "text_color"
"""Columns of plots that are no data."""
STATUSES = {-1: "slip backward", 0: "stick", 1: "slip forward", OPEN: "open"}
"""Words for the status of a point in tables."""


def program(settings: Settings) -> str:
    """A Python program that repeats a run, with all its settings."""
    values = indent(pformat(settings.values(), sort_dicts=False), "    ").lstrip()
    return PROGRAM.format(
        scene=settings.scene, values=values, errors=has_reference(settings)
    )


def history_table(frame: Frame) -> str:
    """CSV of the scalars of a run, one row per iteration, one line of heads."""
    table = pd.DataFrame(dict(frame.history)).rename(columns={"seconds": "seconds, s"})
    return table.astype({"iteration": int}).to_csv(index=False)


def path_table(frame: Frame) -> str:
    """CSV of all loads over time in units for readers, one line of heads."""
    description = frame.run.geometry.description
    table = pd.DataFrame({"t, s": description.instants})
    for symbol, values, unit in given_in(description):
        # Several loads of a script may have the same name.
        head = unit.titled(symbol)
        table.insert(
            len(table.columns), head, values / unit.factor, allow_duplicates=True
        )
    return table.to_csv(index=False)


def contact_table(frame: Frame) -> str:
    """CSV of contact at all points and instants of the interfaces of a frame.

    CSV with one line of heads, in SI: of several interfaces the name, position x, time
    t, friction on the body above, as on plots a traction or a force per length,
    pressure where it is found, slip, and status. It can be opened as the results of
    another program.
    """
    run = frame.run
    unit = PER[run.settings.kind]
    kind = "traction" if unit == "Pa" else "force"
    tables = []
    for name, fields in frame.contact.items():
        x, t = np.meshgrid(run.interfaces[name].positions, run.instants, indexing="ij")
        columns = {
            "x, m": x,
            "t, s": t,
            f"friction {kind}, {unit}": fields.friction,
            "pressure, Pa": fields.pressure,
            "slip, m": fields.slip,
        }
        table = pd.DataFrame(
            {
                head: field.ravel()
                for head, field in columns.items()
                if field is not None
            }
        )
        table["status"] = pd.Series(fields.status.ravel()).map(STATUSES)
        if len(run.interfaces) > 1:
            table.insert(0, "contact", name)
        tables.append(table)
    return pd.concat(tables).to_csv(index=False)


def plot_table(view: View) -> str:
    """CSV of the points of a plot's curves, one row per point, one line of heads.

    Columns are those of the plot's sources, in the units of its axes; paths are
    numbered, and a curve has the name of its source. Words and looks are left out.
    """
    tables = []
    for key, source in view.sources.items():
        if "text" in source.data:
            continue
        columns = {
            name: list(column)
            for name, column in source.data.items()
            if name not in LOOKS
        }
        table = pd.DataFrame(columns)
        paths = [name for name, cells in columns.items() if any(map(np.ndim, cells))]
        # A cell of a path has all its points: they become rows.
        if paths:
            table[paths] = table[paths].map(np.ravel)
            table = table.explode(paths).rename_axis("path").reset_index()
        table.insert(0, "curve", key)
        tables.append(table)
    heads = {}
    # The title of the figure is that of its x axis.
    if view.figure.title is not None and view.figure.title.text:
        heads["x"] = view.figure.title.text
    for axis in view.figure.yaxis[:1]:
        heads["y"] = (axis.axis_label or "y").replace("\n", " ")
    table = pd.concat(tables).infer_objects()
    # Frames have no more digits: 0.1 would be 0.10000000149.
    floats = table.select_dtypes("float").columns
    table = table.astype(dict.fromkeys(floats, "float32"))
    return table.rename(columns=heads).to_csv(index=False)


def offers(state: PageState, views: Sequence[View]) -> list[Any]:
    """Buttons that save the run, and the data of the visible plots."""
    frame = state.frame
    if frame is None:
        return [pmui.Typography("There is no run yet.")]
    page = partial(offline_page, state, views)
    files = {
        "The run as one page (.html)": (".html", page),
        "The run as a program (.py)": (
            ".py",
            lambda: program(state.frame.run.settings),
        ),
    }
    tables = {
        "All iterations": lambda: history_table(state.frame),
        "Contact over x and t": lambda: contact_table(state.frame),
        "Loads over t": lambda: path_table(state.frame),
    }
    # A picture of bodies has no curves, loads are drawn over their largest values, and
    # the status stands in the table of the contact.
    pictures = Scene | Timeline | StatusMap
    plots = [view for view in views if not isinstance(view, pictures)]
    tables |= {view.name: partial(plot_table, view) for view in plots}
    for title, make in tables.items():
        slug = title.lower().replace(" ", "-").replace("/", "-")
        files[f"{title} (.csv)"] = f"-{slug}.csv", make
    name = f"slipfront-{frame.run.settings.scene}"
    return [
        download(label, name + end, make, **LOOK)
        for label, (end, make) in files.items()
    ]
