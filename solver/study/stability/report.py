"""Judged runs as lines on a console, a CSV file, and one self-contained HTML page."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from pathlib import Path
from statistics import median_high

from solver.scenes import CATALOGUE
from solver.study.page import aligned, bullets, cell, plain_table, table, write_csv, write_page
from solver.study.stability.outcome import MEANING, JudgedRun
from solver.study.stability.plane_cases import plane_cases
from solver.study.stability.rod_cases import rod_cases
from solver.study.stability.stability_case import METHODS, StabilityCase, Verdict

FILES = "stability.csv", "stability.html"
COLUMNS = (
    *("scene", "case", "method", "expected", "verdict", "passed", "status", "certified"),
    *("iterations", "estimated_error", "error_displacement", "error_force", "residual"),
    *("indicator", "behaviour", "seconds", "doubt", "advice", "settings"),
)
LONG = {"expected": "Expected: ", "doubt": "", "advice": "", "settings": ""}
"""Columns of words, and how these begin: beside numbers there is no room for them on a screen."""
HEAD = (
    f"{'':<5} {'':<8} {'scene':<7} {'run':<44} {'method':<12} {'status':<10} {'':<9} {'iter.':>5} "
    f"{'estimate':>8} {'error W':>8} {'error F':>8}"
)
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


def cases_of(scenes: Sequence[str] = (), *, quick: bool = False) -> list[StabilityCase]:
    """Cases of some scenes, or of all, by each method; with `quick` only the few for a check."""
    return [
        case.by(method)
        for case in [*rod_cases(), *plane_cases()]
        if case.scene in (scenes or CATALOGUE) and (case.quick or not quick)
        for method in METHODS
    ]


def line(run: JudgedRun) -> str:
    """One row of the console's table."""
    case, outcome = run.case, run.outcome
    errors = outcome.estimated_error, outcome.error_displacement, outcome.error_force
    return (
        f"{_passed(run):<5} {run.verdict:<8} {case.scene:<7} {case.title:<44} "
        f"{case.method:<12} {outcome.ending.split()[0]:<10} "
        f"{'certified' if outcome.certified else '':<9} {outcome.iterations:>5} "
        f"{' '.join(f'{_number(error):>8}' for error in errors)} {outcome.seconds:6.2f} s"
    )


def summary(runs: Sequence[JudgedRun]) -> str:
    """How many runs came to what they have to."""
    return f"{sum(run.passed for run in runs)} of {len(runs)} runs pass."


def counts(runs: Sequence[JudgedRun]) -> list[list[str]]:
    """Numbers of runs by verdict, and what each means; with a head."""
    numbers = Counter(run.verdict for run in runs)
    rows = ([name, str(numbers[Verdict(name)]), text] for name, text in MEANING.items())
    return [["verdict", "runs", "what it means"], *rows]


def counts_by_method(runs: Sequence[JudgedRun]) -> list[list[str]]:
    """Numbers of runs by scene, method and verdict, and of those certified; with a head."""
    rows = [["scene", "method", "runs", *Verdict, "certified", "median iterations"]]
    groups: dict[tuple[str, str], list[JudgedRun]] = {}
    for run in runs:
        groups.setdefault((run.case.scene, run.case.method), []).append(run)
    for name, group in sorted(groups.items()):
        verdicts = Counter(run.verdict for run in group)
        certified = sum(run.outcome.certified for run in group)
        middle = median_high(run.outcome.iterations for run in group)
        numbers = [len(group), *(verdicts[verdict] for verdict in Verdict), certified, middle]
        rows.append([*name, *map(str, numbers)])
    return rows


def last_lines(runs: Sequence[JudgedRun], notes: Sequence[str]) -> list[str]:
    """What a console ends with; what did not pass, with the command that repeats it."""
    lines = ["", summary(runs), aligned(counts(runs)), "", *notes]
    lines += ["", "By scene and method:", aligned(counts_by_method(runs))]
    for run in runs:
        if not run.passed:
            lines += ["", line(run), f"      {run.outcome.advice}", f"      {run.case.command}"]
    return lines


def write_stability(
    runs: Sequence[JudgedRun], title: str, notes: Sequence[str], folder: Path
) -> None:
    """Write `FILES` into an existing folder.

    Raises
    ------
    OSError
        When a file cannot be written.
    """
    rows = [_entries(run) for run in runs]
    write_csv(folder / FILES[0], COLUMNS, (row.values() for row in rows))
    heads = [column.replace("_", " ") for column in COLUMNS if column not in LONG]
    every = table(heads, [html for row in rows for html in _html_rows(row)])
    sections = [
        f"<p><b>{escape(summary(runs))}</b></p>\n{plain_table(counts(runs))}\n{bullets(notes)}",
        f"<h2>By scene and method</h2>\n{plain_table(counts_by_method(runs))}",
        f"<h2>Every run</h2>\n{every}",
    ]
    write_page(folder / FILES[1], title, sections)


def _entries(run: JudgedRun) -> dict[str, object]:
    """Entries of a row by column."""
    own = {
        **vars(run.case),
        **vars(run.outcome),
        "case": run.case.title,
        "verdict": str(run.verdict),
        "passed": _passed(run),
        "status": str(run.outcome.ending),
        "settings": json.dumps(run.case.values),
    }
    return {column: own[column] for column in COLUMNS}


def _passed(run: JudgedRun) -> str:
    return "pass" if run.passed else "FAIL"


def _html_rows(row: Mapping[str, object]) -> Iterator[str]:
    """Cells of a run, and in a row below, as wide as all, its columns of words."""
    short = {column: value for column, value in row.items() if column not in LONG}
    yield "".join(_cell(column, value) for column, value in short.items())
    words = escape(" · ".join(f"{start}{row[name]}" for name, start in LONG.items() if row[name]))
    yield f'<td class="more" colspan="{len(short)}">{words}</td>'


def _cell(column: str, value: object) -> str:
    if column == "verdict":
        return cell(str(value), f"verdict {value}")
    if isinstance(value, bool):
        return cell("yes" if value else "no")
    if isinstance(value, float):
        return cell(_number(value, ".2f" if column == "seconds" else ".1e"), "number")
    return cell(str(value), "number" if isinstance(value, int) else "")


def _number(value: float, digits: str = ".1e") -> str:
    """A number, or a dash where there is none."""
    return "-" if math.isnan(value) else f"{value:{digits}}"
