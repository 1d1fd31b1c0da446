"""From the inside of plane bodies to a mesh that a screen can show."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from app.picture.shown import STRESSES, Mesh
from solver.arrays import Array
from solver.discrete.elements import von_mises
from solver.discrete.inside import Inside
from solver.settings import Settings

MOST_QUADS = 1500
"""Quadrilaterals that are sent at most, or one for each body."""


class Thinned:
    """A mesh of rectangular bodies of the same size, each thinned alike.

    Parameters
    ----------
    inside
        Its nodes run body by body, row by row.
    settings
        Say what the stress across the plane is.
    """

    def __init__(self, inside: Inside, settings: Settings) -> None:
        self._inside = inside
        values = settings.values()
        self._poisson, self._state = values["poisson"], values["plane"]
        bodies = int(inside.bodies.max()) + 1
        columns = len(np.unique(inside.nodes[:, 0])) - 1
        rows = len(inside.nodes) // (bodies * (columns + 1)) - 1
        across, up = _lines(columns, rows, max(MOST_QUADS // bodies, 1))
        grid = np.arange(len(inside.nodes)).reshape(bodies, rows + 1, columns + 1)
        kept = grid[np.ix_(np.arange(bodies), up, across)]
        self._nodes = kept.ravel()
        corners = np.arange(kept.size).reshape(kept.shape)
        quads = (corners[:, a : a - 1 or None, b : b - 1 or None] for a, b in _AROUND)
        body, row, column = np.unravel_index(inside.elements[:, 0], grid.shape)
        self._quad = np.ravel_multi_index(
            (
                body,
                np.searchsorted(up, row, side="right") - 1,
                np.searchsorted(across, column, side="right") - 1,
            ),
            (bodies, len(up) - 1, len(across) - 1),
        )
        self._counts = np.bincount(self._quad)
        parts = np.zeros(len(self._counts), dtype=np.intp)
        parts[self._quad] = inside.parts
        self.mesh = Mesh(
            nodes=inside.nodes[self._nodes].astype(np.float32),
            quads=np.stack([corner.ravel() for corner in quads], axis=1).astype(np.int32),
            parts=parts,
        )

    def fields(self, skeleton: Array, instant: int, component: str) -> tuple[Array, Array]:
        """Give the displacement of the shown nodes, m, and a stress in the shown quads, Pa."""
        whole = self._inside.displacement(skeleton, [instant])[:, :, 0]
        stress = self._inside.stress(whole)
        if component == STRESSES[0]:
            values = von_mises(stress, self._poisson, self._state)
        else:
            values = stress[:, STRESSES.index(component) - 1]
        mean = np.bincount(self._quad, weights=values) / self._counts
        return whole[self._nodes], mean


_AROUND = ((0, 0), (0, 1), (1, 1), (1, 0))
"""Which node lines, above and to the right of an element's first, its corners stand on."""


def _lines(columns: int, rows: int, most: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Choose node lines of a body, so that few enough quadrilaterals lie between them."""
    share = min(np.sqrt(most / (columns * rows)), 1.0)
    up = min(max(int(rows * share), 1), most)
    across = min(max(int(columns * share), 1), max(most // up, 1))
    across, up = (columns, rows) if share == 1.0 else (across, up)
    return _spread(columns, across), _spread(rows, up)


def _spread(size: int, count: int) -> NDArray[np.intp]:
    return np.linspace(0, size, count + 1).round().astype(np.intp)
