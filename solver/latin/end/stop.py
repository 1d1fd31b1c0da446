"""Criteria that end a run, as a part of the method (MATHEMATICS.md, 7)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from solver.checks import Number, check


@dataclass(frozen=True)
class Stop:
    """Criteria that end a run; infinite values are not applied.

    Accuracy and tolerance, where both are finite, have to hold together. A run ends in
    any case at its limit of iterations or seconds.

    Attributes
    ----------
    accuracy
        Largest relative error of the contact force, by estimate; where a status step is
        worth its cost, a certified solution has to confirm it.
    tolerance
        LATIN indicator eta, a ratio of squares, that is low enough if the k-free
        indicator agrees.
    iterations
        Largest number of iterations.
    seconds
        Largest time of a run, s; a start or a status step that takes longer is given
        up.
    sufficient
        LATIN indicator that ends a run by itself where the accuracy is not known, and
        not estimated to be missed; 0 switches this criterion off.

    Raises
    ------
    RefusedError
        For a number out of its range.
    """

    accuracy: float = math.inf
    tolerance: float = math.inf
    iterations: float = math.inf
    seconds: float = math.inf
    sufficient: float = 0.0

    def __post_init__(self) -> None:
        share = Number(0.0, 1.0, above=True, endless=True)
        check(
            self,
            accuracy=share,
            tolerance=share,
            iterations=Number(1, endless=True),
            seconds=Number(0.0, above=True, endless=True),
            sufficient=Number(0.0, 1.0),
        )
