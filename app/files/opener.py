"""Buttons to open and save files, and a dialog for the columns of a table."""

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
from app.widgets import PlainText, button, dialog, download, file_button
from solver.files.meshes import MESHES, text_of_mesh
from solver.files.saved import dump, read_settings
from solver.files.tables import Table
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE
from solver.settings.definitions import title_of
from solver.settings.scene import Settings
from solver.study.measured_loop import MeasuredLoop
from solver.study.table_use import Use

HELP = (
    "Settings (.toml) that were saved here; a mesh with names (.msh of Gmsh, .inp of "
    "Abaqus or CalculiX); or a table (.csv, .xlsx, ...): of time and load; of "
    "displacement and force, a measured loop, which is drawn beside the run; or of x, "
    "t and friction force or displacement, as another program found them, which are "
    "drawn beside it, too."
)
HEADS = (
    "A name for each column, with its unit in brackets, as in “time [s], displacement "
    "[mm], force [kN]”. Others are passed over; one name more is that of the row's "
    "number."
)
SHOWN = 5
"""Number of rows of a table that are shown."""


def files_panel(state: PageState, width: int) -> pn.Column:
    """Buttons to save and reset settings, and to open files."""
    look: dict[str, Any] = {"width": width, "margin": (4, 0), "size": "small"}
    kinds = ",".join([".toml", *MESHES, TABLES])
    opener = TableOpener(state, "Open settings, a table or a mesh", kinds, width)

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
    """A button to open a file, a message on the file, and a dialog for its columns.

    The dialog has fields for the `use` of the table, and for the names and units of its
    columns (`heads`). Each choice holds at once.
    """

    def __init__(self, state: PageState, label: str, accept: str, width: int) -> None:
        self._state = state
        self._is_updating = False
        self._table: Table | None = None
        self._source = ""
        self._make_buttons(label, accept, width)
        self._make_dialog()
        buttons = self.file, self.columns_button, self.remove_button
        self.view = pn.Column(
            pn.FlexBox(*buttons, margin=0, gap="0 8px"),
            self.message,
            self.dialog,
            margin=0,
        )
        for field in (self.use, self.heads):
            field.param.watch(lambda event: self._reread(), "value")
        state.param.watch(lambda event: self._on_brought(), "brought")
        state.param.watch(self._on_settings, "settings")
        self._on_brought()

    def _make_buttons(self, label: str, accept: str, width: int) -> None:
        outlined: dict[str, Any] = {
            "margin": (4, 0),
            "size": "small",
            "width": width,
            "variant": "outlined",
        }
        self.file = file_button(
            label,
            accept,
            self._open,
            icon="upload_file",
            description=HELP,
            **outlined,
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

    def _make_dialog(self) -> None:
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
            self.use,
            self.heads,
            HEADS,
            self._rows,
            self._understood,
            width_option="sm",
        )

    def show(self) -> None:
        """Open the dialog for the present scene."""
        self._offer(self.use.value)
        self.dialog.open = True

    def _open(self, data: bytes, source: str) -> None:
        """Use a file by its content; for a measured loop also show the columns."""
        self._table = None
        self._source = source
        self._say("")
        content = self._take(partial(self._read, source, data))
        self.columns_button.visible = self._table is not None
        if isinstance(content, MeasuredLoop):
            self.show()

    def _read(self, source: str, data: bytes) -> tuple[Content, str]:
        """Content of a file, and a message on the content."""
        if source.lower().endswith(".toml"):
            return settings_in(data, source)
        if source.lower().endswith(MESHES):
            settings = CATALOGUE["mesh"].checked({"mesh": text_of_mesh(data, source)})
            return settings, f"{source}: {settings.sentence()}"
        table = table_of(data, source)
        self._table = table
        # In the field commas stand between the names.
        names = [name.replace(",", " ") for name in names_of(table)]
        self._rows.object = pd.DataFrame(table.cells[:SHOWN], columns=names)
        self._is_updating = True
        self.heads.value = ", ".join(names)
        self._is_updating = False
        # First the use that each scene has: to find the other one may be refused, and
        # the dialog then mends the table.
        self._offer(Use.LOOP)
        use = use_on(self._state, table)
        self._offer(use)
        return read_as(use, table, self._state)

    def _offer(self, use: str) -> None:
        """Offer the uses of a table in this scene, and select one if possible."""
        options = dict(USES)
        for name, path in paths_of(self._state.settings).items():
            options[title_of(path)] = name
        if use not in options.values():
            use = Use.LOOP
        self._is_updating = True
        self.use.param.update(options=options, value=str(use))
        self._is_updating = False

    def _reread(self) -> None:
        """Use the table as chosen in the dialog."""
        if not self._is_updating and self._table is not None:
            self._take(self._read_as)

    def _read_as(self) -> tuple[Content, str]:
        table = renamed(self._table, self.heads.value)
        return read_as(self.use.value, table, self._state)

    def _take(self, read: Callable[[], tuple[Content, str]]) -> Content | None:
        """Show or run the content of a file; None and a message for a refusal."""
        content = None
        try:
            content, message = read()
        except RefusedError as refused:
            reason = message_of(refused, self._state.settings)
            message = f"{self._source} was refused. {reason}"
            self._state.refusal = reason
        if isinstance(content, Settings):
            self._state.adopt(content)
        elif content is not None:
            self._state.param.update(brought=content, refusal="")
        self._say(message)
        return content

    def _say(self, message: str) -> None:
        """Show a message on the file next to its button and in the dialog."""
        self.message.object = self._understood.object = message

    def _on_settings(self, event: Any) -> None:
        """Remove the message on a file when another scene is chosen."""
        if event.new.scene != event.old.scene:
            self._say("")
            self._table = None
            self.columns_button.visible = False

    def _forget(self) -> None:
        self._say("")
        self._state.brought = None

    def _on_brought(self) -> None:
        brought = self._state.brought
        self.remove_button.visible = brought is not None
        if brought is not None:
            self.remove_button.label = f"Remove {brought.source}"
        else:
            self.remove_button.label = "Remove"


def settings_in(data: bytes, source: str) -> tuple[Settings, str]:
    """Settings in a file, and a message on settings and changes of meaning."""
    settings, changed = read_settings(data, source)
    sentences = [f"{source}: settings of the scene {settings.scene}."]
    definitions = settings.definitions()
    for name, reason in changed.items():
        sentences.append(f"{title_of(definitions[name])}: {reason}.")
    return settings, " ".join(sentences)


def names_of(table: Table) -> list[str]:
    """Text of the columns of a table: names and units, or numbers without names."""
    names = []
    for number, column in enumerate(table.columns, start=1):
        name = column.name or str(number)
        if column.unit:
            name += f" [{column.unit}]"
        names.append(name)
    return names
