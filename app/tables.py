"""Tables that a user opens: load paths, measured loops, results of another program."""

from __future__ import annotations

from app.state import PageState
from solver.curves import curve_of
from solver.definitions import CurveParameter, SettingError, about
from solver.files import settings_from_toml
from solver.remarks import ends_of_tables
from solver.scenes import discretise, loop_of
from solver.settings import Settings
from solver.study.comparison import OtherResults, read_results
from solver.study.measured_loop import Axes, MeasuredLoop, axes_of, columns_of, loop_in
from solver.tables import Table, read_table

TABLES = ".csv,.txt,.dat,.tsv"
Content = Settings | OtherResults | MeasuredLoop


def opened(source: str, data: bytes, settings: Settings, axes: Axes) -> tuple[Content, str]:
    """Read a file: settings (.toml), else results if it has places, a loop, or a load path.

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
    table = table_of(data, source)
    if {"x", "position"} & {column.key for column in table.columns}:
        brought = read_results(data, source, settings)
        return brought, f"{source}: {brought.message}."
    try:
        columns = columns_of(table, axes)
    except SettingError:
        return with_path(settings, path_of(table, settings), table)
    loop = loop_in(table, columns, source, axes)
    return loop, f"{source}: {loop.message}."


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


def table_of(data: bytes | str, source: str) -> Table:
    """Table of a file, whatever it is of."""

    def refuse(remedy: str) -> SettingError:
        return SettingError("the table", source, "a table of time and value", remedy)

    return read_table(data, refuse)


def paths_of(settings: Settings) -> dict[str, CurveParameter]:
    """Paths over time that do something."""
    return {
        name: definition
        for name, definition in settings.definitions().items()
        if isinstance(definition, CurveParameter)
        and definition.abscissa == "time"
        and settings.applies(name)
    }


def path_of(table: Table, settings: Settings) -> str:
    """The path over time that the head of a table names, or the only one, or that of the load."""
    paths = paths_of(settings)
    named = paths.keys() & {column.key for column in table.columns}
    loads = [name for name, definition in paths.items() if about(definition).group == "Load"]
    chosen = list(named or (paths if len(paths) == 1 else loads))
    if len(chosen) == 1:
        return chosen[0]
    if not paths:
        raise table.refuse("no load path applies: have a side displaced or loaded first")
    first = next(iter(paths))
    raise table.refuse(f"name one of {', '.join(paths)} in its first line, as in time,{first}")


def axes_on(state: PageState) -> Axes:
    """Titles and units of the loop of the page's run."""
    frame, settings = state.frame, state.settings
    if frame is not None and frame.run.settings.scene == settings.scene:
        return frame.run.across, frame.run.up
    return axes_of(loop_of(settings, discretise(settings)))
