"""A report: sections of words, tables and charts, and the one HTML page that a command makes of it.

Words and tables are HTML. A chart is plain data: curves on a pair of axes, or a map
over two. It is drawn by an entry point of the group `slipfront.renderers`, as the
engine has none.
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
from typing import Literal

from solver.arrays import Array, Flags, Indices
from solver.files.disk import whole_file, write

GROUP = "slipfront.renderers"
NO_CHARTS = "The page has no charts, as nothing that draws them is installed: pip install slipfront"
HUES = (
    *("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#D55E00", "#56B4E9"),
    *("#7B5CE0", "#999933", "#8C564B", "#B3003C", "#1F9AA0"),
)
"""Of curves, from hue 1 on: Okabe and Ito's palette, told apart by the colour-blind,
and five more for panels of more curves, which have marks besides."""
Line = Literal["solid", "dashed", "dotted", "points"]


@dataclass(frozen=True, eq=False)
class PanelAxis:
    """A quantity, its unit (empty for a pure number), and whether decades are evenly spaced.

    Without limits all of the curves is shown. On a whole one only whole numbers have a
    meaning; names stand at 0, 1, ... where these are no numbers.
    """

    quantity: str
    unit: str = ""
    logarithmic: bool = False
    limits: tuple[float, float] | None = None
    whole: bool = False
    names: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """Quantity and unit."""
        if self.unit:
            return f"{self.quantity} ({self.unit})"
        return self.quantity


@dataclass(frozen=True, eq=False)
class PanelCurve:
    """One line of a panel: points, shape (n,), in the units of the axes; none is drawn at NaN.

    Curves of one hue belong together; 0 is the neutral one, of references. A curve
    without a label is not in the legend, and one of "points" has a thin line between
    them.
    """

    label: str
    x: Array
    y: Array
    hue: int
    line: Line = "solid"


@dataclass(frozen=True, eq=False)
class Runs:
    """Points of a chart that each stand for a run, n of them in the order in which they came.

    Each belongs to the curve of its hue; in a panel y is NaN where a run has no value.
    `holds` is whether it is an answer, and `said` what it is and came to, in words.
    """

    numbers: Indices
    x: Array
    y: Array
    hues: Indices
    holds: Flags
    said: Sequence[str]


@dataclass(frozen=True, eq=False)
class Panel:
    """One pair of axes with its curves, and the runs that these go through, if they do."""

    title: str
    x: PanelAxis
    y: PanelAxis
    curves: tuple[PanelCurve, ...]
    runs: Runs | None = None


@dataclass(frozen=True, eq=False)
class Map:
    """A quantity over two settings, whose values ascend.

    Its values z have shape (len(y_values), len(x_values)), NaN where there is none.
    """

    title: str
    x: PanelAxis
    y: PanelAxis
    x_values: Array
    y_values: Array
    scale: PanelAxis
    z: Array
    runs: Runs


Chart = Panel | Map


@dataclass(frozen=True, eq=False)
class PlotSection:
    """Charts side by side, and a heading for those who cannot see them."""

    heading: str
    charts: Sequence[Chart]


Section = str | PlotSection
"""Words and tables are HTML."""
Renderer = Callable[[Sequence[PlotSection]], tuple[str, Sequence[str]]]
"""From sections, what all charts of a page need, once, and each of them as HTML of its
own."""
Shown = Mapping[str, tuple[str, int]]
"""Columns of a console: head and characters by name."""
NUMBER = re.compile(r"-|-?\d[\d.e+-]*")
VERDICTS = "right", "holds", "unsolved", "refused", "unclear", "wrong", "FAILS"
PAGE = Template(Path(__file__).with_name("page.html").read_text(encoding="utf-8"))


def write_page(file: Path, title: str, report: Sequence[Section]) -> None:
    """Write a report as a page that needs nothing beside it."""
    plots = [part for part in report if isinstance(part, PlotSection)]
    if plots:
        render = renderer()
    else:
        render = None
    missing = f"<p>{escape(NO_CHARTS)}</p>"
    if render:
        head, drawn = render(plots)
    else:
        head = ""
        drawn = [missing] * len(plots)
    places = iter(drawn)
    body = "\n".join(part if isinstance(part, str) else next(places) for part in report)
    write(file, PAGE.substitute(title=escape(title), head=head, body=body))


def renderer() -> Renderer | None:
    """What draws charts, if anything that does is installed."""
    for found in entry_points(group=GROUP):
        with contextlib.suppress(ImportError):  # the engine may be there alone
            render: Renderer = found.load()
            return render
    return None


def bullets(lines: Sequence[str]) -> str:
    """Sentences as a list."""
    return (
        "<ul>\n" + "\n".join(f"<li>{escape(line)}</li>" for line in lines) + "\n</ul>"
    )


def html_table(rows: Iterable[Sequence[str]]) -> str:
    """A table of texts, whose first row is its head; a row of one entry is HTML, as wide as all."""
    head, *rest = rows
    lines = ["".join(f"<th>{escape(text)}</th>" for text in head)]
    for row in rest:
        wide = f'<td class="more" colspan="{len(head)}">{row[0]}</td>'
        lines.append(wide if len(row) == 1 < len(head) else "".join(map(_cell, row)))
    return "<table>\n{}\n</table>".format(
        "\n".join(f"<tr>{line}</tr>" for line in lines)
    )


def _cell(text: str) -> str:
    if NUMBER.fullmatch(text):
        kind = "number"
    elif text in VERDICTS:
        kind = f"verdict {text}"
    else:
        kind = ""
    if kind:
        return f'<td class="{kind}">{escape(text)}</td>'
    return f"<td>{escape(text)}</td>"


def text_of(value: object, digits: int = 2) -> str:
    """A value as tables show it."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if not isinstance(value, float):
        return str(value)
    if math.isnan(value):
        return "-"
    if math.isinf(value):
        return "never"
    return f"{value:.{digits}g}"


def line_of(entries: Mapping[str, object], shown: Shown) -> str:
    """Entries of a row as a line of a console."""
    texts = (f"{text_of(entries[name]):<{width}}" for name, (_, width) in shown.items())
    return " ".join(texts).rstrip()


def head_of(shown: Shown) -> str:
    """Heads of these columns."""
    return line_of({name: head for name, (head, _) in shown.items()}, shown)


def write_csv(
    file: Path, head: Sequence[str], rows: Iterable[Iterable[object]]
) -> None:
    """Write a table as CSV."""
    with whole_file(file) as open_file:
        csv.writer(open_file).writerows([head, *rows])


def aligned(rows: Sequence[Sequence[str]]) -> str:
    """A table in columns for a console."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(
            cell.ljust(width) for cell, width in zip(row, widths, strict=True)
        ).rstrip()
        for row in rows
    )
