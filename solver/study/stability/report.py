"""Judged runs as lines on a console, a CSV file, and one self-contained HTML page."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from itertools import groupby
from pathlib import Path

from solver.scenes import CATALOGUE
from solver.study.page import aligned, bullets, cell, plain_table, table, write_csv, write_page
from solver.study.stability.case import METHODS, Case, Verdict
from solver.study.stability.outcome import MEANING, JudgedRun
from solver.study.stability.plane_cases import (
    block_cases,
    fault_cases,
    incline_cases,
    layers_cases,
    wall_cases,
)
from solver.study.stability.rod_cases import bar_cases, rope_cases, strand_cases

FILES = "stability.csv", "stability.html"
COLUMNS = (
    *("scene", "group", "case", "method", "expected", "verdict", "passed", "status", "certified"),
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


def cases_of(scenes: Sequence[str] = (), *, quick: bool = False) -> list[Case]:
    """Cases of some scenes, or of all, by each method; with `quick` only the few for a check."""
    rods = [*bar_cases(), *strand_cases(), *rope_cases()]
    plane = [*fault_cases(), *block_cases(), *layers_cases(), *incline_cases(), *wall_cases()]
    return [
        case.by(method)
        for case in rods + plane
        if case.scene in (scenes or CATALOGUE) and (case.quick or not quick)
        for method in METHODS
    ]


def line(run: JudgedRun) -> str:
    """One row of the console's table."""
    case, outcome = run.case, run.outcome
    errors = outcome.estimated_error, outcome.error_displacement, outcome.error_force
    return (
        f"{_passed(run):<5} {run.verdict:<8} {case.scene:<7} {f'{case.group}: {case.name}':<44} "
        f"{case.method:<12} {outcome.ending.split()[0]:<10} "
        f"{'certified' if outcome.certified else '':<9} {outcome.iterations:>5} "
        f"{' '.join(f'{_number(error):>8}' for error in errors)} {outcome.seconds:6.2f} s"
    )


@dataclass(frozen=True)
class StabilityReport:
    """What runs amount to.

    Attributes
    ----------
    runs
        Those that are done.
    title
        Of the page.
    notes
        What passing means, and what the tables do not show.
    """

    runs: Sequence[JudgedRun]
    title: str
    notes: Sequence[str]

    @property
    def passes(self) -> bool:
        """Whether all runs came to what they have to."""
        return all(run.passed for run in self.runs)

    @property
    def summary(self) -> str:
        """How many did."""
        return f"{sum(run.passed for run in self.runs)} of {len(self.runs)} runs pass."

    def counts(self) -> list[list[str]]:
        """Numbers of runs by verdict, and what each means; with a head."""
        numbers = Counter(run.verdict for run in self.runs)
        rows = ([name, str(numbers[Verdict(name)]), text] for name, text in MEANING.items())
        return [["verdict", "runs", "what it means"], *rows]

    def counts_by_method(self) -> list[list[str]]:
        """Numbers of runs by scene, method and verdict, and of those certified; with a head."""

        def kind(run: JudgedRun) -> tuple[str, str]:
            return run.case.scene, run.case.method

        rows = [["scene", "method", "runs", *Verdict, "certified", "median iterations"]]
        for name, group in groupby(sorted(self.runs, key=kind), kind):
            runs = list(group)
            verdicts = Counter(run.verdict for run in runs)
            middle = sorted(run.outcome.iterations for run in runs)[len(runs) // 2]
            certified = sum(run.outcome.certified for run in runs)
            numbers = [len(runs), *(verdicts[verdict] for verdict in Verdict), certified, middle]
            rows.append([*name, *map(str, numbers)])
        return rows

    def lines(self) -> list[str]:
        """What a console ends with; what did not pass, with the command that repeats it."""
        lines = ["", self.summary, aligned(self.counts()), "", *self.notes]
        lines += ["", "By scene and method:", aligned(self.counts_by_method())]
        for run in self.runs:
            if not run.passed:
                more = run.outcome.advice, run.case.command
                lines += ["", line(run), *(f"      {text}" for text in more)]
        return lines

    def write(self, folder: Path) -> tuple[Path, Path]:
        """Write `stability.csv` and `stability.html` into an existing folder.

        Raises
        ------
        OSError
            When a file cannot be written.
        """
        table_file, page = (folder / file for file in FILES)
        rows = [_entries(run) for run in self.runs]
        write_csv(table_file, COLUMNS, (row.values() for row in rows))
        heads = [column.replace("_", " ") for column in COLUMNS if column not in LONG]
        every = table(heads, [html for row in rows for html in _html_rows(row)])
        sections = [
            f"<p><b>{escape(self.summary)}</b></p>\n{plain_table(self.counts())}\n"
            f"{bullets(self.notes)}",
            f"<h2>By scene and method</h2>\n{plain_table(self.counts_by_method())}",
            f"<h2>Every run</h2>\n{every}",
        ]
        write_page(page, self.title, sections)
        return table_file, page


def _entries(run: JudgedRun) -> dict[str, object]:
    """Entries of a row by column."""
    own = {
        **vars(run.case),
        **vars(run.outcome),
        "case": run.case.name,
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
