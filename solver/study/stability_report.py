"""The stability matrix as lines on a console, a CSV file, and one HTML page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from solver.disk import write
from solver.study.page import page
from solver.study.row_report import (
    BLUE,
    GREY,
    LIGHT,
    ORANGE,
    RED,
    number,
    prepare,
    table_of,
    tally,
    words,
    write_rows,
)
from solver.study.stability import (
    MEANING,
    SAME_UP_TO,
    Row,
    Verdict,
)

TITLE = "Stability on stiff and extreme cases"
COLOURS: dict[str, str] = {
    Verdict.RIGHT: BLUE,
    Verdict.NEAR: LIGHT,
    Verdict.UNSOLVED: ORANGE,
    Verdict.UNCLEAR: GREY,
    Verdict.FAIL: RED,
}
COLUMNS = (
    "scene",
    "group",
    "case",
    "method",
    "expected",
    "verdict",
    "passed",
    "status",
    "iterations",
    "error_displacement",
    "error_force",
    "indicator",
    "behaviour",
    "condition_structure",
    "condition_substructure",
    "seconds",
    "advice",
)


def passes(rows: Sequence[Row], apart: Mapping[str, float]) -> bool:
    """Tell whether every case came to what is expected, and no unit changed an iterate."""
    same = all(found <= SAME_UP_TO for found in apart.values())
    return same and all(row.as_expected for row in rows)


def line(row: Row) -> str:
    """Give one row of the console's table."""
    found, case = row.outcome, row.case
    sizes = (
        found.error_displacement,
        found.error_force,
        found.condition_structure,
        found.condition_substructure,
    )
    return (
        f"{_passed(row):<5} {row.verdict:<8} {case.scene:<6} {case.group + ': ' + case.name:<44} "
        f"{row.method:<12} {found.ending.split()[0]:<10} {found.iterations:>5} "
        f"{' '.join(f'{number(size):>8}' for size in sizes)} {found.seconds:6.2f} s"
    )


def said(row: Row) -> str:
    """Say what a run said of itself, after what it should not have said, and why it is unclear."""
    found = row.outcome
    return " ".join(filter(None, [found.warned, found.doubt and f"{found.doubt};", found.advice]))


HEAD = (
    f"{'':<5} {'':<8} {'scene':<6} {'case':<44} {'method':<12} {'status':<10} {'iter.':>5} "
    f"{'error W':>8} {'error F':>8} {'cond. K':>8} {'cond. E':>8}"
)


def summary(rows: Sequence[Row]) -> str:
    """Say in a sentence how many rows came to what is expected."""
    return f"{sum(row.as_expected for row in rows)} of {len(rows)} runs pass."


def counts(rows: Sequence[Row]) -> list[list[str]]:
    """Count the verdicts, and say what each means; with a head."""
    return tally([row.verdict for row in rows], MEANING)


def notes(apart: Mapping[str, float]) -> list[str]:
    """Say what passing means, what the columns hold, and what the table does not show."""
    return [
        "A run passes if it comes to what is expected of it.",
        "Errors: distance to the reference solution over space and time, as a share of it; where "
        "it is zero, as a share of the load, or in m and N.",
        "Condition numbers: of the stiffness of the whole structure with its supports but without "
        "contact (structure, K; infinite where contact alone holds a body), and the largest of "
        "what a substructure solves in an iteration (substructure, E).",
        *([_invariance(apart)] if apart else []),
    ]


def _invariance(apart: Mapping[str, float]) -> str:
    units = ", ".join(f"{found:.1e} {name}" for name, found in apart.items())
    same = "the same" if max(apart.values()) <= SAME_UP_TO else "other"
    return f"In other units the bar has {same} iterates; largest relative difference: {units}."


def write_report(rows: Sequence[Row], apart: Mapping[str, float], folder: Path) -> list[Path]:
    """Write `stability.csv` and `stability.html`.

    Parameters
    ----------
    rows
        The matrix.
    apart
        What `invariance` found; empty where it was not asked.
    folder
        An existing folder; files of these names are replaced.

    Returns
    -------
    The files.

    Raises
    ------
    OSError
        When a file cannot be written.
    """
    table, page_file = prepare(folder, "stability")
    write_rows(table, COLUMNS, [values(row) for row in rows])
    write(page_file, page(TITLE, stability_sections(rows, apart)))
    return [table, page_file]


def values(row: Row) -> dict[str, object]:
    """Give the entries of a row by column."""
    found = row.outcome
    return {
        "scene": row.case.scene,
        "group": row.case.group,
        "case": row.case.name,
        "method": row.method,
        "expected": row.case.expected,
        "verdict": str(row.verdict),
        "passed": _passed(row),
        "status": str(found.ending),
        "iterations": found.iterations,
        "error_displacement": found.error_displacement,
        "error_force": found.error_force,
        "indicator": found.indicator,
        "behaviour": found.behaviour,
        "condition_structure": found.condition_structure,
        "condition_substructure": found.condition_substructure,
        "seconds": found.seconds,
        "advice": said(row),
    }


def stability_sections(rows: Sequence[Row], apart: Mapping[str, float]) -> list[str]:
    """Write the report (HTML)."""
    table = table_of(COLUMNS, [values(row) for row in rows], COLOURS)
    return [words(summary(rows), counts(rows), notes(apart)), table]


def _passed(row: Row) -> str:
    return "pass" if row.as_expected else "FAIL"
