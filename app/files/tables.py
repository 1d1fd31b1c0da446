"""Tables opened by a user: load paths, measured loops, results of other programs."""

from __future__ import annotations

from app.state import PageState
from solver.discrete.structure import Axes
from solver.files.columns import column_of
from solver.files.curves import curve_of, path_doubts
from solver.files.disk import LARGEST
from solver.files.tables import Table, read_table
from solver.scenes.remarks import ends_of_tables
from solver.settings.definitions import CurveParameter, properties_of, title_of
from solver.settings.scene import Settings
from solver.settings.values import SettingError
from solver.study.comparison import OtherResults, results_in
from solver.study.measured_loop import MeasuredLoop, loop_in
from solver.study.table_use import Use, use_of

TABLES = ".csv,.txt,.dat,.tsv,.xlsx"
USES = {"Measured loop": str(Use.LOOP), "Results of another program": str(Use.RESULTS)}
"""Uses of a table by their titles; a further use is the name of a path."""
Content = Settings | OtherResults | MeasuredLoop


def use_on(state: PageState, table: Table) -> str:
    """Use of a table by its head: a loop, results, or the name of a path."""
    use = use_of(table, axes_on(state))
    if use is Use.PATH:
        return path_of(table, state.settings)
    return str(use)


def read_as(use: str, table: Table, state: PageState) -> tuple[Content, str]:
    """Read a table as a loop, results or a path; return content and message."""
    if use == Use.RESULTS:
        results = results_in(table, state.settings)
        return results, f"{table.source}: {results.message}."
    if use != Use.LOOP:
        return with_path(state.settings, use, table)
    loop = loop_in(table, axes_on(state))
    sentences = [f"{table.source}: {loop.message}.", *_doubts(loop, state)]
    return loop, " ".join(sentences)


def _doubts(loop: MeasuredLoop, state: PageState) -> list[str]:
    """Warnings on a loop that is doubtful beside the shown run."""
    frame = state.frame
    # Without a run of the same quantities there is nothing to compare with.
    if frame is None or (frame.run.across[1], frame.run.up[1]) != loop.units:
        return []
    return [f"{doubt}." for doubt in loop.doubts(*frame.loop)]


def with_path(settings: Settings, name: str, table: Table) -> tuple[Settings, str]:
    """Settings with a table for a path, and a message on the table.

    A run then lasts until the last of its tables ends.
    """
    definition = settings.definitions()[name]
    points, message = curve_of(table, definition, name, settings.curve_units(name))
    changed = settings.replace(**{name: points})
    sentences = [f"{title_of(definition)}: {message}."]
    for doubt in path_doubts(table, settings, name, points):
        sentences.append(f"{doubt}.")
    # A table of time sets the length of the run; other curves, as over slip, do not.
    if definition.abscissa == "time":
        end = max(ends_of_tables(changed).values(), default=0.0)
        if end > 0.0:
            changed = changed.replace(duration=end)
        sentences.append(f"The run lasts {changed.duration:g} s.")
    return changed, " ".join(sentences)


def table_of(data: bytes | str, source: str) -> Table:
    """Read the table in a file of any format."""
    if len(data) > LARGEST:
        most = f"a table of at most {LARGEST // 1_000_000} MB"
        remedy = (
            f"it has {len(data) / 1e6:.1f} MB: leave out lines, or give it whole to "
            "the command compare"
        )
        raise SettingError("the table", source, most, remedy)
    return read_table(data, source, "the table", "a table of time and value")


def renamed(table: Table, heads: str) -> Table:
    """A table with other names and units of columns, separated by commas.

    A further name adds a last column, the number of each row from 0.
    """
    columns = []
    for number, head in enumerate(heads.split(",")):
        columns.append(column_of(number, 1, head.strip()))
    width = len(table.columns)
    if len(columns) not in (width, width + 1):
        raise table.refuse(f"it has {width} columns: write as many names, or one more")
    return table.with_columns(columns)


def paths_of(settings: Settings) -> dict[str, CurveParameter]:
    """Definitions of the paths over time that apply in the scene, by name."""
    definitions = settings.definitions()
    return {name: definitions[name] for name in settings.paths}


def path_of(table: Table, settings: Settings) -> str:
    """Name of the path: from the head of a table, else the only path or the load."""
    paths = paths_of(settings)
    chosen = list(paths.keys() & {column.key for column in table.columns})
    if not chosen:
        chosen = list(paths)
        if len(paths) > 1:
            chosen = _loads(paths)
    if len(chosen) == 1:
        return chosen[0]
    if not paths:
        raise table.refuse(
            "no load path applies: have a side displaced or loaded first"
        )
    first = next(iter(paths))
    raise table.refuse(
        f"name one of {', '.join(paths)} in its first line, as in time,{first}"
    )


def _loads(paths: dict[str, CurveParameter]) -> list[str]:
    """Names of the paths that are loads."""
    loads = []
    for name, definition in paths.items():
        if properties_of(definition).group == "Load":
            loads.append(name)
    return loads


def axes_on(state: PageState) -> Axes:
    """Titles and units of the loop of the page's run."""
    frame = state.frame
    settings = state.settings
    if frame is not None and frame.run.settings.scene == settings.scene:
        return frame.run.across, frame.run.up
    return settings.structure().axes
