"""Tables that a user opens: load paths, measured loops, results of another program."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from functools import partial

from app.state import PageState
from solver.columns import column_of
from solver.curves import curve_of
from solver.definitions import CurveParameter, SettingError, about, title_of
from solver.refusal import RefusedError
from solver.remarks import ends_of_tables
from solver.scenes import discretise
from solver.settings import Settings
from solver.study.comparison import OtherResults
from solver.study.measured_loop import Axes, MeasuredLoop, columns_of, loop_in
from solver.tables import Table, read_table

TABLES = ".csv,.txt,.dat,.tsv"
LOOP = "loop"
"""What a table is used as, if it is not the name of a path."""
Content = Settings | OtherResults | MeasuredLoop


def use_of(table: Table, settings: Settings, axes: Axes) -> str:
    """What a table is used as by its head: a loop, or a path."""
    with suppress(RefusedError):
        columns_of(table, axes)
        return LOOP
    return path_of(table, settings)


def read_as(
    use: str, table: Table, source: str, settings: Settings, axes: Axes
) -> tuple[Content, str]:
    """What a table has that is used as a loop or a path, and what was understood."""
    if use != LOOP:
        return with_path(settings, use, table)
    loop = loop_in(table, source, axes)
    return loop, f"{source}: {loop.message}."


def with_path(settings: Settings, name: str, table: Table) -> tuple[Settings, str]:
    """Settings with a table for a path, and what was understood.

    A run then lasts until the last of its tables ends.
    """
    definition = settings.definitions()[name]
    points, message = curve_of(table, definition, name, settings.curve_units(name))
    changed = settings.replace(**{name: points})
    message = f"{title_of(definition)}: {message}."
    if definition.abscissa == "time":
        ends = max(ends_of_tables(changed).values(), default=0.0)
        changed = changed.replace(duration=ends) if ends > 0.0 else changed
        message += f" The run lasts {changed.duration:g} s."
    return changed, message


def table_of(data: bytes | str, source: str) -> Table:
    """Table of a file, whatever it is of."""
    return read_table(data, partial(SettingError, "the table", source, "a table of time and value"))


def renamed(table: Table, heads: str) -> Table:
    """A table with other names and units of its columns, between commas.

    One name more is that of a last column, the number of each row from 0.
    """
    columns = [column_of(place, 1, head.strip()) for place, head in enumerate(heads.split(","))]
    width = len(table.columns)
    if len(columns) == width:
        return replace(table, columns=columns)
    if len(columns) != width + 1:
        raise table.refuse(f"it has {width} columns: write as many names, or one more")
    rows = [(line, [*cells, str(n)]) for n, (line, cells) in enumerate(table.rows)]
    return replace(table, columns=columns, rows=rows)


def paths_of(settings: Settings) -> dict[str, CurveParameter]:
    """Definitions of the paths over time that do something, by name."""
    definitions = settings.definitions()
    return {name: definitions[name] for name in settings.paths}


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
    return settings.structure().loop(discretise(settings)).axes
