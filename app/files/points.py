"""A dialog of the points of a path: dragged, typed, pasted, or from a table."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import panel as pn
import panel_material_ui as pmui
from bokeh.models import ColumnDataSource, PointDrawTool
from bokeh.plotting import figure

from app.files.tables import TABLES, table_of, with_path
from app.refusals import message_of
from app.state import PageState
from app.units import units_of_points
from app.views.colors import LATIN
from app.widgets import PlainText, dialog
from solver.refusal import RefusedError
from solver.settings.definitions import title_of

MOST_DRAGGED = 200
"""Points up to which they are dragged and typed; longer tables come from files."""


class CurveDialog:
    """A dialog of the points of a path; each change runs at once.

    They are in their units in `source`, where they are dragged, and as a table in
    `text`.
    """

    def __init__(self, name: str, state: PageState) -> None:
        self._name = name
        self._state = state
        definition = state.settings.definitions()[name]
        self._columns = definition.columns
        is_path = definition.is_path
        self._is_updating = False
        self.source = ColumnDataSource({"x": [], "y": []})
        self.source.on_change("data", lambda attribute, old, new: self._on_drag())
        self.text = pmui.TextAreaInput(
            label=f"{'Points' if is_path else 'Rows'}, or a table pasted here",
            rows=8,
            max_length=1_000_000,
            sizing_mode="stretch_width",
            margin=(10, 5),
        )
        self.text.param.watch(lambda event: self._take(event.new, "the text"), "value")
        self._file = pmui.FileInput(label="Open a table (.csv, .xlsx)", accept=TABLES)
        self._file.param.watch(
            lambda event: self._take(event.new, self._file.filename), "value"
        )
        self._message = PlainText(margin=(0, 5))
        if is_path:
            self._figure = self._plot()
        else:
            self._figure = None
        plot = (
            pn.pane.Bokeh(
                self._figure, sizing_mode="stretch_width", height=220, margin=5
            ),
            "Drag a point; tap to add one, tap it and press Backspace to take it away.",
        )
        self.view = dialog(
            f"{title_of(definition)}: {'points' if is_path else 'rows'}",
            *(plot if is_path else ()),
            self.text,
            self._file,
            self._message,
            width_option="sm",
        )

    def update(self) -> None:
        """Show the points of the path, or those of its preset."""
        settings = self._state.settings
        value = getattr(settings, self._name)
        if isinstance(value, str):
            points = settings.points(self._name)
        else:
            points = value
        units = settings.curve_units(self._name)
        self._units = units_of_points(settings.scene, self._name, units)
        table = pd.DataFrame(np.array(points) / [unit.factor for unit in self._units])
        is_short = len(table) <= MOST_DRAGGED
        self._is_updating = True
        if self._figure is not None:
            x, y = table.to_numpy().T
            self.source.data = {"x": x, "y": y}
            self._points.visible = is_short
            self._figure.toolbar.active_tap = self._tool if is_short else None
            self._fit(x, y)
        self.text.param.update(
            value=self._table(table) if is_short else "",
            placeholder="" if is_short else f"{len(table)} points, of a file",
            error_state=False,
            helper_text="",
        )
        self._is_updating = False

    def _plot(self) -> figure:
        made = figure(
            height=220, tools="", toolbar_location=None, x_range=(0, 1), y_range=(0, 1)
        )
        made.line("x", "y", source=self.source, color=LATIN, width=2)
        self._points = made.scatter("x", "y", source=self.source, color=LATIN, size=11)
        self._tool = PointDrawTool(renderers=[self._points])
        made.add_tools(self._tool)
        return made

    def _fit(self, x: Any, y: Any) -> None:
        """Leave room around the points, and title the axes."""
        titles = [u.titled(c) for c, u in zip(self._columns, self._units, strict=True)]
        self._figure.xaxis.axis_label, self._figure.yaxis.axis_label = titles
        for axis, values in (
            (self._figure.x_range, x),
            (self._figure.y_range, [0.0, *y]),
        ):
            low = float(np.min(values))
            high = float(np.max(values))
            room = (high - low or 1.0) * (0.05 if axis is self._figure.x_range else 0.2)
            axis.update(start=low - room, end=high + room)

    def _table(self, points: pd.DataFrame) -> str:
        columns = zip(self._columns, self._units, strict=True)
        heads = [
            f"{title} [{unit.name}]" if unit.name else title for title, unit in columns
        ]
        return points.to_csv(header=heads, index=False, float_format="%.6g")

    def _on_drag(self) -> None:
        if not self._is_updating:
            points = pd.DataFrame(dict(self.source.data), dtype=float)
            points["x"] = points["x"].clip(lower=0.0)
            points = points.sort_values("x", kind="stable").drop_duplicates("x")
            self._take(self._table(points), "the plot")

    def _take(self, table: str | bytes, source: str) -> None:
        """Use a table as the path; a refused one stays there to be mended."""
        if self._is_updating or not table:
            return
        settings = self._state.settings
        try:
            changed, message = with_path(settings, self._name, table_of(table, source))
        except RefusedError as refused:
            self._state.refusal = text = message_of(refused, settings, self._name)
            self.text.param.update(error_state=True, helper_text=text)
            return
        self._state.adopt(changed)
        self._message.object = message
        self.update()
