"""A label in the figure of the scene: its box, and positions to move to."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from app.views.layout import Layout
from solver.arrays import Array

LINE = 0.8
"""Height of letters over the distance of rows."""
LEFT_OF = {"left": 0.0, "center": 0.5, "right": 1.0}
"""Share of a text at the left of its anchor, by its alignment."""


class Word(NamedTuple):
    """A label in the figure: text, anchor, (2,), px, side at the anchor, colour."""

    text: str
    anchor: Array
    align: str
    color: str


def inside(layout: Layout, words: Sequence[Word]) -> list[Word]:
    """Labels, moved so that no text is cut off."""
    inside = []
    edge = half_of_line(layout)
    for word in words:
        width = width_of(layout, word)
        left = width * LEFT_OF[word.align]
        right = max(layout.canvas.width - width + left, left)
        limits = [left, edge], [right, layout.canvas.height - edge]
        inside.append(word._replace(anchor=np.clip(word.anchor, *limits)))
    return inside


def half_of_line(layout: Layout) -> float:
    """Half of the height of a line, px."""
    return 0.5 * LINE * layout.row


def width_of(layout: Layout, word: Word) -> float:
    """Estimated width of a label, px."""
    return layout.letter * len(word.text) + 4.0


def box_of(layout: Layout, word: Word) -> tuple[Array, Array]:
    """Lower left and upper right corner of a label, (2,) each, px."""
    width = width_of(layout, word)
    size = np.array([width, 2.0 * half_of_line(layout)])
    low = word.anchor - size * [LEFT_OF[word.align], 0.5]
    return low, low + size


def lies_on(layout: Layout, word: Word, low: Array, high: Array) -> bool:
    """Check whether a label meets boxes between corners, shape (n, 2) each, px."""
    first, last = box_of(layout, word)
    return bool(np.any(np.all((low < last) & (high > first), axis=1)))


def meets(layout: Layout, word: Word, others: Sequence[Word]) -> bool:
    """Check whether a label meets any of others."""
    boxes = [box_of(layout, other) for other in others]
    low, high = np.reshape(boxes, (-1, 2, 2)).swapaxes(0, 1)
    return lies_on(layout, word, low, high)


def in_rows(layout: Layout, word: Word, most: int) -> list[Word]:
    """Copies of a label moved up or down by up to `most` rows, inside the figure.

    Of two places equally far away the one farther from the middle comes first.
    """
    outward = math.copysign(layout.row, word.anchor[1] - 0.5 * layout.canvas.height)
    places = []
    edge = half_of_line(layout)
    for rows in range(1, most + 1):
        for shift in (rows * outward, -rows * outward):
            anchor = np.add(word.anchor, [0.0, shift])
            if edge <= anchor[1] <= layout.canvas.height - edge:
                places.append(word._replace(anchor=anchor))
    return places


def around(layout: Layout, word: Word, most: int) -> list[Word]:
    """Copies of a label moved by up to `most` rows, then also aside by its width.

    Two labels beside each other have a letter between them.
    """
    level = in_rows(layout, word, most)
    width = width_of(layout, word) + layout.letter
    aside = []
    for one in (word, *level):
        for shift in (-width, width):
            aside.append(one._replace(anchor=np.add(one.anchor, [shift, 0.0])))
    within = [one for one in aside if is_inside(layout, one)]
    return [*level, *within]


def is_inside(layout: Layout, word: Word) -> bool:
    """Check whether a label lies inside the figure."""
    low, high = box_of(layout, word)
    size = [layout.canvas.width, layout.canvas.height]
    return bool(np.all(low >= 0.0) and np.all(high <= size))
