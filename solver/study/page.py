"""A report: sections of words, tables and charts, and the one HTML page that a command makes of it.

Words and tables are HTML. Charts are drawn by an entry point of the group `slipfront.renderers`, as
the engine has none.
"""

from __future__ import annotations

import contextlib
import csv
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from importlib.metadata import entry_points
from pathlib import Path
from string import Template

from solver.disk import whole_file, write
from solver.study.chart import Chart

GROUP = "slipfront.renderers"
NO_CHARTS = "The page has no charts, as nothing that draws them is installed: pip install slipfront"


@dataclass(frozen=True, eq=False)
class PlotSection:
    """Charts side by side, and a heading for those who cannot see them."""

    heading: str
    charts: Sequence[Chart]


Section = str | PlotSection
"""Words and tables are HTML."""
Renderer = Callable[[Sequence[PlotSection]], tuple[str, Sequence[str]]]
"""From sections, what all charts of a page need, once, and each of them as HTML of its own."""
Shown = Mapping[str, tuple[str, int]]
"""Columns of a console: head and characters by name."""
NUMBER = re.compile(r"-|-?\d[\d.e+-]*")
VERDICTS = "right", "holds", "unsolved", "refused", "unclear", "wrong", "FAILS"
PAGE = Template(Path(__file__).with_name("page.html").read_text(encoding="utf-8"))


def write_page(file: Path, title: str, report: Sequence[Section]) -> str:
    """Write a report as a page that needs nothing beside it.

    Returns
    -------
    What whoever asked for it is to be told; nothing where it has all of its charts.

    Raises
    ------
    OSError
        When the file cannot be written.
    """
    plots = [part for part in report if isinstance(part, PlotSection)]
    render = renderer() if plots else None
    head, drawn = render(plots) if render else ("", [""] * len(plots))
    note = NO_CHARTS if plots and render is None else ""
    places = iter(drawn)
    parts = [part if isinstance(part, str) else next(places) for part in report]
    body = "\n".join([f"<p>{escape(note)}</p>" * bool(note), *parts])
    write(file, PAGE.substitute(title=escape(title), head=head, body=body))
    return note


def renderer() -> Renderer | None:
    """What draws charts, if anything that does is installed."""
    for found in entry_points(group=GROUP):
        with contextlib.suppress(ImportError):  # the engine may be there alone
            render: Renderer = found.load()
            return render
    return None


def bullets(lines: Sequence[str]) -> str:
    """Sentences as a list."""
    return "<ul>\n" + "\n".join(f"<li>{escape(line)}</li>" for line in lines) + "\n</ul>"


def html_table(rows: Iterable[Sequence[str]]) -> str:
    """A table of texts, whose first row is its head; a row of one entry is HTML, as wide as all."""
    head, *rest = rows
    lines = ["".join(f"<th>{escape(text)}</th>" for text in head)]
    for row in rest:
        wide = f'<td class="more" colspan="{len(head)}">{row[0]}</td>'
        lines.append(wide if len(row) == 1 < len(head) else "".join(map(_cell, row)))
    return "<table>\n{}\n</table>".format("\n".join(f"<tr>{line}</tr>" for line in lines))


def _cell(text: str) -> str:
    kind = "number" if NUMBER.fullmatch(text) else f"verdict {text}" if text in VERDICTS else ""
    return f'<td class="{kind}">{escape(text)}</td>' if kind else f"<td>{escape(text)}</td>"


def text_of(value: object, digits: int = 2) -> str:
    """A value as tables show it."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if not isinstance(value, float):
        return str(value)
    return "-" if math.isnan(value) else "never" if math.isinf(value) else f"{value:.{digits}g}"


def line_of(entries: Mapping[str, object], shown: Shown) -> str:
    """Entries of a row as a line of a console."""
    texts = (f"{text_of(entries[name]):<{width}}" for name, (_, width) in shown.items())
    return " ".join(texts).rstrip()


def head_of(shown: Shown) -> str:
    """Heads of these columns."""
    return line_of({name: head for name, (head, _) in shown.items()}, shown)


def write_csv(file: Path, head: Sequence[str], rows: Iterable[Iterable[object]]) -> Path:
    """Write a table as CSV; its place.

    Raises
    ------
    OSError
        When the file cannot be written.
    """
    with whole_file(file) as open_file:
        csv.writer(open_file).writerows([head, *rows])
    return file


def aligned(rows: Sequence[Sequence[str]]) -> str:
    """A table in columns for a console."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    )
