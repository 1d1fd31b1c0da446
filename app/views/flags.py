"""The name of a mark in a plot: of the places beside the mark, one off the curves.

All positions are px from the lower left corner of the plot.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from bokeh.models import Line, MultiLine, VBar
from bokeh.plotting import figure

from solver.arrays import Array

GAP = 9.0
"""Distance of a name from its mark, px."""
ROWS = 3
"""Number of rows above a mark, and of those below it, in which its name may stand."""
STEP = 4.0
"""Distance of points along a curve for which a name makes way, px."""
LONGEST = 2000.0
"""Length of a straight piece of a curve from which on its points are farther apart,
px."""
LEFT_OF = {"left": 0.0, "center": 0.5, "right": 1.0}
"""Share of a name at the left of its anchor, by its alignment."""


class Place(NamedTuple):
    """Anchor of a name along x, side of the name there, and its distance downwards."""

    x: float
    text_align: str
    text_baseline: str
    y_offset: float


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
