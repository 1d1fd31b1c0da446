"""Report of a command: words, tables and charts, as one HTML page.

Each report has a template beside this file, which extends `page.html` and takes lists
and tables from `parts.html`. A chart is plain data: curves on a pair of axes, or a map
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
from importlib.metadata import entry_points
from pathlib import Path
from typing import Literal

from solver.arrays import Array, Flags, Indices
from solver.files.disk import whole_file, write

GROUP = "slipfront.renderers"
NO_CHARTS = (
    "The page has no charts, as nothing that draws them is installed: "
    "pip install slipfront"
)
HUES = (
    "#0072B2",
    "#E69F00",
    "#009E73",
    "#CC79A7",
    "#D55E00",
    "#56B4E9",
    "#7B5CE0",
    "#999933",
    "#8C564B",
    "#B3003C",
    "#1F9AA0",
)
"""Colours of curves, from hue 1 on.

The first six are Okabe and Ito's palette, which the colour-blind tell apart; the others
are for panels of more curves, which have marks besides."""
Line = Literal["solid", "dashed", "dotted", "points"]


@dataclass(frozen=True, eq=False)
class PanelAxis:
    """Axis of a chart.

    Attributes
    ----------
    quantity, unit
        Quantity on the axis, and its unit, empty for a pure number.
    logarithmic
        Whether decades are evenly spaced.
    limits
        Ends of the axis; without them all curves are shown whole.
    whole
        Whether only whole numbers have a meaning.
    names
        Names that stand at 0, 1, ... in place of numbers.
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
    """Curve of a panel.

    Attributes
    ----------
    label
        Label in the legend; without it the curve is not in the legend.
    x, y
        Points, shape (n,), in the units of the axes; no point is drawn at NaN.
    hue
        Number of the colour; curves of one hue belong together, and 0 is the neutral
        one, of references.
    line
        Style; "points" have a thin line between them.
    """

    label: str
    x: Array
    y: Array
    hue: int
    line: Line = "solid"


@dataclass(frozen=True, eq=False)
class Runs:
    """Points of a chart, one for each of n runs, in order of arrival.

    Attributes
    ----------
    x, y
        Points, shape (n,), in the units of the axes; in a panel y is NaN where a run
        has no value.
    hues
        Hues of the curves that the points belong to, shape (n,).
    holds
        Whether the value of a run is an answer, shape (n,).
    said
        Settings and result of each run, in words.
    """

    x: Array
    y: Array
    hues: Indices
    holds: Flags
    said: Sequence[str]


@dataclass(frozen=True, eq=False)
class Panel:
    """A chart with curves, and the runs that the curves connect, if any."""

    title: str
    x: PanelAxis
    y: PanelAxis
    curves: tuple[PanelCurve, ...]
    runs: Runs | None = None


@dataclass(frozen=True, eq=False)
class Map:
    """Map of a quantity over two settings.

    Attributes
    ----------
    title, x, y, scale
        Title, axes of the settings, and axis of the quantity.
    x_values, y_values
        Values of the settings, ascending, shape (n_x,) and (n_y,).
    z
        Values of the quantity, shape (n_y, n_x), NaN where there is none.
    runs
        Runs of the map.
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
    """Charts side by side, with a heading for screen readers."""

    heading: str
    charts: Sequence[Chart]


Renderer = Callable[[Sequence[PlotSection]], tuple[str, Sequence[str]]]
"""Function that draws sections: HTML for the head of a page, and of each section."""
Shown = Mapping[str, tuple[str, int]]
"""Columns on a console: head and number of characters by name."""
NUMBER = re.compile(r"-|-?\d[\d.e+-]*")
VERDICTS = (
    "right",
    "holds",
    "unsolved",
    "refused",
    "unclear",
    "wrong",
    "FAILS",
)
"""Texts of cells that have a colour."""


def write_page(
    file: Path, template: str, plots: Sequence[PlotSection], **values: object
) -> None:
    """Write a report as a self-contained page.

    Parameters
    ----------
    file
        File of the page.
    template
        Name of the report's template.
    plots
        Sections of charts: the template finds them drawn, in this order, as `charts`.
    values
        Further values of the template, among them the `title` of the page.
    """
    # Not above: jinja2 takes a tenth of a second, which most commands do without.
    from solver.files.templates import templates_in

    templates = templates_in(Path(__file__).parent)
    templates.filters["kind"] = kind_of
    head = ""
    charts: Sequence[str] = []
    render = None
    if plots:
        render = renderer()
    if render is not None:
        head, charts = render(plots)
    page = templates.get_template(template)
    write(file, page.render(values, head=head, charts=charts, no_charts=NO_CHARTS))


def renderer() -> Renderer | None:
    """Renderer of charts, if one is installed."""
    for found in entry_points(group=GROUP):
        with contextlib.suppress(ImportError):  # the engine may be installed alone
            render: Renderer = found.load()
            return render
    return None


def kind_of(text: str) -> str:
    """CSS classes of a table's cell by its text: of numbers, of verdicts, or none."""
    if NUMBER.fullmatch(text):
        return "number"
    if text in VERDICTS:
        return f"verdict {text}"
    return ""


def text_of(value: object, digits: int = 2) -> str:
    """Text of a value in tables."""
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
    """Line of a console for the entries of a row."""
    texts = []
    for name, (_, width) in shown.items():
        texts.append(f"{text_of(entries[name]):<{width}}")
    return " ".join(texts).rstrip()


def head_of(shown: Shown) -> str:
    """Line of a console for the heads of columns."""
    return line_of({name: head for name, (head, _) in shown.items()}, shown)


def entries_of(line: str, shown: Shown) -> dict[str, str]:
    """Texts of the entries of a row by name, from its line of a console."""
    entries = {}
    begin = 0
    for name, (_, width) in shown.items():
        entries[name] = line[begin : begin + width].strip()
        begin += width + 1
    return entries


def write_csv(
    file: Path, head: Sequence[str], rows: Iterable[Iterable[object]]
) -> None:
    """Write a table as CSV."""
    with whole_file(file) as open_file:
        csv.writer(open_file).writerows([head, *rows])


def aligned(rows: Sequence[Sequence[str]]) -> str:
    """Lines of a table with aligned columns for a console."""
    widths = []
    for column in zip(*rows, strict=True):
        widths.append(max(len(cell) for cell in column))
    lines = []
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=True)]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)
