"""Files of a user: a table of points for a load path is brought, settings are saved."""

from __future__ import annotations

from solver.checked import dump
from solver.definitions import Curve, SettingError
from solver.settings import Settings
from solver.tables import read_table

WARM_NOTE = """\
# The run on the page started from the solution of the run before it, so its iterations and times
# are not those of these settings alone, which start as `start` says.
"""
"""Stands in a file that is saved while such a run is looked at."""


def saved(settings: Settings, *, was_warm: bool) -> str:
    """Write a settings file, of a run that may have started from the run before it."""
    return (WARM_NOTE if was_warm else "") + dump(settings)


def load_in(text: str, source: str, settings: Settings) -> tuple[str, list[list[float]]]:
    """Read a table for the load path that its head names, or for the only one that applies.

    Parameters
    ----------
    text, source
        CSV of time and value, and the name of its file.
    settings
        Those in force, which say what applies.

    Returns
    -------
    Name of the setting, and its points.

    Raises
    ------
    SettingError
        If no path applies, several do and the head names none of them, or the table is refused.
    """
    paths = {
        name: definition
        for name, definition in settings.definitions().items()
        if isinstance(definition, Curve)
        and definition.abscissa == "time"
        and settings.applies(name)
    }
    names = ", ".join(paths)
    if not paths:
        raise SettingError(
            "the table",
            source,
            "a load path, of which none applies",
            "have a side displaced or loaded first",
        )
    head = [cell.strip() for cell in text.lstrip().partition("\n")[0].split(",")]
    chosen = [name for name in paths if len(paths) == 1 or name in head]
    if len(chosen) != 1:
        raise SettingError(
            "the table",
            source,
            f"a table of one of {names}",
            f"name the one in its first line, as in time,{next(iter(paths))}",
        )
    (name,) = chosen
    return name, read_table(text, paths[name], name, source)
