"""Files of a user: settings, load paths and their points, and results of another program."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import panel as pn
import panel_material_ui as pmui
from bokeh.models import ColumnDataSource, PointDrawTool
from bokeh.plotting import figure

from app.refusals import message_of
from app.state import PageState, default_settings
from app.units import units_of_points
from app.views.colors import LATIN
from app.widgets import button, dialog, download
from solver.checked import dump
from solver.curves import curve_of
from solver.definitions import CurveParameter, SettingError, about
from solver.files import settings_from_toml
from solver.refusal import RefusedError
from solver.remarks import ends_of_tables
from solver.scenes import points_of
from solver.settings import Settings
from solver.study.comparison import OtherResults, read_results
from solver.tables import Table, read_table

TABLES = ".csv,.txt,.dat,.tsv"

HELP = (
    "Settings (.toml) that were saved here; or a table (.csv): of time and load, or of x, t and "
    "friction force or displacement, as another program found them, which is drawn beside the run."
)
MOST_DRAGGED = 200
"""Points up to which they are dragged and typed; longer tables come from files."""


def opened(source: str, data: bytes, settings: Settings) -> tuple[Settings | OtherResults, str]:
    """Read a file: settings (.toml), else results if it has places, else a load path.

    Returns
    -------
    What it was read as, and what was understood.

    Raises
    ------
    SettingError
        For what is none of these, or is refused.
    """
    if source.lower().endswith(".toml"):
        read = settings_from_toml(data.decode("utf-8-sig", "replace"), source=source)
        return read, f"{source}: settings of the scene {read.scene}."
    table = _table(data, source)
    if {"x", "position"} & {column.key for column in table.columns}:
        brought = read_results(data, source, settings)
        return brought, f"{source}: {brought.message}."
    return with_path(settings, _path_of(table, source, settings), table)


def with_path(settings: Settings, name: str, table: Table) -> tuple[Settings, str]:
    """Settings with a table for a path, and what was understood.

    A run then lasts until the last of its tables ends.
    """
    definition = settings.definitions()[name]
    curve = curve_of(table, definition, name, settings.curve_units(name))
    changed = settings.replace(**{name: curve.points})
    message = f"{about(definition).title}: {curve.message}."
    if definition.abscissa == "time":
        ends = max(ends_of_tables(changed).values(), default=0.0)
        changed = changed.replace(duration=ends) if ends > 0.0 else changed
        message += f" The run lasts {changed.duration:g} s."
    return changed, message


def _table(data: bytes | str, source: str) -> Table:
    def refuse(remedy: str) -> SettingError:
        return SettingError("the table", source, "a table of time and value", remedy)

    return read_table(data, refuse)


def _path_of(table: Table, source: str, settings: Settings) -> str:
    """The path over time that the head of a table names, or the only one, or that of the load."""
    paths = {
        name: definition
        for name, definition in settings.definitions().items()
        if isinstance(definition, CurveParameter)
        and definition.abscissa == "time"
        and settings.applies(name)
    }
    named = paths.keys() & {column.key for column in table.columns}
    loads = [name for name, definition in paths.items() if about(definition).group == "Load"]
    chosen = list(named or (paths if len(paths) == 1 else loads))
    if len(chosen) == 1:
        return chosen[0]
    if not paths:
        remedy = "have a side displaced or loaded first"
        raise SettingError("the table", source, "a load path, of which none applies", remedy)
    remedy = f"name the one in its first line, as in time,{next(iter(paths))}"
    raise SettingError("the table", source, f"a table of one of {', '.join(paths)}", remedy)


class FilesPanel:
    """Buttons that save settings and open files, and what was understood of these.

    `copy` has the browser copy the link to what is shown; it returns what it had to leave out.
    """

    def __init__(self, state: PageState, copy: Callable[[], str], width: int) -> None:
        self._state, self._copy = state, copy
        look: dict[str, Any] = {"width": width, "margin": (4, 0), "size": "small"}
        outlined = {**look, "variant": "outlined"}
        self.file = pmui.FileInput(
            label="Open settings or a table", accept=f".toml,{TABLES}", description=HELP, **outlined
        )
        self.file.param.watch(lambda event: self._open(), "value")
        self.message = pmui.Typography("", variant="body2", width=width, margin=0)
        self._remove = button("", self._forget, icon="close", **outlined)
        self.view = pn.Column(
            button("Copy link", self._copy_link, icon="link", **outlined),
            download(
                "Save settings (.toml)", "settings.toml", lambda: dump(state.settings), **look
            ),
            self.file,
            self.message,
            self._remove,
            button("All settings to default", self._reset, icon="restart_alt", **outlined),
            margin=0,
        )
        state.param.watch(lambda event: self._show(), "brought")
        self._show()

    def _copy_link(self) -> None:
        self.message.object = f"The link to what is shown is copied. {self._copy()}"

    def _reset(self) -> None:
        self._state.adopt(default_settings(self._state.settings.scene))

    def _open(self) -> None:
        state = self._state
        if not self.file.value:
            return
        try:
            content, self.message.object = opened(
                self.file.filename, self.file.value, state.settings
            )
        except RefusedError as refused:
            state.refusal = self.message.object = message_of(refused, state.settings)
            return
        if isinstance(content, OtherResults):
            state.brought = content
        else:
            state.adopt(content)

    def _forget(self) -> None:
        self.message.object = ""
        self._state.brought = None

    def _show(self) -> None:
        brought = self._state.brought
        self._remove.visible = brought is not None
        self._remove.label = f"Remove {brought.source}" if brought is not None else "Remove"


class CurveDialog:
    """A dialog that has the points of one path; what is done there holds at once.

    They are in their units in `source`, where they are dragged, and as a table in `text`.
    """

    def __init__(self, name: str, state: PageState) -> None:
        self._name, self._state = name, state
        definition = state.settings.definitions()[name]
        self._columns, is_path = definition.columns, definition.is_path
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
        self._file = pmui.FileInput(label="Open a table (.csv)", accept=TABLES)
        self._file.param.watch(lambda event: self._take(event.new, self._file.filename), "value")
        self._message = pn.pane.Markdown("", margin=(0, 5))
        self._figure = self._plot() if is_path else None
        plot = (
            pn.pane.Bokeh(self._figure, sizing_mode="stretch_width", height=220, margin=5),
            "Drag a point; tap to add one, tap it and press Backspace to take it away.",
        )
        self.view = dialog(
            f"{about(definition).title}: {'points' if is_path else 'rows'}",
            *(plot if is_path else ()),
            self.text,
            self._file,
            self._message,
            width_option="sm",
        )

    def update(self) -> None:
        """Show the points that hold, those of the preset where there are none yet."""
        settings = self._state.settings
        value = getattr(settings, self._name)
        points = points_of(settings, self._name) if isinstance(value, str) else value
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
        made = figure(height=220, tools="", toolbar_location=None, x_range=(0, 1), y_range=(0, 1))
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

    def _table(self, points: pd.DataFrame) -> str:
        columns = zip(self._columns, self._units, strict=True)
        heads = [f"{title} [{unit.name}]" if unit.name else title for title, unit in columns]
        return points.to_csv(header=heads, index=False, float_format="%.6g")

    def _on_drag(self) -> None:
        if not self._is_updating:
            points = pd.DataFrame(dict(self.source.data), dtype=float)
            points["x"] = points["x"].clip(lower=0.0)
            points = points.sort_values("x", kind="stable").drop_duplicates("x")
            self._take(self._table(points), "the plot")

    def _take(self, table: str | bytes, source: str) -> None:
        """Have a table be the path; one that is refused stays to be mended."""
        if self._is_updating or not table:
            return
        settings = self._state.settings
        try:
            changed, message = with_path(settings, self._name, _table(table, source))
        except RefusedError as refused:
            self._state.refusal = text = message_of(refused, settings, self._name)
            self.text.param.update(error_state=True, helper_text=text)
            return
        self._state.adopt(changed)
        self._message.object = message
        self.update()
