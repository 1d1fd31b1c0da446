"""The order of the points of a sweep: a path on which neighbours are neighbours in the grid."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def snake(shape: Sequence[int]) -> list[int]:
    """Go through a grid and turn round at the end of every line.

    Parameters
    ----------
    shape
        Points along one or two axes.

    Returns
    -------
    Numbers of the points, the last axis fastest, each once.
    """
    grid = np.arange(np.prod(shape)).reshape(-1, shape[-1])
    grid[1::2] = grid[1::2, ::-1]
    return [int(number) for number in grid.ravel()]
