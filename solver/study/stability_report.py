"""Reports of stability: columns, counts by verdict, a CSV file and an HTML page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

from solver.study.page import aligned, line_of, text_of, write_csv, write_page
from solver.study.stability import Row, passed
from solver.study.verdicts import JUDGES, MEANING

FILES = "stability.csv", "stability.html"
COLUMNS = (
    "scene",
    "case",
    "method",
    "expected",
    "verdict",
    "passed",
    "status",
    "certified",
    "judged_by",
    "laws",
    "worst_law",
    "reference_laws",
    "iterations",
    "estimated_error",
    "error_displacement",
    "error_force",
    "indicator",
    "behaviour",
    "seconds",
    "doubt",
    "advice",
    "settings",
)
"""Columns of the CSV file."""
LONG = "doubt", "advice", "settings"
"""Columns of words, which have a line of their own on the page."""
SHOWN = {
    "passed": ("", 5),
    "verdict": ("", 8),
    "scene": ("scene", 7),
    "case": ("run", 44),
    "method": ("method", 12),
    "status": ("status", 10),
    "certified": ("certified", 9),
    "iterations": ("iter.", 5),
    "estimated_error": ("estimate", 8),
    "seconds": ("s", 6),
    "error_displacement": ("error W", 8),
    "error_force": ("error F", 8),
    "judged_by": ("judged by", 9),
    "laws": ("laws", 8),
}
"""Columns on a console: head and width by name."""
NOTES = (
    "A run passes if it comes to what is expected of it. Right is an answer that "
    "breaks no law by more than 1e-8, or, if it is certified, by more than the "
    "residual that it states, 1e-5 at most; of other runs also errors of at most "
    "1e-6, and of random runs errors of the contact force of at most the accuracy.",
    "Laws: the largest violation of balance, held displacements, cuts, Signorini's and "
    "Coulomb's law at any place and instant, as a share of the largest contact force, "
    "or jump.",
    "Errors: distance to the reference solution over space and time, as a share of it; "
    "where it is zero, as a share of the load, or in m and N.",
)


def summary(runs: Sequence[Row]) -> str:
    """Sentence on the number of runs that pass."""
    return f"{sum(map(passed, runs))} of {len(runs)} runs pass."


def counted(
    runs: Sequence[Row], column: str, meaning: Mapping[str, str]
) -> list[list[str]]:
    """Numbers of runs by the values of a column and their meaning, below a head."""
    numbers = Counter(run[column] for run in runs)
    rows = [[column.replace("_", " "), "runs", "what it means"]]
    for name, text in meaning.items():
        rows.append([str(name), str(numbers[name]), text])
    return rows


def last_lines(runs: Sequence[Row]) -> list[str]:
    """Last lines on a console: counts, notes, and commands of runs that fail."""
    by_verdict = aligned(counted(runs, "verdict", MEANING))
    tables = [by_verdict, "", aligned(counted(runs, "judged_by", JUDGES))]
    lines = ["", summary(runs), *tables, "", *NOTES]
    for run in runs:
        if not passed(run):
            lines += [
                "",
                line_of(run, SHOWN),
                f"      {run['advice']}",
                f"      {run['command']}",
            ]
    return lines


def write_stability(runs: Sequence[Row], folder: Path) -> None:
    """Write `FILES` into an existing folder."""
    short = [column for column in COLUMNS if column not in LONG]
    cells = []
    shown = []
    for row in runs:
        cells.append([row[column] for column in COLUMNS])
        words = [str(row[column]) for column in LONG if row[column]]
        shown.append(([text_of(row[column]) for column in short], " · ".join(words)))
    write_csv(folder / FILES[0], COLUMNS, cells)
    write_page(
        folder / FILES[1],
        "stability.html",
        [],
        title="Stability on extreme or random runs",
        summary=summary(runs),
        counts=counted(runs, "verdict", MEANING),
        judges=counted(runs, "judged_by", JUDGES),
        notes=NOTES,
        names=[column.replace("_", " ") for column in short],
        runs=shown,
    )
