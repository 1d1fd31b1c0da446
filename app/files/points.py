"""A dialog for the points of a path: dragged, typed, pasted, or from a table."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import panel as pn
import panel_material_ui as pmui
from bokeh.models import ColumnDataSource, PointDrawTool, Range1d
from bokeh.plotting import figure

from app.files.tables import TABLES, table_of, with_path
from app.refusals import message_of
from app.state import PageState
from app.units import units_of_points
from app.views.colors import LATIN
from app.widgets import PlainText, dialog, file_button
from solver.arrays import Array
from solver.refusal import RefusedError
from solver.settings.definitions import title_of

MOST_DRAGGED = 200
"""Largest number of points that are dragged and typed; longer tables are of files."""
LOOK: dict[str, Any] = {"sizing_mode": "stretch_width", "height": 220, "margin": 5}
HINT = (
    "Drag a point; tap to add one, tap it and press Backspace to take it away, or edit "
    "the rows."
)
MARGINS = {"x": 0.05, "y": 0.2}
"""Room on either side of the points, over their range along each axis."""


class CurveDialog:
    """A dialog for the points of a path; each change starts a run.

    The points are in the units of their columns: in `source`, where they are dragged,
    and as a table in `text`.
    """

    def __init__(self, name: str, state: PageState) -> None:
        self._name = name
        self._state = state
        definition = state.settings.definitions()[name]
        self._columns = definition.columns
        self._is_updating = False
        self.source = ColumnDataSource({"x": [], "y": []})
        self.source.on_change("data", lambda attribute, old, new: self._on_drag())
        # A path is also drawn. The rows of other tables are only typed.
        self._figure: figure | None = None
        plot: list[Any] = []
        rows = "Rows"
        if definition.is_path:
            rows = "Points"
            self._figure = self._plot()
            plot = [pn.pane.Bokeh(self._figure, **LOOK), HINT]
        self.text = pmui.TextAreaInput(
            label=f"{rows}, or a table pasted here",
            rows=8,
            max_length=1_000_000,
            sizing_mode="stretch_width",
            margin=(10, 5),
        )
        self.text.param.watch(lambda event: self._take(event.new, "the text"), "value")
        self.file = file_button("Open a table (.csv, .xlsx)", TABLES, self._take)
        self._message = PlainText(margin=(0, 5))
        self.view = dialog(
            f"{title_of(definition)}: {rows.lower()}",
            *plot,
            self.text,
            self.file,
            self._message,
            width_option="sm",
        )

    def update(self) -> None:
        """Show the points of the path, or those of its preset."""
        settings = self._state.settings
        points = settings.points(self._name)
        units = settings.curve_units(self._name)
        self._units = units_of_points(settings.scene, self._name, units)
        table = pd.DataFrame(np.array(points) / [unit.factor for unit in self._units])
        if isinstance(getattr(settings, self._name), str):
            # Those of a preset may have any number of digits.
            table = _rounded(table)
        is_short = len(table) <= MOST_DRAGGED
        self._is_updating = True
        if self._figure is not None:
            x, y = table.to_numpy().T
            self._known = {"x": x, "y": y}
            self.source.data = dict(self._known)
            self._points.visible = is_short
            # A tool that is not active leaves the points where they are.
            self._figure.toolbar.active_tap = self._tool if is_short else None
            self._fit(x, y)
        text = ""
        hint = f"{len(table)} points, of a file"
        if is_short:
            text = self._table(table)
            hint = ""
        self.text.param.update(
            value=text, placeholder=hint, error_state=False, helper_text=""
        )
        self._is_updating = False

    def _plot(self) -> figure:
        """Make the figure for dragging points."""
        plot = figure(
            height=220, tools="", toolbar_location=None, x_range=(0, 1), y_range=(0, 1)
        )
        plot.line("x", "y", source=self.source, color=LATIN, width=2)
        self._points = plot.scatter("x", "y", source=self.source, color=LATIN, size=11)
        self._tool = PointDrawTool(renderers=[self._points])
        plot.add_tools(self._tool)
        return plot

    def _fit(self, x: Array, y: Array) -> None:
        """Set limits around points, (n,) each, in their units, and titles of axes."""
        plot = self._figure
        titles = []
        for column, unit in zip(self._columns, self._units, strict=True):
            titles.append(unit.titled(column))
        plot.xaxis.axis_label, plot.yaxis.axis_label = titles
        _widen(plot.x_range, x, MARGINS["x"])
        # A load is read from zero.
        _widen(plot.y_range, np.append(y, 0.0), MARGINS["y"])

    def _table(self, points: pd.DataFrame) -> str:
        """CSV of the points, with units in the head."""
        heads = []
        for title, unit in zip(self._columns, self._units, strict=True):
            if unit.name:
                title += f" [{unit.name}]"
            heads.append(title)
        return points.to_csv(header=heads, index=False, float_format="%.10g")

    def _on_drag(self) -> None:
        if not self._is_updating:
            points = pd.DataFrame(dict(self.source.data), dtype=float)
            points["x"] = points["x"].clip(lower=0.0)
            # What was not dragged keeps its digits.
            is_known = points.isin(self._known)
            points = points.where(is_known, _rounded(points))
            points = points.sort_values("x", kind="stable").drop_duplicates("x")
            self._take(self._table(points), "the plot")

    def _take(self, table: str | bytes, source: str) -> None:
        """Use a table as the path; a refused table stays in the field."""
        if self._is_updating or table == "":
            return
        settings = self._state.settings
        try:
            changed, message = with_path(settings, self._name, table_of(table, source))
        except RefusedError as refused:
            self._state.refusal = text = message_of(refused, settings, self._name)
            self.text.param.update(error_state=True, helper_text=text)
            # What was said of a table before is no longer so.
            self._message.object = ""
            return
        self._state.adopt(changed)
        self._message.object = message
        self.update()


def _rounded(points: pd.DataFrame) -> pd.DataFrame:
    """Points with six digits, in their units."""
    return points.map(lambda value: float(f"{value:.6g}"))


def _widen(axis: Range1d, values: Array, margin: float) -> None:
    """Set the limits of an axis around values, (n,), with a relative margin."""
    low = float(np.min(values))
    high = float(np.max(values))
    room = (high - low or 1.0) * margin
    axis.update(start=low - room, end=high + room)
