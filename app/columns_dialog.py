"""What a user opens a table with, and sees and chooses which of its columns is what."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any

import pandas as pd
import panel as pn
import panel_material_ui as pmui

from app.refusals import message_of
from app.state import PageState
from app.tables import Content, axes_on, opened, path_of, table_of, with_path
from app.units import sizes_of
from app.widgets import button, changing_text, dialog
from solver.columns import BY_UNIT, TableColumn, quantities_of, size_in
from solver.definitions import SettingError, about
from solver.refusal import RefusedError
from solver.settings import Settings
from solver.study.measured_loop import MeasuredLoop, columns_of, loop_in
from solver.tables import Table

HELP = (
    "Settings (.toml) that were saved here; or a table (.csv): of time and load; of displacement "
    "and force, a measured loop, which is drawn beside the run; or of x, t and friction force or "
    "displacement, as another program found them, which are drawn beside it, too."
)
LOOP, BOTH = "Measured loop", "both"
TIMES = ["s", "ms", "min", "h"]
NONE, ROW = "–", "row number"
SHOWN = 5
"""Lines of a table that are shown."""


class TableOpener:
    """A button that opens a file, what was understood of it, and a dialog of its columns."""

    def __init__(self, state: PageState, label: str, accept: str, width: int) -> None:
        self._state = state
        look: dict[str, Any] = {"margin": (4, 0), "size": "small", "width": width}
        outlined = {**look, "variant": "outlined"}
        self.file = pmui.FileInput(label=label, accept=accept, description=HELP, **outlined)
        self.file.param.watch(lambda event: self._open(), "value")
        self.message = changing_text(margin=0)
        self.dialog = ColumnsDialog(state, self._tell)
        self._columns = button(
            "Columns and units", self.dialog.show, icon="view_column", **outlined
        )
        self._columns.visible = False
        self._remove = button("", self._forget, icon="close", **outlined)
        buttons = pn.FlexBox(self.file, self._columns, self._remove, margin=0, gap="0 8px")
        self.view = pn.Column(buttons, self.message, self.dialog.view, margin=0)
        state.param.watch(lambda event: self._show(), "brought")
        self._show()

    def _open(self) -> None:
        if not self.file.value:
            return
        source, data, state = self.file.filename, self.file.value, self._state
        self._columns.visible = False
        try:
            if not source.lower().endswith(".toml"):
                self._columns.visible = self.dialog.load(table_of(data, source), source)
            content, self.message.object = opened(source, data, state.settings, axes_on(state))
        except RefusedError as refused:
            state.refusal = self.message.object = message_of(refused, state.settings)
            return
        take(state, content)
        if isinstance(content, MeasuredLoop):
            self.dialog.show()

    def _tell(self, message: str) -> None:
        self.message.object = message

    def _forget(self) -> None:
        self.message.object = ""
        self._state.brought = None

    def _show(self) -> None:
        brought = self._state.brought
        self._remove.visible = brought is not None
        self._remove.label = f"Remove {brought.source}" if brought is not None else "Remove"


def take(state: PageState, content: Content) -> None:
    """Have the page show what was brought, or take settings over."""
    if isinstance(content, Settings):
        state.adopt(content)
    else:
        state.brought = content


class ColumnsDialog:
    """A dialog of what a table is used as, and of the column and the unit of each quantity.

    What is chosen holds at once; `tell` is told what was understood.
    """

    def __init__(self, state: PageState, tell: Callable[[str], None]) -> None:
        self._state, self._tell = state, tell
        self._preview = pn.pane.DataFrame(None, index=False, margin=(0, 6), max_height=190)
        self._message = changing_text(margin=(6, 6))
        self.columns: list[pmui.Select] = []
        self.units: list[pmui.Select] = []
        self.view = dialog("Columns and units", width_option="sm")

    def load(self, table: Table, source: str) -> bool:
        """Have another table; whether there are columns to choose."""
        if any(column.quantities[0] & {"position"} for column in table.columns):
            return False
        self._given, self._table, self._source = table, numbered(table), source
        self._axes, settings = axes_on(self._state), self._state.settings
        names = names_of(table)
        cells = [cells + [""] * len(names) for _, cells in table.rows[:SHOWN]]
        self._preview.object = pd.DataFrame([row[: len(names)] for row in cells], columns=names)
        self._paths = settings.paths
        titles = {name: about(settings.definitions()[name]).title for name in self._paths}
        driven = [name for name in self._paths if self._axis_of(name) is not None]
        kinds = {LOOP: LOOP}
        kinds |= {f"{LOOP}, and {titles[name]}": f"{BOTH} {name}" for name in driven}
        kinds |= {title: name for name, title in titles.items()}
        used = LOOP
        try:
            columns_of(table, self._axes)
        except SettingError:
            with suppress(SettingError):
                used = path_of(table, settings)
        self.use = _select("Use it as", 460, options=kinds, value=used)
        self._fit()
        self.use.param.watch(lambda event: self._fit(), "value")
        self.use.param.watch(lambda event: self._take(), "value")
        return True

    def show(self) -> None:
        """Open it, for the scene as it is now."""
        if (axes_on(self._state), self._state.settings.paths) != (self._axes, self._paths):
            self.load(self._given, self._source)
        self._message.object = self._refused() or ""
        self.view.open = True

    def _axis_of(self, path: str) -> int | None:
        """Number of the axis of the loop that a path has, 0 for displacement; None for others."""
        unit = self._state.settings.curve_units(path)[1]
        units = [axis[1] for axis in self._axes]
        return units.index(unit) if unit in units else None

    @property
    def _roles(self) -> list[tuple[str, str, set[str]]]:
        """Title, unit and quantities of the columns that are wanted."""
        time = ("Time", "s", {"time"})
        if self.use.value in self._paths:
            definition = self._state.settings.definitions()[self.use.value]
            unit = self._state.settings.curve_units(self.use.value)[1].split(" or ")[0]
            kinds = {*quantities_of(definition.ordinate, unit)}
            return [time, (about(definition).title, unit, kinds)]
        return [time, *((title, unit, BY_UNIT[unit]) for title, unit in self._axes)]

    def _fit(self) -> None:
        """Show the fields that the use needs, with what the head says."""
        known = {name: place for place, name in enumerate(names_of(self._given))}
        free = list(self._table.columns[:-1])
        pairs = []
        for place, (title, si, kinds) in enumerate(self._roles):
            found, other = None, {}
            with suppress(SettingError):
                found = self._table.find(free, kinds, si)
            if place == 0:
                other = {NONE: -1} if self.use.value == LOOP else {}
                other |= {ROW: len(known)}
            elif found is None and free:
                found = free[0]
            if found in free:
                free.remove(found)
            value = found.place if found is not None else next(iter(other.values()), 0)
            column = _select(title, 220, options={**other, **known}, value=value)
            pairs.append((column, _select("in", 110, **self._units_of(value, si))))
            column.param.watch(partial(self._offer, place, si), "value")
        self.columns, self.units = map(list, zip(*pairs, strict=True))
        for field in (*self.columns, *self.units):
            field.param.watch(lambda event: self._take(), "value")
        rows = [pn.Row(*pair, margin=0) for pair in pairs]
        self.view[:] = [self._preview, self.use, *rows, self._message]

    def _offer(self, place: int, si: str, event: Any) -> None:
        """Offer the units of another column."""
        self.units[place].param.update(**self._units_of(event.new, si))

    def _units_of(self, place: int, si: str) -> dict[str, Any]:
        """Units of a quantity, and that of the head of a column."""
        units = TIMES if si == "s" else list(sizes_of(si))
        given = self._table.columns[place].unit if place >= 0 else ""
        size = size_in(given, si) if given else None
        same = [unit for unit in units if size is not None and size_in(unit, si) == size]
        value = same[0] if same else given if size is not None else si
        return {"options": units if value in units else [value, *units], "value": value}

    def _take(self) -> None:
        """Use the table as it is said."""
        self._message.object = self._refused(is_taken=True)

    def _refused(self, *, is_taken: bool = False) -> str:
        """What was understood, or why nothing was; on request it is taken."""
        settings = self._state.settings
        try:
            contents, message = self._read(settings)
        except RefusedError as refused:
            return message_of(refused, settings)
        for content in contents if is_taken else []:
            take(self._state, content)
        self._tell(f"{self._source}: {message}")
        return message

    def _read(self, settings: Settings) -> tuple[list[Content], str]:
        """What the table is, as it is used, and what was understood."""
        columns = self._table.columns
        time, *rest = (
            replace(columns[column.value], unit=unit.value) if column.value >= 0 else None
            for column, unit in zip(self.columns, self.units, strict=True)
        )
        use: str = self.use.value
        if use in self._paths:
            changed, message = with_path(settings, use, self._path_table(use, [time, rest[0]]))
            return [changed], message
        chosen = {column.place: column for column in (time, *rest) if column is not None}
        named = [chosen.get(column.place, column) for column in columns]
        named = [column for column in named if column.name != ROW or column in chosen.values()]
        table = replace(self._table, columns=named)
        loop = loop_in(table, (time, rest[0], rest[1]), self._source, self._axes)
        if use == LOOP:
            return [loop], f"{loop.message}."
        path = use.removeprefix(f"{BOTH} ")
        table = self._path_table(path, [time, rest[self._axis_of(path) or 0]])
        changed, message = with_path(settings, path, table)
        return [loop, changed], f"{loop.message}. {message}"

    def _path_table(self, name: str, columns: Sequence[TableColumn]) -> Table:
        """The table with the columns of a path alone, named as it wants them."""
        named = [replace(c, name=n) for c, n in zip(columns, ("time", name), strict=True)]
        return replace(self._table, columns=named)


def _select(label: str, width: int, **rest: Any) -> pmui.Select:
    return pmui.Select(label=label, width=width, size="small", margin=(6, 6), **rest)


def names_of(table: Table) -> list[str]:
    """Names of the columns, with their numbers where they have none, or others have the same."""
    names = [column.name for column in table.columns]
    return [
        name if name and names.count(name) == 1 else f"{name} ({place})".strip()
        for place, name in enumerate(names, start=1)
    ]


def numbered(table: Table) -> Table:
    """A table with the number of each row, from 0, as a last column, in seconds."""
    width = len(table.columns)
    rows = [
        (line, [*cells, *[""] * (width - len(cells)), str(number)])
        for number, (line, cells) in enumerate(table.rows)
    ]
    return replace(table, columns=[*table.columns, TableColumn(width, name=ROW)], rows=rows)
