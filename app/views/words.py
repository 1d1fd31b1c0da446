"""Words in the figure of the scene, and places where they cover nothing."""

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
    """A text in the figure: its anchor, (2,), px, the side it is at, and a colour."""

    text: str
    anchor: Array
    align: str
    color: str


def inside(layout: Layout, words: Sequence[Word]) -> list[Word]:
    """Words, moved so that no text is cut."""
    inside = []
    for word in words:
        width = width_of(layout, word)
        left = width * LEFT_OF[word.align]
        right = max(layout.width - width + left, left)
        limits = [left, 8.0], [right, layout.height - 8.0]
        inside.append(word._replace(anchor=np.clip(word.anchor, *limits)))
    return inside


def width_of(layout: Layout, word: Word) -> float:
    """Width of a word, about, px."""
    return layout.letter * len(word.text) + 4.0


def box_of(layout: Layout, word: Word) -> tuple[Array, Array]:
    """Lower left and upper right corner of a word, (2,) each, px."""
    width = width_of(layout, word)
    size = np.array([width, LINE * layout.row])
    low = word.anchor - size * [LEFT_OF[word.align], 0.5]
    return low, low + size


def lies_on(layout: Layout, word: Word, low: Array, high: Array) -> bool:
    """Check whether a word lies on boxes between corners, shape (n, 2) each, px."""
    first, last = box_of(layout, word)
    return bool(np.any(np.all((low < last) & (high > first), axis=1)))


def meets(layout: Layout, word: Word, others: Sequence[Word]) -> bool:
    """Check whether a word lies on one of others."""
    boxes = [box_of(layout, other) for other in others]
    low, high = np.reshape(boxes, (-1, 2, 2)).swapaxes(0, 1)
    return lies_on(layout, word, low, high)


def in_rows(layout: Layout, word: Word, most: int) -> list[Word]:
    """A word moved up or down by up to a number of rows, inside the figure.

    Of two places equally far away the one farther from the middle comes first.
    """
    outward = math.copysign(layout.row, word.anchor[1] - 0.5 * layout.height)
    places = []
    for rows in range(1, most + 1):
        for shift in (rows * outward, -rows * outward):
            anchor = np.add(word.anchor, [0.0, shift])
            if 8.0 <= anchor[1] <= layout.height - 8.0:
                places.append(word._replace(anchor=anchor))
    return places
