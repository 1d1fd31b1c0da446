"""Files of a user: settings, load paths, and results of another program."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import NamedTuple

import panel as pn
import panel_material_ui as pmui

from app.refusals import message_of
from app.state import PageState, default_settings
from solver.checked import dump
from solver.curves import curve_of
from solver.definitions import CurveParameter, SettingError, about
from solver.files import ends_of_tables, settings_from_toml
from solver.refusal import RefusedError
from solver.settings import Settings
from solver.study.other_programs.brought import Brought, read_brought
from solver.tables import Table, read_table

TABLES = ".csv,.txt,.dat,.tsv"

HELP = (
    "Settings (.toml) that were saved here; or a table (.csv): of time and load, or of x, t and "
    "friction force or displacement, as another program found them, which is drawn beside the run."
)


class Opened(NamedTuple):
    """What a file was read as, and what was understood."""

    content: Settings | Brought
    message: str


def opened(source: str, data: bytes, settings: Settings) -> Opened:
    """Read a file: settings (.toml), else a table of results if it has places, else a load path.

    Parameters
    ----------
    source, data
        Name of the file and what is in it.
    settings
        Those that hold.

    Raises
    ------
    SettingError
        For what is none of these, or is refused.
    """
    if source.lower().endswith(".toml"):
        read = settings_from_toml(text_of(source, data), source=source)
        return Opened(read, f"{source}: settings of the scene {read.scene}.")
    table = _table(data, source)
    if {"x", "position"} & {column.key for column in table.columns}:
        brought = read_brought(data, source, settings)
        return Opened(brought, f"{source}: {brought.message}.")
    return Opened(*_with_path(settings, _path_of(table, source, settings), table))


def with_points(
    settings: Settings, name: str, table: str | bytes, source: str
) -> tuple[Settings, str]:
    """Settings with a table of points for a path, and what was understood.

    A run then lasts until the last of its tables ends.

    Parameters
    ----------
    settings, name
        What is changed, and its path.
    table, source
        Two columns, with units in their heads or in SI; and what a message calls them.

    Raises
    ------
    SettingError
        If the table is refused.
    """
    return _with_path(settings, name, _table(table, source))


def _with_path(settings: Settings, name: str, table: Table) -> tuple[Settings, str]:
    definition = settings.definitions()[name]
    assert isinstance(definition, CurveParameter)
    curve = curve_of(table, definition, name, settings.curve_units(name))
    changed = settings.replace(**{name: curve.points})
    message = f"{about(definition).title}: {curve.message}."
    if definition.abscissa == "time":
        ends = max(ends_of_tables(changed).values(), default=0.0)
        changed = changed.replace(duration=ends) if ends > 0.0 else changed
        message += f" The run lasts {changed.duration:g} s."
    return changed, message


def text_of(source: str, data: bytes) -> str:
    """The text of a file.

    Raises
    ------
    SettingError
        For what is no text.
    """
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        remedy = "it is no text in UTF-8: save it as CSV or TOML"
        raise SettingError("the file", source, "a text", remedy) from None


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

    Parameters
    ----------
    state
        Takes over what is opened.
    copy
        Has the browser copy the link to what is shown; returns what it had to leave out.
    width
        In pixels.

    Attributes
    ----------
    file
        The widget that takes a file.
    message
        What was understood.
    view
        What stands on the page.
    """

    def __init__(self, state: PageState, copy: Callable[[], str], width: int) -> None:
        self._state, self._copy = state, copy
        more = {"width": width, "margin": (4, 0), "size": "small"}
        save = pmui.FileDownload(
            label="Save settings (.toml)", callback=self._saved, filename="settings.toml", **more
        )
        # Its constructor warns of a variant, whatever it is.
        save.variant = more["variant"] = "outlined"
        default = pmui.Button(
            label="All settings to default",
            icon="restart_alt",
            on_click=lambda event: state.adopt(default_settings(state.settings.scene)),
            **more,
        )
        self.file = pmui.FileInput(
            label="Open settings or a table", accept=f".toml,{TABLES}", description=HELP, **more
        )
        self.file.param.watch(lambda event: self._open(), "value")
        self.message = pmui.Typography("", variant="body2", width=width, margin=0)
        self._remove = pmui.Button(icon="close", on_click=lambda event: self._forget(), **more)
        link = pmui.Button(
            label="Copy link", icon="link", on_click=lambda event: self._copy_link(), **more
        )
        self.view = pn.Column(link, save, self.file, self.message, self._remove, default, margin=0)
        state.param.watch(lambda event: self._show(), "brought")
        self._show()

    def _saved(self) -> io.StringIO:
        return io.StringIO(dump(self._state.settings))

    def _copy_link(self) -> None:
        self.message.object = f"The link to what is shown is copied. {self._copy()}"

    def _open(self) -> None:
        state = self._state
        if not self.file.value:
            return
        try:
            content, self.message.object = opened(
                self.file.filename or "the file", self.file.value, state.settings
            )
        except RefusedError as refused:
            state.refusal = self.message.object = message_of(refused, state.settings)
            return
        if isinstance(content, Brought):
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
