"""Files of a user: load paths and results of other programs are brought, settings are saved."""

from __future__ import annotations

from collections.abc import Container, Mapping

from solver.checked import dump
from solver.curves import curve_of
from solver.definitions import CurveParameter, SettingError, about
from solver.files import ends_of_tables
from solver.settings import Settings
from solver.study.other_programs.brought import CAN, Brought, read_brought
from solver.tables import read_table

WARM_NOTE = """\
# The run on the page started from the solution of the run before it, so its iterations and times
# are not those of these settings alone, which start as `start` says.
"""
"""Stands in a file that is saved while such a run is looked at."""


def saved(settings: Settings, *, was_warm: bool) -> str:
    """Write a settings file, of a run that may have started from the run before it."""
    return (WARM_NOTE if was_warm else "") + dump(settings)


def brought_in(source: str, text: str | None, settings: Settings) -> Brought:
    """Read results of another program; nothing stands for what is no text.

    Raises
    ------
    SettingError
        As `read_brought`.
    """
    if text is None:
        raise SettingError("the results", source, CAN, "it is no text: save the table as CSV")
    return read_brought(text, source, settings)


def load_in(data: bytes | str, source: str, settings: Settings) -> tuple[Settings, str]:
    """Read a table for the load path that its head names, or for the only one that applies.

    The run then lasts until the last table ends.

    Parameters
    ----------
    data, source
        CSV of time and value, its bytes or text, and the name of its file.
    settings
        Those in force, which say what applies.

    Returns
    -------
    The settings with it, and what to say of that.

    Raises
    ------
    SettingError
        If no path applies; if several do, the head names none of them, and not just one is of a
        load; or if the table is refused.
    """
    paths = {
        name: definition
        for name, definition in settings.definitions().items()
        if isinstance(definition, CurveParameter)
        and definition.abscissa == "time"
        and settings.applies(name)
    }

    def refuse(remedy: str, can: str = "a table of time and value") -> SettingError:
        return SettingError("the table", source, can, remedy)

    if not paths:
        can = "a load path, of which none applies"
        raise refuse("have a side displaced or loaded first", can)
    table = read_table(data, refuse)
    chosen = _meant(paths, {column.key for column in table.columns})
    if len(chosen) != 1:
        remedy = f"name the one in its first line, as in time,{next(iter(paths))}"
        raise refuse(remedy, f"a table of one of {', '.join(paths)}")
    (name,) = chosen
    curve = curve_of(table, paths[name], name, settings.curve_units(name))
    found = settings.replace(**{name: curve.points})
    ends = max(ends_of_tables(found).values())
    found = found.replace(duration=ends) if ends > 0.0 else found
    return found, _said_of(found, name, curve.message)


def _meant(paths: Mapping[str, CurveParameter], heads: Container[str]) -> list[str]:
    """Name the paths that the head names, or else the only one, or those of a load."""
    named = [name for name in paths if name in heads]
    loads = [name for name, path in paths.items() if about(path).group == "Load"]
    return named or (list(paths) if len(paths) == 1 else loads)


def cut_off(settings: Settings) -> str:
    """Say which tables go on after the run has ended, or nothing."""
    duration, definitions = settings.duration, settings.definitions()
    return " ".join(
        f"{about(definitions[name]).title} goes on to {end:g} s, but the run ends at {duration:g}"
        " s."
        for name, end in ends_of_tables(settings).items()
        if end > duration
    )


def _said_of(settings: Settings, name: str, message: str) -> str:
    """Say what a table has become, and what a run does not see of it."""
    values = settings.values()
    title = about(settings.definitions()[name]).title
    said = f"{title}: {message}. The run lasts {values['duration']:g} s"
    return f"{said}, and reads them at {settings.n_instants} instants."
