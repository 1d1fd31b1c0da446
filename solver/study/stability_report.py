"""The stability matrix as lines on a console, a CSV file, and one HTML page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

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
    Verdict.TOLD: ORANGE,
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
        f"{_passed(row):<5} {row.verdict:<7} {case.scene:<6} {case.group + ': ' + case.name:<44} "
        f"{row.method:<12} {found.ending.split()[0]:<10} {found.iterations:>5} "
        f"{' '.join(f'{number(size):>8}' for size in sizes)} {found.seconds:6.2f} s"
    )


def said(row: Row) -> str:
    """Say what a run said of itself, after what it should not have said, and why it is unclear."""
    found = row.outcome
    return " ".join(filter(None, [found.warned, found.doubt and f"{found.doubt};", found.advice]))


HEAD = (
    f"{'':<5} {'':<7} {'scene':<6} {'case':<44} {'method':<12} {'status':<10} {'iter.':>5} "
    f"{'error W':>8} {'error F':>8} {'cond. K':>8} {'cond. E':>8}"
)


def summary(rows: Sequence[Row]) -> str:
    """Say in a sentence how many rows came to what."""
    counts = Counter(row.verdict for row in rows)
    told = ", ".join(f"{counts[verdict]} {verdict}" for verdict in Verdict)
    passed = sum(row.as_expected for row in rows)
    return f"{passed} of {len(rows)} runs pass: {told}."


def notes(apart: Mapping[str, float]) -> list[str]:
    """Say what the words mean, and what the table does not show."""
    meanings = [f"{verdict}: {meaning}." for verdict, meaning in MEANING.items()]
    return [
        *meanings,
        "A run passes if it does not fail and, where the right answer is expected, comes to it. "
        "Errors are distances to the incremental reference, over space and time, relative to it; "
        "to the load or absolute where it is zero.",
        "Condition numbers: of the assembled stiffness with its "
        "support but no contact (K; infinite where contact alone holds a body), and the largest of "
        "the substructures' operators K + B' k B (E).",
        *([_invariance(apart)] if apart else []),
    ]


def _invariance(apart: Mapping[str, float]) -> str:
    units = ", ".join(f"{found:.1e} {name}" for name, found in apart.items())
    held = "holds" if max(apart.values()) <= SAME_UP_TO else "does not hold"
    return f"Invariance {held}: largest relative difference of an iterate in other units, {units}."


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
    page_file.write_text(page(TITLE, stability_sections(rows, apart)), encoding="utf-8")
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
    return [words(summary(rows), notes(apart)), table]


def _passed(row: Row) -> str:
    return "pass" if row.as_expected else "FAIL"
