"""The flag of a case: the mark of its known number in a plot, and the name beside it.

Of the places beside the mark the name has one off the curves. All positions are px from
the lower left corner of the plot.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from bokeh.models import Line, MultiLine, Range1d, VBar
from bokeh.plotting import figure

from app.frame import Frame
from app.views.colors import FLAG, PAPER
from app.views.type_size import LETTER, ROW
from app.views.view import HEIGHT, WIDTH, View
from app.views.words import LEFT_OF
from solver.arrays import Array
from solver.study.trade_case import PlotFlag

GAP = 9.0
"""Distance of a name from its mark, px."""
ROWS = 3
"""Number of rows above a mark, and of those below it, in which its name may stand."""
STEP = 4.0
"""Distance of points along a curve for which a name makes way, px."""
LONGEST = 2000.0
"""Length of a straight piece of a curve from which on its points are farther apart,
px."""


class Place(NamedTuple):
    """Anchor of a name along x, side of the name there, and its distance downwards."""

    x: float
    text_align: str
    text_baseline: str
    y_offset: float


class CaseFlag:
    """The mark of the known number of a case in a plot, a point or a line, with a name.

    Parameters
    ----------
    view
        The view of the plot.
    plot
        Its figure, with linear axes that `View.begin` gave it.
    """

    def __init__(self, view: View, plot: figure) -> None:
        self._view = view
        self._plot = plot
        self._shown: Frame | None = None
        view.add("level", "HSpan", "y", color=FLAG, line_dash="dashed", line_width=1.5)
        look = {"marker": "inverted_triangle", "size": 12, "color": FLAG}
        view.add("flag", "Scatter", "x y", **look)
        self._text = view.add(
            "flag text",
            "Text",
            "x y text text_align text_baseline y_offset",
            text_color=FLAG,
            text_font_style="bold",
            text_font_size=view.words,
            # What it lies on, where no place is free, is to be read through.
            background_fill_alpha=0.75,
        )
        view.follow_size(WIDTH, HEIGHT, self._place_again)

    def _place_again(self) -> None:
        """Place the name again, in a figure of another size."""
        # Before it was shown the axes have no limits.
        if self._shown is not None:
            self.show(self._shown)

    def show(self, frame: Frame) -> None:
        """Show the flag if the number is known for a frame, and stands in this plot."""
        self._shown = frame
        view = self._view
        point = self._known(frame)
        if point is None:
            for name in ("level", "flag", "flag text"):
                view.fill(name, **{key: [] for key in view.sources[name].data})
            return
        x = float(view.x(point.x))
        y = float(view.y(point.y))
        # Any x: a line.
        levels = []
        marks = [(x, y)]
        if math.isnan(x):
            levels = [y]
            marks = []
        view.fill("level", y=levels)
        view.fill("flag", x=[at[0] for at in marks], y=[at[1] for at in marks])
        place = self._place(point.text, x, y)
        start, end = _limits(self._plot.x_range)
        view.fill(
            "flag text",
            x=[start + place.x / view.room[0] * (end - start)],
            y=[y],
            text=[point.text],
            text_align=[place.text_align],
            text_baseline=[place.text_baseline],
            y_offset=[place.y_offset],
        )
        paper = PAPER[view.state.is_dark]
        self._text.glyph.background_fill_color = paper

    def _known(self, frame: Frame) -> PlotFlag | None:
        """The point of the case in this plot, if the number is known for a frame."""
        case = self._view.state.trade_case
        if case is None or not case.knows(frame.run.settings):
            return None
        point = case.flag
        if point is None or point.plot != self._view.name:
            return None
        return point

    def _place(self, text: str, x: float, y: float) -> Place:
        """Place of the name at a point in units of the axes.

        At x NaN it names a line.
        """
        room = self._view.room
        across = _limits(self._plot.x_range)
        up = _limits(self._plot.y_range)
        low = np.array([across[0], up[0]])
        at = (np.array([x, y]) - low) / ([across[1], up[1]] - low) * room
        anchors = [(at[0], "left"), (at[0], "right"), (at[0], "center")]
        if at[0] > 0.5 * room[0]:
            anchors = [(at[0], "right"), (at[0], "left"), (at[0], "center")]
        if math.isnan(x):
            width = float(room[0])
            anchors = [(0.0, "left"), (width, "right"), (0.5 * width, "center")]
        letters = np.array([LETTER * len(text), ROW])
        size = float(self._view.words.removesuffix("px")) * letters
        curves = curves_of(self._plot, across, up, room)
        return place_off(curves, anchors, float(at[1]), size, room)


def _limits(axis: Range1d) -> Array:
    """Limits of an axis that has not been zoomed, shape (2,)."""
    return np.array([axis.reset_start, axis.reset_end])


def place_off(
    curves: Sequence[Array],
    anchors: Sequence[tuple[float, str]],
    y: float,
    text: Array,
    room: Array,
) -> Place:
    """The place of a name above or below a mark that meets fewest curves.

    Of places that are alike the first: nearer to the mark, below it where that is high,
    and at the earlier anchor.

    Parameters
    ----------
    curves
        Points of curves, shape (n, 2) each, with NaN where a curve is broken.
    anchors
        Positions along x, and alignments there.
    y
        Height of the mark.
    text, room
        Size of the name, and of the plot, shape (2,) each.
    """
    points = np.concatenate([np.zeros((0, 2)), *map(_dense, curves)])

    def burden(place: Place) -> tuple[float, int]:
        left = place.x - LEFT_OF[place.text_align] * text[0]
        foot = y - place.y_offset
        if place.text_baseline == "top":
            foot -= text[1]
        low = np.array([left, foot])
        outside = np.maximum(-low, 0.0) + np.maximum(low + text - room, 0.0)
        covered = np.all((points > low) & (points < low + text), axis=1)
        return float(outside.max()), int(covered.sum())

    return min(_places(anchors, y, text, room), key=burden)


def _places(
    anchors: Sequence[tuple[float, str]], y: float, text: Array, room: Array
) -> Iterator[Place]:
    """All places of a name, the best first where nothing lies there."""
    sides = [("bottom", -1.0), ("top", 1.0)]
    if y > 0.2 * room[1]:
        sides.reverse()
    for row in range(ROWS):
        for x, align in anchors:
            for baseline, down in sides:
                yield Place(x, align, baseline, down * (GAP + row * text[1]))


def curves_of(plot: figure, x: Array, y: Array, room: Array) -> list[Array]:
    """Points of all curves and bars of a figure with linear axes, (n, 2) each, px.

    `x` and `y` are the limits of the axes, `room` the size of the plot, (2,) each.
    """
    curves = []
    for renderer in plot.renderers:
        glyph = renderer.glyph
        data = renderer.data_source.data
        if isinstance(glyph, Line):
            curves.append((data[glyph.x], data[glyph.y]))
        elif isinstance(glyph, MultiLine):
            curves += zip(data[glyph.xs], data[glyph.ys], strict=True)
        elif isinstance(glyph, VBar):
            curves += _bars(data[glyph.x], data[glyph.top], glyph.width)
    low = np.array([x[0], y[0]])
    scale = room / (np.array([x[1], y[1]]) - low)
    return [(np.stack([*curve], axis=1) - low) * scale for curve in curves]


def _bars(middles: Array, tops: Array, width: float) -> Iterator[tuple[Array, Array]]:
    """Yield x and y of lines along the top and the middle of each bar, (4,) each."""
    for middle, top in zip(middles, tops, strict=True):
        half = 0.5 * width
        across = np.array([middle - half, middle + half, middle, middle])
        yield across, np.array([top, top, top, 0.0])


def _dense(curve: Array) -> Array:
    """Points along a curve, (n, 2), as close to each other as `STEP`, shape (m, 2)."""
    spans = np.diff(curve, axis=0)
    lengths = np.hypot(spans[:, 0], spans[:, 1])
    # Beside an end that is NaN nothing is drawn, and little is far off the plot.
    is_drawn = np.isfinite(lengths)
    counts = np.ceil(np.minimum(lengths[is_drawn], LONGEST) / STEP).astype(int)
    numbers = np.repeat(np.arange(len(counts)), counts)
    begins = np.repeat(np.cumsum(counts) - counts, counts)
    shares = (np.arange(len(numbers)) - begins) / counts[numbers]
    return curve[:-1][is_drawn][numbers] + shares[:, None] * spans[is_drawn][numbers]
