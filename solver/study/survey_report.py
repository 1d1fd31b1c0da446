"""A survey as lines on a console, a CSV file, and one HTML page."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from solver.latin import Ending
from solver.study.page import page, plain_table
from solver.study.row_report import (
    BLUE,
    GREY,
    ORANGE,
    RED,
    number,
    prepare,
    table_of,
    words,
    write_rows,
)
from solver.study.study_report import aligned
from solver.study.survey import MEANING, Row, Verdict, groups, is_sound

COLOURS: dict[str, str] = {
    Verdict.RIGHT: BLUE,
    Verdict.TOLD: ORANGE,
    Verdict.UNCLEAR: GREY,
    Verdict.WRONG: RED,
}
COLUMNS = (
    "scene",
    "seed",
    "row",
    "method",
    "foolish_k",
    "may_finish",
    "verdict",
    "ending",
    "certified",
    "iterations",
    "accuracy",
    "estimated_error",
    "error_force",
    "error_displacement",
    "residual",
    "seconds",
    "doubt",
    "advice",
    "settings",
)


def line(row: Row) -> str:
    """Give one row of the console's table."""
    found = row.outcome
    return (
        f"{row.number:>5} {row.verdict:<7} {row.scene:<6} {row.method:<12} "
        f"{found.ending:<9} {'certified' if found.certified else '':<9} {found.iterations:>5} "
        f"{number(found.estimated_error):>8} {number(found.error_force):>8} "
        f"{number(row.settings.accuracy):>8} {found.seconds:6.2f} s"
    )


HEAD = (
    f"{'row':>5} {'verdict':<7} {'scene':<6} {'method':<12} {'ending':<9} {'':<9} {'iter.':>5} "
    f"{'estimate':>8} {'error F':>8} {'accuracy':>8}"
)


def summary(rows: Sequence[Row]) -> str:
    """Say in a few sentences how many rows came to what."""
    counts = Counter(row.verdict for row in rows)
    told = ", ".join(f"{counts[verdict]} {verdict}" for verdict in Verdict)
    sound = [row for row in rows if is_sound(row)]
    finishing = [row for row in sound if row.may_finish]
    others = [row for row in sound if not row.may_finish]
    return (
        f"{len(rows)} runs: {told}. Ended otherwise than converged, of those that have one "
        f"solution and no foolish k: {_missed(sound)}. Of these, where a status step may finish: "
        f"{_missed(finishing)}; elsewhere: {_missed(others)}."
    )


def _missed(rows: Sequence[Row]) -> str:
    """Count those that did not converge, and among them those whose iterations were used up."""
    missed = [row for row in rows if row.verdict is Verdict.TOLD]
    exhausted = sum(row.outcome.ending == Ending.EXHAUSTED for row in missed)
    share = f" ({100.0 * len(missed) / len(rows):.1f} %)" if rows else ""
    return f"{len(missed)} of {len(rows)}{share}, {exhausted} of them out of iterations"


def table_of_counts(rows: Sequence[Row]) -> list[list[str]]:
    """Count the verdicts by scene and method, and how many were certified; with a head."""
    found = [["scene", "method", "runs", *Verdict, "certified", "median iterations"]]
    for scene, method, own in groups(rows):
        counts = Counter(row.verdict for row in own)
        middle = sorted(row.outcome.iterations for row in own)[len(own) // 2]
        certified = sum(row.outcome.certified for row in own)
        numbers = [len(own), *(counts[verdict] for verdict in Verdict), certified, middle]
        found.append([scene, method, *map(str, numbers)])
    return found


def wrong_lines(rows: Sequence[Row]) -> list[str]:
    """List what is wrong, each with the commands that repeat it."""
    found = []
    for row in rows:
        if row.verdict is Verdict.WRONG:
            again = f"python -m solver survey {row.scene} --seed {row.seed} --row {row.number}"
            found += [line(row), f"      {row.outcome.advice}", f"      {again}"]
            found.append(f"      {row.command}")
    return found


def ends(rows: Sequence[Row]) -> list[str]:
    """Give the lines that a survey ends with: counts, what they amount to, and what is wrong."""
    return [aligned(table_of_counts(rows)), "", summary(rows), *wrong_lines(rows)]


def values(row: Row) -> dict[str, object]:
    """Give the entries of a row by column."""
    found = row.outcome
    return {
        "scene": row.scene,
        "seed": row.seed,
        "row": row.number,
        "method": row.method,
        "foolish_k": row.is_foolish,
        "may_finish": row.may_finish,
        "verdict": str(row.verdict),
        "ending": found.ending,
        "certified": found.certified,
        "iterations": found.iterations,
        "accuracy": row.settings.accuracy,
        "estimated_error": found.estimated_error,
        "error_force": found.error_force,
        "error_displacement": found.error_displacement,
        "residual": found.residual,
        "seconds": found.seconds,
        "doubt": found.doubt,
        "advice": found.advice,
        "settings": json.dumps(row.changed),
    }


def write_report(rows: Sequence[Row], folder: Path) -> list[Path]:
    """Write `survey.csv` and `survey.html`, and give these files.

    Raises
    ------
    OSError
        When a file cannot be written.
    """
    table, page_file = prepare(folder, "survey")
    write_rows(table, COLUMNS, [values(row) for row in rows])
    page_file.write_text(html(rows), encoding="utf-8")
    return [table, page_file]


def html(rows: Sequence[Row]) -> str:
    """Write the page."""
    notes = [f"{verdict}: {meaning}." for verdict, meaning in MEANING.items()]
    sections = [
        words(summary(rows), notes),
        f"<h2>By scene and method</h2>\n{plain_table(table_of_counts(rows))}",
        f"<h2>Every run</h2>\n{table_of(COLUMNS, [values(row) for row in rows], COLOURS)}",
    ]
    return page("Random runs of all scenes", sections)
