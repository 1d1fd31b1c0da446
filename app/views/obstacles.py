"""Obstacles in the picture of a scene, for which its labels make way."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise

import numpy as np

from app.views.acts import text_of
from app.views.picture import Picture
from app.views.words import Word, box_of, lies_on
from solver.arrays import Array

ALONG = 9
"""Number of places along an arrow which words make way for."""
HANDLE = 5.5
"""Half of the size of the handle of an arrow, px."""


class Obstacles:
    """Bodies, arrows and handles of a picture, which labels must not cover."""

    def __init__(self, picture: Picture) -> None:
        self.layout = picture.layout
        self._picture = picture

    def below(self, word: Word) -> tuple[bool, bool, bool]:
        """Check whether a label covers arrows or handles, bodies, and the ground."""
        return (
            self._has_arrows_below(word),
            self.has_bodies_below(word),
            self._has_ground_below(word),
        )

    def has_bodies_below(self, word: Word) -> bool:
        """Check whether a label covers bodies."""
        # Most labels stand beside all of them.
        if not lies_on(self.layout, word, *self._whole):
            return False
        return lies_on(self.layout, word, *self._cells)

    def _has_ground_below(self, word: Word) -> bool:
        """Check whether a label covers the ground of a case.

        Loads act through ground that is all around.
        """
        if self._picture.is_around:
            return False
        return lies_on(self.layout, word, *self._ground)

    def _has_arrows_below(self, word: Word) -> bool:
        """Check whether a label covers an arrow or a handle."""
        places = self._shafts
        if lies_on(self.layout, word, places, places):
            return True
        handles = self._handles
        return lies_on(self.layout, word, handles - HANDLE, handles + HANDLE)

    def block(self, line: Array, words: Sequence[Word]) -> bool:
        """Check whether handles or labels lie on a line, (n, 2), px."""
        for word in words:
            low, high = box_of(self.layout, word)
            if np.any(np.all((line > low) & (line < high), axis=1)):
                return True
        away = np.hypot(*np.moveaxis(line[:, None] - self._handles, -1, 0))
        return bool(np.any(away < 2.0 * HANDLE))

    @cached_property
    def _cells(self) -> tuple[Array, Array]:
        """Lower left and upper right corners of all cells, (n_cells, 2) each, px."""
        cells = self._picture.frame.run.geometry.cells
        corners = self._picture.page(self._picture.nodes[cells])
        return corners.min(axis=1), corners.max(axis=1)

    @cached_property
    def _ground(self) -> tuple[Array, Array]:
        """Lower left and upper right corners of the ground, (n, 2) each, px."""
        corners = self._picture.page(self._picture.ground)
        return corners.min(axis=1), corners.max(axis=1)

    @cached_property
    def weights(self) -> dict[str, Array]:
        """Arrows of weights from their tails, (n, 2), px, by the words of these."""
        lines = {}
        for arrows in self._picture.arrows:
            if arrows.act.side == "body" and len(arrows.lines):
                text = text_of(arrows.act, self._picture.now)
                lines[text] = self._picture.page(arrows.lines[0])
        return lines

    @cached_property
    def _whole(self) -> tuple[Array, Array]:
        """Lower left and upper right corner of all bodies, (1, 2) each, px."""
        nodes = self._picture.page(self._picture.nodes)
        return nodes.min(axis=0, keepdims=True), nodes.max(axis=0, keepdims=True)

    @cached_property
    def _shafts(self) -> Array:
        """Points along all arrows, their heads, and lines over tails, (n, 2), px."""
        shares = np.linspace(0.0, 1.0, ALONG)[:, None]
        places = [np.zeros((0, 2))]
        for arrows in self._picture.arrows:
            places.append(arrows.heads.reshape(-1, 2))
            for line in arrows.lines:
                places.append(line[0] + shares * (line[-1] - line[0]))
            for first, last in pairwise(arrows.spread):
                places.append(first + shares * (last - first))
        return self._picture.page(np.concatenate(places))

    @cached_property
    def _handles(self) -> Array:
        """Middles of the handles of all arrows, (n, 2), px."""
        handles = [arrows.handle for arrows in self._picture.draggable]
        return self._picture.page(np.reshape(handles, (-1, 2)))
