"""A survey as lines on a console, a CSV file, and one HTML page."""

from __future__ import annotations

import csv
import json
import math
from collections import Counter
from collections.abc import Sequence
from html import escape
from pathlib import Path

from solver.latin import Ending
from solver.study.study_report import aligned
from solver.study.survey import MEANING, Row, Verdict, groups, is_sound

COLOURS = {
    Verdict.RIGHT: "#0072B2",
    Verdict.TOLD: "#E69F00",
    Verdict.UNCLEAR: "#999999",
    Verdict.WRONG: "#D55E00",
}
"""Okabe and Ito's palette, told apart by the colour-blind."""
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
FILES = ("survey.csv", "survey.html")
PAGE = """<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Slipfront: survey</title>
<style>
body {{ font: 15px/1.45 system-ui, sans-serif; max-width: 90rem; margin: 2rem auto;
  padding: 0 1rem; color: #222; background: #fff; }}
table {{ border-collapse: collapse; font-size: 0.85rem; margin-bottom: 2rem; }}
th, td {{ padding: 0.2rem 0.5rem; border-bottom: 1px solid #ddd; text-align: left;
  vertical-align: top; }}
td.number {{ text-align: right; font-variant-numeric: tabular-nums; }}
td.verdict {{ border-left: 0.6rem solid; font-weight: 600; }}
td.settings {{ overflow-wrap: anywhere; min-width: 24rem; }}
</style>
<h1>Random runs of all scenes</h1>
<p><b>{summary}</b></p>
<ul>
{notes}
</ul>
<h2>By scene and method</h2>
{counts}
<h2>Every run</h2>
{rows}
</html>
"""


def line(row: Row) -> str:
    """Give one row of the console's table."""
    found = row.outcome
    return (
        f"{row.number:>5} {row.verdict:<7} {row.scene:<6} {row.method:<12} "
        f"{found.ending:<9} {'certified' if found.certified else '':<9} {found.iterations:>5} "
        f"{_number(found.estimated_error):>8} {_number(found.error_force):>8} "
        f"{_number(row.settings.accuracy):>8} {found.seconds:6.2f} s"
    )


HEAD = (
    f"{'row':>5} {'verdict':<7} {'scene':<6} {'method':<12} {'ending':<9} {'':<9} {'iter.':>5} "
    f"{'estimate':>8} {'error F':>8} {'accuracy':>8}"
)


def _number(value: float, digits: str = ".1e") -> str:
    return "-" if math.isnan(value) else f"{value:{digits}}"


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


def prepare(folder: Path) -> None:
    """Make the folder and its files, so that a long run does not fail at its end.

    Raises
    ------
    OSError
        When that is not possible.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for name in FILES:
        (folder / name).open("a", encoding="utf-8").close()


def write_report(rows: Sequence[Row], folder: Path) -> list[Path]:
    """Write `survey.csv` and `survey.html`, and give these files.

    Raises
    ------
    OSError
        When a file cannot be written.
    """
    table, page = (folder / name for name in FILES)
    with table.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        writer.writerows(values(row) for row in rows)
    page.write_text(html(rows), encoding="utf-8")
    return [table, page]


def html(rows: Sequence[Row]) -> str:
    """Write the page."""
    head, *counts = table_of_counts(rows)
    notes = [f"{verdict}: {meaning}." for verdict, meaning in MEANING.items()]
    return PAGE.format(
        summary=escape(summary(rows)),
        notes="\n".join(f"<li>{escape(note)}</li>" for note in notes),
        counts=_table(head, ["".join(f"<td>{cell}</td>" for cell in own) for own in counts]),
        rows=_table(
            [column.replace("_", " ") for column in COLUMNS],
            [_cells(row) for row in rows],
        ),
    )


def _table(head: Sequence[str], rows: Sequence[str]) -> str:
    heads = "".join(f"<th>{escape(column)}</th>" for column in head)
    body = "\n".join(f"<tr>{row}</tr>" for row in rows)
    return f"<table>\n<tr>{heads}</tr>\n{body}\n</table>"


def _cells(row: Row) -> str:
    cells = []
    for column, value in values(row).items():
        if column == "verdict":
            colour = COLOURS[row.verdict]
            cells.append(f'<td class="verdict" style="border-color: {colour}">{value}</td>')
        elif isinstance(value, float):
            text = _number(value, ".2f" if column == "seconds" else ".1e")
            cells.append(f'<td class="number">{text}</td>')
        elif isinstance(value, bool):
            cells.append(f"<td>{'yes' if value else 'no'}</td>")
        elif isinstance(value, int):
            cells.append(f'<td class="number">{value}</td>')
        else:
            cells.append(f'<td class="{column}">{escape(str(value))}</td>')
    return "".join(cells)
