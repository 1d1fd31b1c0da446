"""Bodies fill the picture of their scene whatever its size, and what is beside them has room."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from test_the_scene_is_pictured import pictured
from test_views_say_what_they_draw import looked_at

from app.views.drawing.drawing import Curve, Drawing, Word
from app.views.drawing.figures import LINE
from solver.arrays import Array
from solver.scenes import CATALOGUE

LETTER = 7.6
"""Mean width of a letter of the words in a picture, px."""


class Page:
    """A drawing on a page of so many pixels, laid out as `FIT` of the figures does it."""

    def __init__(self, drawing: Drawing, wide: float, tall: float) -> None:
        assert drawing.bodies is not None
        self.drawing, self.size, box = drawing, (wide, tall), drawing.bodies.box
        across, up = box.right - box.left, box.high - box.low
        inner = tall - LINE * sum(box.lines)
        wanted = box.filled * inner if box.flattest else up * wide / across
        aside = box.room[2] + box.room[3]
        self.unit = max(min((inner - wanted) / aside, wide / 400, 1.6), 0.35)
        lines = (0, 0, *box.lines)
        rooms = [self.unit * room + LINE * own for room, own in zip(box.room, lines, strict=True)]
        inside = wide - rooms[0] - rooms[1], tall - rooms[2] - rooms[3]
        per = [across / inside[0], max(up / inside[1], box.flattest / self.unit)]
        self.per = per if box.flattest else [max(per)] * 2
        slack = [
            whole - first - last - size / one
            for whole, first, last, size, one in zip(
                (wide, tall), rooms[::2], rooms[1::2], (across, up), self.per, strict=True
            )
        ]
        self.start = (
            box.left - self.per[0] * (rooms[0] + 0.5 * slack[0]),
            box.low - self.per[1] * (rooms[2] + 0.5 * slack[1]),
        )

    def at(self, one: Curve | Word) -> Array:
        """Give where points are, shape (n, 2), px, from the lower left corner."""
        pairs = ((one.x, one.dx), (one.y, one.dy))
        found = [
            (np.asarray(place, float) - start) / per + self.unit * np.asarray(shift, float)
            for (place, shift), start, per in zip(pairs, self.start, self.per, strict=True)
        ]
        return np.stack([np.atleast_1d(axis) for axis in found], axis=1)

    def word(self, word: Word) -> tuple[float, float, float, float]:
        """Give the left, right, low and high end of a word."""
        ((x, y),) = self.at(word)
        lines = word.text.split("\n")
        wide, tall = LETTER * max(map(len, lines)), LINE * len(lines)
        left = x - {"left": 0.0, "center": 0.5, "right": 1.0}[word.across] * wide
        low = y - {"bottom": 0.0, "middle": 0.5, "top": 1.0}[word.up] * tall
        return left, left + wide, low, low + tall


CARDS = [(1590, 225), (940, 190), (940, 80), (940, 165), (356, 170), (290, 120), (490, 460)]
"""Sizes of plots that a picture has room in, px."""


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_all_that_is_drawn_is_seen_at_any_size_and_no_word_lies_on_another(scene: str) -> None:
    shown = looked_at(scene)
    for instant in (0, 5, len(shown.run.stand.instants) - 1):
        drawing = pictured(replace(shown, instant=instant))
        assert drawing.bodies is not None
        bodies = Curve(*drawing.bodies.places.T, "")
        for size in CARDS:
            page = Page(drawing, *size)
            for curve in (bodies, *drawing.curves):
                at = page.at(curve)
                assert np.nanmin(np.append(at, 0.0)) > -1e-3
                assert not np.any(at > np.array(size) + 1e-3)
            ends = [page.word(word) for word in drawing.words]
            for left, right, low, high in ends:
                assert left >= -1e-3
                assert right <= size[0] + 1e-3
                assert low >= -1e-3
                assert high <= size[1] + 1e-3
            for one, other in combinations(ends, 2):
                apart = one[1] <= other[0] or other[1] <= one[0]
                assert apart or one[3] <= other[2] or other[3] <= one[2]


@pytest.mark.parametrize("scene", ["bar", "strand", "layers"])
@pytest.mark.parametrize("size", CARDS)
def test_long_bodies_take_three_quarters_of_the_width(scene: str, size: tuple[int, int]) -> None:
    assert np.ptp(undeformed(Page(pictured(looked_at(scene)), *size))[:, 0]) >= 0.75 * size[0]


def test_layers_are_thick_enough_to_tell_them_apart_in_a_low_band() -> None:
    shown, band = looked_at("layers"), 110
    high = np.ptp(undeformed(Page(pictured(shown), 940, band))[:, 1])
    assert high / shown.run.stand.portrait.described.bodies >= 0.1 * band


@pytest.mark.parametrize("scene", ["block", "incline"])
def test_other_bodies_fill_a_tall_card(scene: str) -> None:
    assert np.ptp(undeformed(Page(pictured(looked_at(scene)), 490, 460))[:, 0]) >= 0.6 * 490


def undeformed(page: Page) -> Array:
    """Give the outline of the bodies before they moved, px."""
    return np.concatenate([page.at(one) for one in page.drawing.curves if one.dash == "dotted"])
