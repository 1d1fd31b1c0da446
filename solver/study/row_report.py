"""Rows with a verdict each, as a CSV file and one self-contained HTML page."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

from solver.disk import check_place, whole_file
from solver.study.page import bullets, plain_table, table

BLUE, LIGHT, ORANGE, GREY, RED = "#0072B2", "#56B4E9", "#E69F00", "#999999", "#D55E00"
"""Okabe and Ito's palette, told apart by the colour-blind."""

Values = Mapping[str, object]
"""The entries of a row by column; one column is `verdict`."""


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


def write_rows(file: Path, columns: Sequence[str], rows: Sequence[Values]) -> None:
    """Write rows as CSV.

    Raises
    ------
    OSError
        When the file cannot be written.
    """
    with whole_file(file) as out:
        writer = csv.DictWriter(out, columns)
        writer.writeheader()
        writer.writerows(rows)


def tally(verdicts: Sequence[str], meanings: Mapping[str, str]) -> list[list[str]]:
    """Count the verdicts, and say what each means; with a head."""
    counts = ([one, str(verdicts.count(one)), meaning] for one, meaning in meanings.items())
    return [["verdict", "runs", "what it means"], *counts]


def words(summary: str, counts: Sequence[Sequence[str]], notes: Sequence[str] = ()) -> str:
    """Write what stands above the rows (HTML)."""
    listed = f"\n{bullets(notes)}" if notes else ""
    return f"<p><b>{escape(summary)}</b></p>\n{plain_table(counts)}{listed}"


def table_of(columns: Sequence[str], rows: Sequence[Values], colours: Mapping[str, str]) -> str:
    """Write rows as an HTML table; `colours` are those of the verdicts."""
    heads = [column.replace("_", " ") for column in columns]
    return table(heads, [_cells(row, colours) for row in rows])


def _cells(row: Values, colours: Mapping[str, str]) -> str:
    cells = []
    for column, value in row.items():
        if column == "verdict":
            colour = colours[str(value)]
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
            kind = ' class="settings"' if column in ("settings", "advice") else ""
            cells.append(f"<td{kind}>{escape(str(value))}</td>")
    return "".join(cells)


def number(value: float, digits: str = ".1e") -> str:
    """Write a number, or a dash where there is none."""
    return "-" if math.isnan(value) else f"{value:{digits}}"
