"""A survey as lines on a console, a CSV file, and one HTML page."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from solver.disk import write
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
    tally,
    words,
    write_rows,
)
from solver.study.study_report import aligned
from solver.study.survey import MEANING, Row, Verdict, groups, is_sound

COLOURS: dict[str, str] = {
    Verdict.RIGHT: BLUE,
    Verdict.UNSOLVED: ORANGE,
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
        f"{row.number:>5} {row.verdict:<8} {row.scene:<6} {row.method:<12} "
        f"{found.ending:<9} {'certified' if found.certified else '':<9} {found.iterations:>5} "
        f"{number(found.estimated_error):>8} {number(found.error_force):>8} "
        f"{number(row.settings.accuracy):>8} {found.seconds:6.2f} s"
    )


HEAD = (
    f"{'row':>5} {'verdict':<8} {'scene':<6} {'method':<12} {'ending':<9} {'':<9} {'iter.':>5} "
    f"{'estimate':>8} {'error F':>8} {'accuracy':>8}"
)


MISSED = "Not converged, of runs that have one solution and a k that is not foolish"


def counts(rows: Sequence[Row]) -> list[list[str]]:
    """Count the verdicts, and say what each means; with a head."""
    return tally([row.verdict for row in rows], MEANING)


def table_of_missed(rows: Sequence[Row]) -> list[list[str]]:
    """Count the sound runs that did not converge, by whether a status step may end them."""
    sound = [row for row in rows if is_sound(row)]
    kinds = {
        "may end with a status step": [row for row in sound if row.may_finish],
        "only iterate": [row for row in sound if not row.may_finish],
        "all": sound,
    }
    head = ["runs that", "in all", "not converged", "share", "of these out of iterations"]
    return [head, *([kind, *_missed(own)] for kind, own in kinds.items())]


def _missed(rows: Sequence[Row]) -> list[str]:
    """Count runs, those that did not converge, and among them those out of iterations."""
    missed = [row for row in rows if row.verdict is Verdict.UNSOLVED]
    exhausted = sum(row.outcome.ending == Ending.EXHAUSTED for row in missed)
    share = f"{100.0 * len(missed) / len(rows):.1f} %" if rows else "-"
    return [str(len(rows)), str(len(missed)), share, str(exhausted)]


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
    tables = aligned(table_of_counts(rows)), aligned(counts(rows)), aligned(table_of_missed(rows))
    return [f"{tables[0]}\n", f"{tables[1]}\n", f"{MISSED}:", tables[2], *wrong_lines(rows)]


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
    write(page_file, html(rows))
    return [table, page_file]


def html(rows: Sequence[Row]) -> str:
    """Write the page."""
    sections = [
        words(f"{len(rows)} runs", counts(rows)),
        f"<h2>{MISSED}</h2>\n{plain_table(table_of_missed(rows))}",
        f"<h2>By scene and method</h2>\n{plain_table(table_of_counts(rows))}",
        f"<h2>Every run</h2>\n{table_of(COLUMNS, [values(row) for row in rows], COLOURS)}",
    ]
    return page("Random runs of all scenes", sections)
