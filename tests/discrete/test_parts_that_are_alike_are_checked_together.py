"""Bodies, joints and substructures that are alike are checked as arrays."""

from __future__ import annotations

import numpy as np
import pytest
from shaped_bodies import arch, grid

from solver.arrays import Array, distinct
from solver.discrete import Body, Joint, discretise
from solver.discrete.substructure import Substructure, check_forces
from solver.refusal import RefusedError

SQUARE = grid(np.linspace(0.0, 1.0, 2), np.linspace(0.0, 1.0, 2))
ANGLES = np.array([0.1, -0.2, 0.3])
ORIGINS = np.arange(6.0).reshape(3, 2)
NAMES = ("a", "b", "c")


def one_by_one(weight: Array) -> list[Body]:
    each = zip(NAMES, ORIGINS, ANGLES.tolist(), strict=True)
    return [
        Body(name, SQUARE, 2e9, 0.2, origin=origin, angle=angle, weight=weight)
        for name, origin, angle in each
    ]


def test_bodies_placed_together_are_those_made_one_by_one() -> None:
    weight = np.ones((2, 4))
    first = Body("first", SQUARE, 2e9, 0.2, weight=weight)
    # What was found of the first body is not that of the others.
    assert first.nodes.shape == (9, 2)
    placed = first.placed(NAMES, ORIGINS, ANGLES)
    for body, alone in zip(placed, one_by_one(weight), strict=True):
        assert str(body) == str(alone)
        assert body.shape is alone.shape
        assert body.weight is alone.weight
        assert (body.young, body.poisson) == (alone.young, alone.poisson)
        np.testing.assert_array_equal(body.nodes, alone.nodes)


@pytest.mark.parametrize(
    ("origins", "angles", "words"),
    [
        (ORIGINS[:2], ANGLES, "Body.origin"),
        (np.full((3, 2), np.nan), ANGLES, "Body.origin"),
        (ORIGINS, np.array([0.0, np.inf, 0.0]), "Body.angle"),
    ],
)
def test_places_out_of_range_are_refused(
    origins: Array, angles: Array, words: str
) -> None:
    first = Body("first", SQUARE, 2e9)
    with pytest.raises(RefusedError, match=words):
        first.placed(NAMES, origins, angles)


def test_normals_of_other_shapes_or_no_numbers_are_refused() -> None:
    nodes = SQUARE.along([0, 1])
    up = np.tile([0.0, 1.0], (3, 1))
    first = Joint("first", 1, nodes, 0, nodes, up)
    (second,) = first.placed(["second"], [2], [1], up[None])
    assert second.sides[0][0] == 2
    assert second.sides[1][1] is nodes
    for normals in (up[None, :2], np.full((1, 3, 2), np.nan)):
        with pytest.raises(RefusedError, match=r"Joint.normals"):
            first.placed(["second"], [2], [1], normals)


def test_equal_substructures_have_as_many_degrees_of_freedom_each() -> None:
    part = discretise(arch(5)).substructures[1]
    dofs = [part.dofs, part.dofs[1:]]
    rows = [part.rows, part.rows]
    with pytest.raises(RefusedError, match=r"Substructure.dofs"):
        Substructure.of_equal(part.elasticity, dofs, rows, [None, None])
    with pytest.raises(RefusedError, match=r"Substructure.body_force"):
        check_forces(np.full((2, 3, 4), np.nan))


def test_distinct_numbers_are_those_that_sorting_finds() -> None:
    numbers = np.random.default_rng(1).integers(0, 40, 60)
    for found, known in zip(
        distinct(numbers, 50),
        np.unique(numbers, return_index=True, return_inverse=True),
        strict=True,
    ):
        np.testing.assert_array_equal(found, known)
