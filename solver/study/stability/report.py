"""Judged runs as lines on a console, a CSV file, and one self-contained HTML page."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from solver.latin import Ending
from solver.scenes import CATALOGUE
from solver.study.page import aligned, bullets, plain_table, table, write_csv, write_page
from solver.study.stability.case import Verdict
from solver.study.stability.draws import is_foolish
from solver.study.stability.verdict import MEANING, JudgedRun

FILES = "stability.csv", "stability.html"
COLUMNS = (
    *("scene", "group", "case", "method", "expected", "verdict", "passed", "status", "certified"),
    *("iterations", "estimated_error", "error_displacement", "error_force", "residual"),
    *("indicator", "behaviour", "condition_structure", "condition_substructure", "seconds"),
    *("doubt", "advice", "settings"),
)
COLOURS: dict[str, str] = {
    Verdict.RIGHT: "#0072B2",
    Verdict.UNSOLVED: "#E69F00",
    Verdict.REFUSED: "#56B4E9",
    Verdict.UNCLEAR: "#999999",
    Verdict.WRONG: "#D55E00",
}
"""Of Okabe and Ito's palette, told apart by the colour-blind."""
LONG = {"expected": "Expected: ", "doubt": "", "advice": "", "settings": ""}
"""Columns of words, and how these begin: beside numbers there is no room for them on a screen."""
HEAD = (
    f"{'':<5} {'':<8} {'scene':<7} {'run':<44} {'method':<12} {'status':<10} {'':<9} {'iter.':>5} "
    f"{'estimate':>8} {'error W':>8} {'error F':>8}"
)
TITLE = "Stability on stiff and extreme cases"
NOTES = (
    "A run passes if it comes to what is expected of it. Right are errors of at most 1e-6.",
    "Errors: distance to the reference solution over space and time, as a share of it; where it is "
    "zero, as a share of the load, or in m and N.",
    "Condition numbers: of the stiffness of the whole structure with its supports but without "
    "contact (structure, K; infinite where contact alone holds a body), and the largest of what a "
    "substructure solves in an iteration (substructure, E).",
)
RANDOM_TITLE = "Stability on random runs"
RANDOM_NOTES = ("Right are errors of the contact force of at most the accuracy.", NOTES[1])
ENDS, ITERATES = "may end with a status step", "only iterate"
MISSED = "Not converged, of runs that have one solution and a k that is not foolish"


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


def entries(run: JudgedRun) -> dict[str, object]:
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
        by_method: dict[tuple[str, str], list[JudgedRun]] = {}
        for run in self.runs:
            by_method.setdefault((run.case.scene, run.case.method), []).append(run)
        rows = [["scene", "method", "runs", *Verdict, "certified", "median iterations"]]
        for name, runs in sorted(by_method.items()):
            verdicts = Counter(run.verdict for run in runs)
            middle = sorted(run.outcome.iterations for run in runs)[len(runs) // 2]
            certified = sum(run.outcome.certified for run in runs)
            numbers = [len(runs), *(verdicts[one] for one in Verdict), certified, middle]
            rows.append([*name, *map(str, numbers)])
        return rows

    def tables(self) -> dict[str, list[list[str]]]:
        """Tables beside that of all runs, by heading."""
        missed = {MISSED: missed_table(self.runs)} if self.title == RANDOM_TITLE else {}
        return {**missed, "By scene and method": self.counts_by_method()}

    def lines(self) -> list[str]:
        """What a console ends with; what did not pass, with the command that repeats it."""
        lines = ["", self.summary, aligned(self.counts()), "", *self.notes]
        for heading, rows in self.tables().items():
            lines += ["", f"{heading}:", aligned(rows)]
        for run in self.runs:
            if not run.passed:
                more = run.outcome.advice, run.case.command
                lines += ["", line(run), *(f"      {text}" for text in more)]
        return lines

    def write(self, folder: Path) -> tuple[Path, Path]:
        """Write `stability.csv` and `stability.html`.

        Parameters
        ----------
        folder
            An existing folder; files of these names are replaced.

        Raises
        ------
        OSError
            When a file cannot be written.
        """
        table_file, page = (folder / file for file in FILES)
        rows = [entries(run) for run in self.runs]
        write_csv(table_file, COLUMNS, (row.values() for row in rows))
        heads = [column.replace("_", " ") for column in COLUMNS if column not in LONG]
        every = table(heads, [html for row in rows for html in _html_rows(row)])
        sections = [
            f"<p><b>{escape(self.summary)}</b></p>\n{plain_table(self.counts())}\n"
            f"{bullets(self.notes)}",
            *(f"<h2>{name}</h2>\n{plain_table(rows)}" for name, rows in self.tables().items()),
            f"<h2>Every run</h2>\n{every}",
        ]
        write_page(page, self.title, sections)
        return table_file, page


def missed_table(runs: Sequence[JudgedRun]) -> list[list[str]]:
    """Numbers of random runs that could converge and did not; with a head."""
    kinds: dict[str, list[JudgedRun]] = {ENDS: [], ITERATES: []}
    for run in runs:
        settings = CATALOGUE[run.case.scene].settings.checked(run.case.values)
        if not (run.verdict is Verdict.REFUSED or run.outcome.doubt or is_foolish(settings)):
            kinds[ITERATES if settings.finish == "none" else ENDS].append(run)
    rows = [["runs that", "in all", "not converged", "share", "of these out of iterations"]]
    for kind, own in {**kinds, "all": [*kinds[ENDS], *kinds[ITERATES]]}.items():
        missed = [run.outcome.ending for run in own if run.outcome.ending != Ending.CONVERGED]
        share = f"{100.0 * len(missed) / len(own):.1f} %" if own else "-"
        exhausted = missed.count(Ending.EXHAUSTED)
        rows.append([kind, str(len(own)), str(len(missed)), share, str(exhausted)])
    return rows


def _passed(run: JudgedRun) -> str:
    return "pass" if run.passed else "FAIL"


def _html_rows(row: Mapping[str, object]) -> Iterator[str]:
    """Cells of a run, and in a row below, as wide as all, its columns of words."""
    short = {column: value for column, value in row.items() if column not in LONG}
    yield "".join(_cell(column, value) for column, value in short.items())
    words = escape(" · ".join(f"{start}{row[one]}" for one, start in LONG.items() if row[one]))
    yield f'<td class="more" colspan="{len(short)}">{words}</td>'


def _cell(column: str, value: object) -> str:
    if column == "verdict":
        colour = COLOURS[str(value)]
        return f'<td class="verdict {value}" style="border-left-color: {colour}">{value}</td>'
    if isinstance(value, bool):
        return f"<td>{'yes' if value else 'no'}</td>"
    if isinstance(value, float):
        text = _number(value, ".2f" if column == "seconds" else ".1e")
        return f'<td class="number">{text}</td>'
    kind = ' class="number"' if isinstance(value, int) else ""
    return f"<td{kind}>{escape(str(value))}</td>"


def _number(value: float, digits: str = ".1e") -> str:
    """A number, or a dash where there is none."""
    return "-" if math.isnan(value) else f"{value:{digits}}"
