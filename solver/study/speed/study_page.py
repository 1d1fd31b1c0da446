"""A study as a report: curves of error over time, of growth, and the tables; and its files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from solver.study.page import PlotSection, Section, bullets, plain_table, write_page
from solver.study.speed.crossover import Crossover
from solver.study.speed.crossover_report import MAP, crossover_map, crossover_notes, crossover_table
from solver.study.speed.error_against_time import Study
from solver.study.speed.growth import Growth
from solver.study.speed.study_panels import CAPTION, CURVES, GROWTH, error_panels, growth_panels
from solver.study.speed.study_report import (
    GROWTH_NOTE,
    TIMES,
    TIMES_NOTE,
    WINNERS,
    WINNERS_NOTE,
    conditions,
    growth_table,
    table,
    winners,
    write_curves,
    write_growth,
    write_map,
)

TITLE = "Error against run time"


def study_sections(study: Study, found: Sequence[Growth], sizes: Crossover) -> list[Section]:
    """Write a study, growth with the size if that was measured, and the map of who is first."""
    growth: list[Section] = [
        f"<h2>{GROWTH}</h2>\n<p>{GROWTH_NOTE}</p>",
        PlotSection(GROWTH, growth_panels(found)),
        plain_table(growth_table(found)),
    ]
    return [
        f"<h2>{WINNERS}</h2>\n{plain_table(winners(study))}\n<p>{WINNERS_NOTE}</p>",
        f"<h2>{CURVES}</h2>",
        PlotSection(CURVES, error_panels(study)),
        f"<p>{CAPTION}</p>\n<h2>{TIMES}</h2>\n<p>{TIMES_NOTE}</p>\n{plain_table(table(study))}",
        *(growth if found else []),
        f"<h2>{MAP}</h2>",
        PlotSection(MAP, [crossover_map(sizes)]),
        f"{plain_table(crossover_table(sizes))}\n{bullets(crossover_notes(sizes))}",
        f"<h2>How it was measured</h2>\n{bullets(conditions(study))}",
    ]


def write_study(
    study: Study, found: Sequence[Growth], sizes: Crossover, folder: Path
) -> tuple[list[Path], str]:
    """Write the tables and `study.html`.

    Parameters
    ----------
    study, found, sizes
        Errors against run time; growth with the size, or nothing; who is first at which size.
    folder
        An existing folder; files of these names are replaced.

    Returns
    -------
    The files, and what whoever asked for them is to be told, if anything.

    Raises
    ------
    OSError
        When a file cannot be written.
    """
    file = folder / "study.html"
    note = write_page(file, TITLE, study_sections(study, found, sizes))
    tables = [*write_curves(study, folder), *write_growth(found, folder), write_map(sizes, folder)]
    return [*tables, file], note
