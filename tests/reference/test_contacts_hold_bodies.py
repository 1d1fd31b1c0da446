"""Contacts that act hold bodies where they leave these no motion."""

from __future__ import annotations

import numpy as np
import pytest

from solver.arrays import Array
from solver.reference.distance import are_independent

TURN = np.array([[1.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 1.0]])
"""Motions of three points along x, y and in a turn."""


@pytest.mark.parametrize(
    ("moved", "is_held"),
    [
        (TURN, True),
        (TURN[:2], False),
        (TURN[[0, 0, 1]], False),
        (TURN[:0], False),
        (TURN * [1.0, 1e-8, 1.0], True),
        (TURN * [1.0, 0.0, 1.0], False),
    ],
    ids=["three", "two", "one twice", "none", "small", "without y"],
)
def test_three_motions_are_held_by_three_that_differ(
    moved: Array, *, is_held: bool
) -> None:
    assert are_independent(moved) == is_held
