"""Judged runs as lines on a console, a CSV file, and one self-contained HTML page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from html import escape
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from statistics import median_high

from solver.study.page import aligned, bullets, html_table, line_of, text_of, write_csv, write_page
from solver.study.stability_case import MEANING, Row, Verdict, passed

FILES = "stability.csv", "stability.html"
COLUMNS = (
    *("scene", "case", "method", "expected", "verdict", "passed", "status", "certified"),
    *("iterations", "estimated_error", "error_displacement", "error_force", "residual"),
    *("indicator", "behaviour", "seconds", "doubt", "advice", "settings"),
)
LONG = "doubt", "advice", "settings"
"""Columns of words: beside numbers there is no room for them on a screen."""
SHOWN = {
    **{"passed": ("", 5), "verdict": ("", 8), "scene": ("scene", 7), "case": ("run", 44)},
    **{"method": ("method", 12), "status": ("status", 10), "certified": ("certified", 9)},
    **{"iterations": ("iter.", 5), "estimated_error": ("estimate", 8), "seconds": ("s", 6)},
    **{"error_displacement": ("error W", 8), "error_force": ("error F", 8)},
}
"""Columns of a console."""
TITLE, RANDOM_TITLE = "Stability on stiff and extreme cases", "Stability on random runs"
ERRORS = (
    "Errors: distance to the reference solution over space and time, as a share of it; where it is "
    "zero, as a share of the load, or in m and N."
)
NOTES = (
    "A run passes if it comes to what is expected of it. Right are errors of at most 1e-6.",
    ERRORS,
)
RANDOM_NOTES = ("Right are errors of the contact force of at most the accuracy.", ERRORS)


def summary(runs: Sequence[Row]) -> str:
    """How many runs came to what they have to."""
    return f"{sum(map(passed, runs))} of {len(runs)} runs pass."


def counts(runs: Sequence[Row]) -> list[list[str]]:
    """Numbers of runs by verdict, and what each means; with a head."""
    numbers = Counter(run["verdict"] for run in runs)
    rows = ([name, str(numbers[Verdict(name)]), text] for name, text in MEANING.items())
    return [["verdict", "runs", "what it means"], *rows]


def counts_by_method(runs: Sequence[Row]) -> list[list[str]]:
    """Numbers of runs by scene, method and verdict, and of those certified; with a head."""
    key = itemgetter("scene", "method")
    rows = [["scene", "method", "runs", *Verdict, "certified", "median iterations"]]
    for names, each in groupby(sorted(runs, key=key), key):
        group = list(each)
        verdicts = Counter(run["verdict"] for run in group)
        certified = sum(run["certified"] for run in group)
        middle = median_high(run["iterations"] for run in group)
        numbers = [len(group), *(verdicts[verdict] for verdict in Verdict), certified, middle]
        rows.append([*names, *map(str, numbers)])
    return rows


def last_lines(runs: Sequence[Row], notes: Sequence[str]) -> list[str]:
    """What a console ends with; what did not pass, with the command that repeats it."""
    lines = ["", summary(runs), aligned(counts(runs)), "", *notes]
    lines += ["", "By scene and method:", aligned(counts_by_method(runs))]
    for run in runs:
        if not passed(run):
            lines += ["", line_of(run, SHOWN), f"      {run['advice']}", f"      {run['command']}"]
    return lines


def write_stability(runs: Sequence[Row], title: str, notes: Sequence[str], folder: Path) -> None:
    """Write `FILES` into an existing folder."""
    short = [column for column in COLUMNS if column not in LONG]
    cells, every = [], [[column.replace("_", " ") for column in short]]
    for row in runs:
        cells.append([row[column] for column in COLUMNS])
        words = " · ".join(str(row[column]) for column in LONG if row[column])
        every += [[text_of(row[column]) for column in short], [escape(words)]]
    write_csv(folder / FILES[0], COLUMNS, cells)
    sections = [
        f"<p><b>{escape(summary(runs))}</b></p>\n{html_table(counts(runs))}\n{bullets(notes)}",
        f"<h2>By scene and method</h2>\n{html_table(counts_by_method(runs))}",
        f"<h2>Every run</h2>\n{html_table(every)}",
    ]
    write_page(folder / FILES[1], title, sections)
