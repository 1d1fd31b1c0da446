"""The points of a path, as a plot to drag them in, as text, and from a file."""

from __future__ import annotations

from typing import Any

import numpy as np
import panel as pn
import panel_material_ui as pmui
from bokeh.models import ColumnDataSource, PointDrawTool
from bokeh.plotting import figure

from app.files import TABLES, with_points
from app.refusals import message_of
from app.state import PageState
from app.units import Unit, units_of_points
from app.views.colors import LATIN
from solver.definitions import CurveParameter, about
from solver.refusal import RefusedError
from solver.scenes import points_of

MOST_DRAGGED = 200
"""Points up to which they are dragged and typed; longer tables come from files."""


class CurveDialog:
    """A dialog that has the points of one path; what is done there holds at once.

    Parameters
    ----------
    name
        Of the setting, one of the present scene.
    state
        Is changed and shown.

    Attributes
    ----------
    view
        The dialog.
    source
        The points in their units, as they are dragged.
    text
        Field with the same as a table.
    """

    def __init__(self, name: str, state: PageState) -> None:
        self._name, self._state = name, state
        definition = state.settings.definitions()[name]
        assert isinstance(definition, CurveParameter)
        self._columns = definition.abscissa, definition.ordinate
        self._units = Unit(""), Unit("")
        self._is_updating = False
        self.source = ColumnDataSource({"x": [], "y": []})
        self.source.on_change("data", lambda attribute, old, new: self._on_drag())
        self.text = pmui.TextAreaInput(
            label="Points, or a table pasted here",
            rows=8,
            max_length=1_000_000,
            sizing_mode="stretch_width",
            margin=(10, 5),
        )
        self.text.param.watch(lambda event: self._take(event.new, "the text"), "value")
        self._file = pmui.FileInput(label="Open a table (.csv)", accept=TABLES)
        self._file.param.watch(lambda event: self._on_file(), "value")
        self._message = pn.pane.Markdown("", margin=(0, 5))
        self._figure = self._plot()
        self.view = pmui.Dialog(
            pn.pane.Bokeh(self._figure, sizing_mode="stretch_width", height=220, margin=5),
            "Drag a point; tap to add one, tap it and press Backspace to take it away.",
            self.text,
            self._file,
            self._message,
            title=f"{about(definition).title}: points",
            show_close_button=True,
            close_on_click=True,
            width_option="sm",
        )
        self.update()

    def open(self) -> None:
        """Show the points, those of the preset where there are none yet."""
        self.update()
        self.view.open = True

    def update(self) -> None:
        """Show the points that hold."""
        settings = self._state.settings
        value = getattr(settings, self._name)
        points = points_of(settings, self._name) if isinstance(value, str) else value
        units = settings.curve_units(self._name)
        self._units = units_of_points(settings.scene, self._name, units)
        x, y = np.array(points).T / np.array([[unit.factor] for unit in self._units])
        is_short = len(x) <= MOST_DRAGGED
        self._is_updating = True
        try:
            self.source.data = {"x": x, "y": y}
            self._points.visible = is_short
            self._figure.toolbar.active_tap = self._tool if is_short else None
            self._fit(x, y)
            self.text.param.update(
                value=self._table(x, y) if is_short else "",
                placeholder="" if is_short else f"{len(x)} points, of a file",
                error_state=False,
                helper_text="",
            )
        finally:
            self._is_updating = False

    def _plot(self) -> figure:
        made = figure(
            height=220,
            sizing_mode="stretch_width",
            tools="",
            toolbar_location=None,
            x_range=(0.0, 1.0),
            y_range=(0.0, 1.0),
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
        for axis, values in ((self._figure.x_range, x), (self._figure.y_range, [0.0, *y])):
            low, high = float(np.min(values)), float(np.max(values))
            room = (high - low or 1.0) * (0.05 if axis is self._figure.x_range else 0.2)
            axis.update(start=low - room, end=high + room)

    def _table(self, x: Any, y: Any) -> str:
        columns = zip(self._columns, self._units, strict=True)
        heads = [f"{title} [{unit.name}]" if unit.name else title for title, unit in columns]
        rows = [f"{a:.6g},{b:.6g}" for a, b in zip(x, y, strict=True)]
        return "\n".join([",".join(heads), *rows])

    def _on_drag(self) -> None:
        if self._is_updating:
            return
        x, y = (np.asarray(self.source.data[name], dtype=float) for name in ("x", "y"))
        order = np.argsort(x, kind="stable")
        x, y = np.maximum(x[order], 0.0), y[order]
        steps = np.concatenate([[True], np.diff(x) > 0.0])
        self._take(self._table(x[steps], y[steps]), "the plot")

    def _on_file(self) -> None:
        if self._file.value:
            self._take(self._file.value, self._file.filename or "the file")

    def _take(self, table: str | bytes, source: str) -> None:
        """Have a table be the path; one that is refused stays to be mended."""
        if self._is_updating or not table:
            return
        settings = self._state.settings
        try:
            changed, message = with_points(settings, self._name, table, source)
        except RefusedError as refused:
            text = message_of(refused, settings, self._name)
            self._state.refusal = text
            self.text.param.update(error_state=True, helper_text=text)
            return
        self._state.adopt(changed)
        self._message.object = message
        self.update()
