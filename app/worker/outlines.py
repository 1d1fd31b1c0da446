"""Lines of the bodies that are drawn, as nodes: round every substructure, and round the bodies."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array

Indices = NDArray[np.intp]
BREAK = -1
"""Stands between two lines in a list of nodes."""


def outlines_of(nodes: Array, quads: NDArray[np.int32], parts: Indices) -> tuple[Indices, Indices]:
    """Closed lines round substructures, and sides of bodies that nothing touches."""
    # Parts that meet at a node may share it, or have one each at the same place.
    places = np.round(nodes / np.ptp(nodes) * 1e5).astype(np.int64)
    _, place = np.unique(places, axis=0, return_inverse=True)
    own = [_boundary(quads[parts == part], np.arange(len(nodes))) for part in np.unique(parts)]
    rims = _boundary(np.concatenate(own), place.ravel())
    loops = [np.append(loop, BREAK) for sides in own for loop in _loops(sides)]
    return np.concatenate(loops), np.insert(rims, 2, BREAK, axis=1).ravel()


def _boundary(cells: Indices, place: Indices) -> Indices:
    """Directed sides of cells, (n, 2), that no other one has the other way round.

    Cells are quadrilaterals, or sides; `place` is that of each node.
    """
    sides = cells
    if cells.shape[1] > 2:
        sides = np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2)
    ends, size = place[sides], int(place.max()) + 1
    is_single = ~np.isin(ends @ [size, 1], ends @ [1, size]) & (ends[:, 0] != ends[:, 1])
    return np.asarray(sides[is_single], dtype=np.intp)


def _loops(sides: Indices) -> list[Indices]:
    """Closed lines of directed sides."""
    following = defaultdict(list)
    for first, second in sides.tolist():
        following[first].append(second)
    loops = []
    for start in list(following):
        loop = [start]
        while following[loop[-1]]:
            loop.append(following[loop[-1]].pop())
        if len(loop) > 1:
            loops.append(np.array(loop, dtype=np.intp))
    return loops
