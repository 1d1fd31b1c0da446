"""Rows with a verdict each, as a CSV file and one self-contained HTML page."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

PAGE = """<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Slipfront: {name}</title>
<style>
body {{ font: 15px/1.45 system-ui, sans-serif; max-width: 90rem; margin: 2rem auto;
  padding: 0 1rem; color: #222; background: #fff; }}
table {{ border-collapse: collapse; font-size: 0.85rem; margin-bottom: 2rem; }}
th, td {{ padding: 0.2rem 0.5rem; border-bottom: 1px solid #8884; text-align: left;
  vertical-align: top; }}
td.number {{ text-align: right; font-variant-numeric: tabular-nums; }}
td.verdict {{ border-left: 0.6rem solid; font-weight: 600; }}
td.settings {{ overflow-wrap: anywhere; min-width: 24rem; }}
</style>
<h1>{title}</h1>
<p><b>{summary}</b></p>
<ul>
{notes}
</ul>
{tables}
</html>
"""
BLUE, LIGHT, ORANGE, GREY, RED = "#0072B2", "#56B4E9", "#E69F00", "#999999", "#D55E00"
"""Okabe and Ito's palette, told apart by the colour-blind."""

Values = Mapping[str, object]
"""The entries of a row by column; one column is `verdict`."""


def prepare(folder: Path, name: str) -> tuple[Path, Path]:
    """Make the folder and the two files, so that a long run does not fail at its end.

    Raises
    ------
    OSError
        When that is not possible.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files = folder / f"{name}.csv", folder / f"{name}.html"
    for file in files:
        file.open("a", encoding="utf-8").close()
    return files


def write_rows(file: Path, columns: Sequence[str], rows: Sequence[Values]) -> None:
    """Write rows as CSV.

    Raises
    ------
    OSError
        When the file cannot be written.
    """
    with file.open("w", encoding="utf-8", newline="") as out:
        writer = csv.DictWriter(out, columns)
        writer.writeheader()
        writer.writerows(rows)


def page(
    name: str, title: str, summary: str, notes: Sequence[str], tables: Mapping[str, str]
) -> str:
    """Write the page; `tables` are HTML by heading, and an empty heading is none."""
    parts = [
        f"<h2>{escape(head)}</h2>\n{table}" if head else table for head, table in tables.items()
    ]
    return PAGE.format(
        name=name,
        title=escape(title),
        summary=escape(summary),
        notes="\n".join(f"<li>{escape(note)}</li>" for note in notes),
        tables="\n".join(parts),
    )


def table_of(columns: Sequence[str], rows: Sequence[Values], colours: Mapping[str, str]) -> str:
    """Write rows as an HTML table; `colours` are those of the verdicts."""
    heads = [column.replace("_", " ") for column in columns]
    return plain_table(heads, [_cells(row, colours) for row in rows])


def plain_table(heads: Sequence[str], rows: Sequence[str]) -> str:
    """Write an HTML table of rows that are cells already."""
    head = "".join(f"<th>{escape(text)}</th>" for text in heads)
    body = "\n".join(f"<tr>{row}</tr>" for row in rows)
    return f"<table>\n<tr>{head}</tr>\n{body}\n</table>"


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
