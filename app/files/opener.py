"""Buttons that open and save files, and a dialog of the columns of a table."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import pandas as pd
import panel as pn
import panel_material_ui as pmui

from app.files.tables import (
    TABLES,
    USES,
    Content,
    paths_of,
    read_as,
    renamed,
    table_of,
    use_on,
)
from app.refusals import message_of
from app.state import PageState, default_settings
from app.widgets import PlainText, button, dialog, download
from solver.files.saved import dump, read_settings
from solver.files.tables import Table
from solver.refusal import RefusedError
from solver.settings.definitions import title_of
from solver.settings.scene import Settings
from solver.study.measured_loop import MeasuredLoop
from solver.study.table_use import Use

HELP = (
    "Settings (.toml) that were saved here; or a table (.csv, .xlsx, ...): of time and load; of "
    "displacement and force, a measured loop, which is drawn beside the run; or of x, t and "
    "friction force or displacement, as another program found them, which are drawn beside it, too."
)
HEADS = (
    "A name for each column, with its unit in brackets, as in `time [s], displacement [mm], "
    "force [kN]`. Others are passed over; one name more is that of the row's number."
)
SHOWN = 5
"""Lines of a table that are shown."""


def files_panel(state: PageState, width: int) -> pn.Column:
    """Buttons that save and reset settings and open files."""
    look: dict[str, Any] = {"width": width, "margin": (4, 0), "size": "small"}
    opener = TableOpener(state, "Open settings or a table", f".toml,{TABLES}", width)

    def reset() -> None:
        state.adopt(default_settings(state.settings.scene))

    return pn.Column(
        download(
            "Save settings (.toml)",
            "settings.toml",
            lambda: dump(state.settings),
            **look,
        ),
        opener.view,
        button(
            "All settings to default",
            reset,
            icon="restart_alt",
            variant="outlined",
            **look,
        ),
        margin=0,
    )


class TableOpener:
    """A button that opens a file, a message on it, and a dialog of its columns.

    In the dialog `use` is what the table is used as, and `heads` are the names and
    units of its columns. What is chosen holds at once.
    """

    def __init__(self, state: PageState, label: str, accept: str, width: int) -> None:
        self._state = state
        self._is_updating = False
        self._table: Table | None = None
        look: dict[str, Any] = {"margin": (4, 0), "size": "small", "width": width}
        outlined = {**look, "variant": "outlined"}
        self.file = pmui.FileInput(
            label=label, accept=accept, description=HELP, **outlined
        )
        self.message = PlainText(margin=0)
        self.columns_button = button(
            "Columns and units",
            self.show,
            icon="view_column",
            visible=False,
            **outlined,
        )
        self.remove_button = button("", self._forget, icon="close", **outlined)
        wide: dict[str, Any] = {
            "size": "small",
            "margin": (6, 6),
            "sizing_mode": "stretch_width",
        }
        self.use = pmui.Select(label="Use it as", **wide)
        self.heads = pmui.TextInput(label="Columns", **wide)
        self._rows = pn.pane.DataFrame(None, index=False, margin=(0, 6), max_height=190)
        self._understood = PlainText(margin=(6, 6))
        self.dialog = dialog(
            "Columns and units",
            *(self.use, self.heads, HEADS, self._rows, self._understood),
            width_option="sm",
        )
        buttons = self.file, self.columns_button, self.remove_button
        self.view = pn.Column(
            pn.FlexBox(*buttons, margin=0, gap="0 8px"),
            self.message,
            self.dialog,
            margin=0,
        )
        self.file.param.watch(lambda event: self._open(), "value")
        for field in (self.use, self.heads):
            field.param.watch(lambda event: self._reread(), "value")
        state.param.watch(lambda event: self._on_brought(), "brought")
        self._on_brought()

    def show(self) -> None:
        """Open the dialog for the present scene."""
        self._offer(self.use.value)
        self.dialog.open = True

    def _open(self) -> None:
        """Use a file by its content; for a measured loop show the columns, too."""
        if not self.file.value:
            return
        self._table = None
        content = self._take(partial(self._read, self.file.filename, self.file.value))
        self.columns_button.visible = self._table is not None
        if isinstance(content, MeasuredLoop):
            self.show()

    def _read(self, source: str, data: bytes) -> tuple[Content, str]:
        state = self._state
        if source.lower().endswith(".toml"):
            settings, changed = read_settings(
                data.decode("utf-8-sig", "replace"), source
            )
            definitions = settings.definitions()
            messages = [
                f"{title_of(definitions[name])}: {text}."
                for name, text in changed.items()
            ]
            message = f"{source}: settings of the scene {settings.scene}."
            return settings, " ".join([message, *messages])
        self._table = table = table_of(data, source)
        names = [name.replace(",", " ") for name in names_of(table)]
        self._rows.object = pd.DataFrame(table.cells[:SHOWN], columns=names)
        self._is_updating = True
        self.heads.value = ", ".join(names)
        self._is_updating = False
        self._offer(Use.LOOP)
        use = use_on(state, table)
        self._offer(use)
        return read_as(use, table, state)

    def _offer(self, use: str) -> None:
        """Offer the uses of a table in this scene."""
        paths = paths_of(self._state.settings).items()
        kinds = USES | {title_of(path): name for name, path in paths}
        self._is_updating = True
        known = use if use in kinds.values() else Use.LOOP
        self.use.param.update(options=kinds, value=str(known))
        self._is_updating = False

    def _reread(self) -> None:
        """Use the table as chosen in the dialog."""
        if not self._is_updating and self._table is not None:
            self._take(self._read_as)

    def _read_as(self) -> tuple[Content, str]:
        return read_as(
            self.use.value, renamed(self._table, self.heads.value), self._state
        )

    def _take(self, read: Callable[[], tuple[Content, str]]) -> Content | None:
        """Show or run the content of a file.

        None, and a message, where it is refused.
        """
        content = None
        try:
            content, message = read()
        except RefusedError as refused:
            self._state.refusal = message = message_of(refused, self._state.settings)
        if isinstance(content, Settings):
            self._state.adopt(content)
        elif content is not None:
            self._state.brought = content
        self.message.object = self._understood.object = message
        return content

    def _forget(self) -> None:
        self.message.object = ""
        self._state.brought = None

    def _on_brought(self) -> None:
        brought = self._state.brought
        self.remove_button.visible = brought is not None
        if brought is not None:
            self.remove_button.label = f"Remove {brought.source}"
        else:
            self.remove_button.label = "Remove"


def names_of(table: Table) -> list[str]:
    """Names and units of the columns of a table; numbers for columns without a name."""
    return [
        f"{column.name or place} [{column.unit}]"
        if column.unit
        else column.name or str(place)
        for place, column in enumerate(table.columns, start=1)
    ]
