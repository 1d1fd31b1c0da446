"""Many bodies take no work of Python for each of them but a few calls."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from counting import calls_of
from shaped_bodies import arch, courses_of_blocks

from solver.discrete import Bodies, discretise
from solver.scenes import CATALOGUE


# Each body is a substructure; its joints and what it shares are arrays. With its own
# meshes, frames and laws a voussoir took several hundred calls, and a block among
# others, at whose corners joints have no pair, 240 with its own pieces of joints.
@pytest.mark.parametrize(
    ("structure", "sizes", "calls"),
    [
        (arch, (31, 121), 30),
        (lambda columns: courses_of_blocks(columns, 4), (5, 15), 90),
    ],
)
def test_a_further_body_takes_few_calls(
    structure: Callable[[int], Bodies], sizes: tuple[int, int], calls: int
) -> None:
    bodies = []
    made = []
    for size in sizes:
        few_or_many = structure(size)
        # What is made once for all, and kept, does not count.
        discretise(few_or_many)
        bodies.append(len(few_or_many.bodies))
        made.append(calls_of(lambda each=few_or_many: discretise(each)))
    assert made[1] - made[0] <= calls * (bodies[1] - bodies[0])


def test_a_further_voussoir_is_data_in_few_calls() -> None:
    made = []
    for voussoirs in (31, 121):
        settings = CATALOGUE["arch"](voussoirs=voussoirs)
        # Its mesh and its times are kept.
        settings.structure()
        made.append(calls_of(settings.structure))
    assert made[1] - made[0] <= 12 * (121 - 31)


# Rounding in the positions of their nodes once gave each its own basis, and the coarse
# problem of a bundle, a block or layers took half as long again.
@pytest.mark.parametrize("scene", ["arch", "bundle", "block", "layers"])
def test_equal_parts_have_equal_macro_bases_to_the_bit(scene: str) -> None:
    problem = discretise(CATALOGUE[scene]().structure())
    basis, _ = problem.macro
    known = {}
    for part in problem.substructures:
        own = basis[part.rows]
        # Parts with the same operator differ in which of their sides meet others.
        sides = id(part.elasticity), (np.diff(own.indptr) > 0).tobytes()
        first = known.setdefault(sides, own)
        assert np.array_equal(own.indptr, first.indptr)
        assert np.array_equal(own.data, first.data)
    assert len(known) < len(problem.substructures)
