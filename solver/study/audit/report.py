"""An audit as lines on a console, a CSV file, and one self-contained HTML page."""

from __future__ import annotations

import csv
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path

from solver.disk import check_place, whole_file
from solver.study.audit.audit import MEANING, Audited, Verdict
from solver.study.page import bullets, plain_table, table, write_page
from solver.study.speed.study_report import aligned

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


def line(row: Audited) -> str:
    """Give one row of the console's table."""
    trial, found = row.trial, row.outcome
    errors = found.estimated_error, found.error_displacement, found.error_force
    return (
        f"{_passed(row):<5} {row.verdict:<8} {trial.scene:<7} {trial.title:<44} "
        f"{trial.method:<12} {found.ending.split()[0]:<10} "
        f"{'certified' if found.certified else '':<9} {found.iterations:>5} "
        f"{' '.join(f'{number(error):>8}' for error in errors)} {found.seconds:6.2f} s"
    )


def _passed(row: Audited) -> str:
    return "pass" if row.passed else "FAIL"


def entries(row: Audited, columns: Sequence[str]) -> dict[str, object]:
    """Give the entries of a row by column."""
    ending = str(row.outcome.ending)
    found = {
        **vars(row.trial),
        **vars(row.outcome),
        **row.trial.labels,
        "verdict": str(row.verdict),
        "passed": _passed(row),
        "status": ending,
        "ending": ending,
    }
    return {column: found[column] for column in columns}


def prepare(folder: Path, name: str) -> tuple[Path, Path]:
    """Name the two files, in a folder that is there; a long run must not fail at its end.

    Raises
    ------
    OSError
        When that is not possible.
    """
    files = folder / f"{name}.csv", folder / f"{name}.html"
    for file in files:
        check_place(file)
    return files


@dataclass(frozen=True)
class AuditReport:
    """What runs amount to.

    Attributes
    ----------
    name, title
        Of the files, and of the page.
    columns
        Of the table of all runs.
    rows
        The runs.
    notes
        What passing means, and what the tables do not show.
    tables
        More of them by heading; the first row of each is its head.
    """

    name: str
    title: str
    columns: Sequence[str]
    rows: Sequence[Audited]
    notes: Sequence[str]
    tables: Mapping[str, Sequence[list[str]]] = field(default_factory=dict)

    @property
    def passes(self) -> bool:
        """Whether all runs came to what they have to."""
        return all(row.passed for row in self.rows)

    @property
    def summary(self) -> str:
        """How many did."""
        return f"{sum(row.passed for row in self.rows)} of {len(self.rows)} runs pass."

    def counts(self) -> list[list[str]]:
        """Count the verdicts, and say what each means; with a head."""
        found = Counter(row.verdict for row in self.rows)
        counts = ([one, str(found[Verdict(one)]), meaning] for one, meaning in MEANING.items())
        return [["verdict", "runs", "what it means"], *counts]

    def counts_by_method(self) -> list[list[str]]:
        """Count the verdicts by scene and method, and how many were certified; with a head."""
        found = [["scene", "method", "runs", *Verdict, "certified", "median iterations"]]
        names = [(row.trial.scene, row.trial.method) for row in self.rows]
        for name in sorted(set(names)):
            own = [row for row, other in zip(self.rows, names, strict=True) if other == name]
            counts = Counter(row.verdict for row in own)
            middle = sorted(row.outcome.iterations for row in own)[len(own) // 2]
            certified = sum(row.outcome.certified for row in own)
            numbers = [len(own), *(counts[verdict] for verdict in Verdict), certified, middle]
            found.append([*name, *map(str, numbers)])
        return found

    def _entries(self) -> list[dict[str, object]]:
        return [entries(row, self.columns) for row in self.rows]

    def _tables(self) -> dict[str, Sequence[list[str]]]:
        return {**self.tables, "By scene and method": self.counts_by_method()}

    def lines(self) -> list[str]:
        """Give what a console ends with; what did not pass, with the commands that repeat it."""
        found = ["", self.summary, aligned(self.counts()), "", *self.notes]
        for heading, rows in self._tables().items():
            found += ["", f"{heading}:", aligned(rows)]
        for row in self.rows:
            if not row.passed:
                said = row.outcome.advice, *row.trial.again
                found += ["", line(row), *(f"      {one}" for one in said)]
        return found

    def sections(self) -> list[str]:
        """Write it (HTML)."""
        heads = [column.replace("_", " ") for column in self.columns if column not in LONG]
        rows = [row for one in self._entries() for row in _rows(one)]
        return [
            f"<p><b>{escape(self.summary)}</b></p>\n{plain_table(self.counts())}\n"
            f"{bullets(self.notes)}",
            *(f"<h2>{name}</h2>\n{plain_table(rows)}" for name, rows in self._tables().items()),
            f"<h2>Every run</h2>\n{table(heads, rows)}",
        ]

    def write(self, folder: Path) -> list[Path]:
        """Write a CSV file and a page, and give them.

        Parameters
        ----------
        folder
            An existing folder; files of these names are replaced.

        Raises
        ------
        OSError
            When a file cannot be written.
        """
        table_file, page_file = prepare(folder, self.name)
        with whole_file(table_file) as out:
            writer = csv.DictWriter(out, self.columns)
            writer.writeheader()
            writer.writerows(self._entries())
        write_page(page_file, self.title, self.sections())
        return [table_file, page_file]


def _rows(entries: Mapping[str, object]) -> list[str]:
    """Give the cells of a run (HTML), and in a row below, as wide as all, what is said of it."""
    short = {column: value for column, value in entries.items() if column not in LONG}
    said = (f"{begin}{entries[one]}" for one, begin in LONG.items() if entries.get(one))
    words = escape(" · ".join(said))
    more = [f'<td class="more" colspan="{len(short)}">{words}</td>'] if words else []
    return [_cells(short), *more]


def _cells(row: Mapping[str, object]) -> str:
    cells = []
    for column, value in row.items():
        if column == "verdict":
            colour = COLOURS[str(value)]
            cells.append(
                f'<td class="verdict {value}" style="border-left-color: {colour}">{value}</td>'
            )
        elif isinstance(value, float):
            text = number(value, ".2f" if column == "seconds" else ".1e")
            cells.append(f'<td class="number">{text}</td>')
        elif isinstance(value, bool):
            cells.append(f"<td>{'yes' if value else 'no'}</td>")
        elif isinstance(value, int):
            cells.append(f'<td class="number">{value}</td>')
        else:
            cells.append(f"<td>{escape(str(value))}</td>")
    return "".join(cells)


def number(value: float, digits: str = ".1e") -> str:
    """Write a number, or a dash where there is none."""
    return "-" if math.isnan(value) else f"{value:{digits}}"
