"""What a user opens a table with, and sees and chooses which of its columns is what."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import pandas as pd
import panel as pn
import panel_material_ui as pmui

from app.refusals import message_of
from app.state import PageState
from app.tables import Content, axes_on, opened, path_of, paths_of, table_of, with_path
from app.units import sizes_of
from app.widgets import button, changing_text, dialog
from solver.columns import TableColumn, size_in
from solver.definitions import SettingError, about
from solver.refusal import RefusedError
from solver.settings import Settings
from solver.study.measured_loop import KINDS, MeasuredLoop, columns_of, loop_in
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
        self._state, self._tell, self._is_updating = state, tell, False
        look: dict[str, Any] = {"size": "small", "margin": (6, 6)}
        self._preview = pn.pane.DataFrame(None, index=False, margin=(0, 6), max_height=190)
        self.use = pmui.Select(label="Use it as", width=460, **look)
        self.columns = [pmui.Select(width=220, **look) for _ in range(3)]
        self.units = [pmui.Select(label="in", width=110, **look) for _ in range(3)]
        self._rows = [
            pn.Row(*pair, margin=0) for pair in zip(self.columns, self.units, strict=True)
        ]
        self._message = changing_text(margin=(6, 6))
        fields = self._preview, self.use, *self._rows, self._message
        self.view = dialog("Columns and units", *fields, width_option="sm")
        self.use.param.watch(lambda event: self._on_use(), "value")
        for field in (*self.columns, *self.units):
            field.param.watch(lambda event: self._on_field(event.obj), "value")

    def load(self, table: Table, source: str) -> bool:
        """Have another table; whether there are columns to choose."""
        if any(column.quantities[0] & {"position"} for column in table.columns):
            return False
        self._given, self._table, self._source = table, numbered(table), source
        self._axes, settings = axes_on(self._state), self._state.settings
        names = names_of(table)
        cells = [cells + [""] * len(names) for _, cells in table.rows[:SHOWN]]
        self._preview.object = pd.DataFrame([row[: len(names)] for row in cells], columns=names)
        self._paths = paths_of(settings)
        titles = {name: about(definition).title for name, definition in self._paths.items()}
        driven = [name for name in self._paths if self._axis_of(name) is not None]
        kinds = {LOOP: LOOP}
        kinds |= {f"{LOOP}, and {titles[name]}": f"{BOTH} {name}" for name in driven}
        kinds |= {title: name for name, title in titles.items()}
        try:
            columns_of(table, self._axes)
            used = LOOP
        except SettingError:
            used = self._guessed_path(table, settings)
        self._is_updating = True
        self.use.param.update(options=kinds, value=used)
        self._fit()
        self._is_updating = False
        return True

    def _guessed_path(self, table: Table, settings: Settings) -> str:
        with suppress(SettingError):
            return path_of(table, settings)
        return LOOP

    def show(self) -> None:
        """Open it, for the scene as it is now."""
        now = axes_on(self._state), paths_of(self._state.settings).keys()
        if now != (self._axes, self._paths.keys()):
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
            definition = self._paths[self.use.value]
            unit = self._state.settings.curve_units(self.use.value)[1].split(" or ")[0]
            kinds = TableColumn(0, name=definition.ordinate).quantities[0] | KINDS.get(unit, set())
            return [time, (about(definition).title, unit, set(kinds))]
        return [time, *((title, unit, KINDS[unit]) for title, unit in self._axes)]

    def _fit(self) -> None:
        """Have the fields that the use needs, with what the head says."""
        columns, roles = self._table.columns, self._roles
        known = {name: place for place, name in enumerate(names_of(self._given))}
        row, free = len(known), list(columns[:-1])
        for place, (column, unit) in enumerate(zip(self.columns, self.units, strict=True)):
            self._rows[place].visible = place < len(roles)
            if place >= len(roles):
                continue
            title, si, kinds = roles[place]
            found = None
            with suppress(SettingError):
                found = self._table.find(free, kinds, si)
            if found is None and place > 0 and free:
                found = free[0]
            if found in free:
                free.remove(found)
            other = {ROW: row} if place == 0 else {}
            if place == 0 and self.use.value == LOOP:
                other = {NONE: -1, **other}
            value = found.place if found is not None else next(iter(other.values()), 0)
            column.param.update(label=title, options={**other, **known}, value=value)
            self._offer(unit, found, si)

    def _offer(self, field: Any, column: TableColumn | None, si: str) -> None:
        """Offer the units of a quantity, with that of the head."""
        units = TIMES if si == "s" else list(sizes_of(si))
        given = column.unit if column is not None and size_in(column.unit, si) else ""
        same = [unit for unit in units if given and size_in(unit, si) == size_in(given, si)]
        value = same[0] if same else given or si
        field.param.update(options=[*units] if value in units else [value, *units], value=value)

    def _on_use(self) -> None:
        if not self._is_updating:
            self._is_updating = True
            self._fit()
            self._is_updating = False
            self._take()

    def _on_field(self, field: Any) -> None:
        if self._is_updating:
            return
        if field in self.columns:
            place = self.columns.index(field)
            chosen = self._table.columns[field.value] if field.value >= 0 else None
            self._is_updating = True
            self._offer(self.units[place], chosen, self._roles[place][1])
            self._is_updating = False
        self._take()

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
        columns, count = self._table.columns, len(self._roles)
        pairs = zip(self.columns[:count], self.units[:count], strict=True)
        time, *rest = (
            replace(columns[column.value], unit=unit.value) if column.value >= 0 else None
            for column, unit in pairs
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
