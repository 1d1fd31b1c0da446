"""Softening rods are solved wherever there is an equilibrium (MATHEMATICS.md, 14).

Whether there is one is found apart from the solver: by trying all statuses of a short
rod.
"""

from __future__ import annotations

import numpy as np
import pytest
from enumerated_states import numbers_of_equilibria
from runs import settings_of

from solver.reference.distance import kkt_residual
from solver.reference.incremental import reference_of
from solver.scenes import discretise

STEEL = {"young": 2.1e11, "substructures": 1}
PULLED = {
    "young": 2.4e11,
    "substructures": 1,
    "elements": 4,
    "instants": 5,
    "length": 0.13,
    "section": 1.5e-5,
    "friction": 1.2,
    "pressure": 7000.0,
    "friction_law": "slip-dependent",
    "friction_ratio": 0.86,
    "slip_length": 2.2e-5,
    "left_end": "pulled",
    "right_end": "pulled",
    "load": [[0.0, 0.0], [1.0, -300.0]],
    "settlement_load": [[0.0, 0.0], [0.5, 4e-4], [1.0, -2e-4]],
    "settlement_profile": [[0.0, 0.8], [0.13, -0.25]],
}
"""Pulled at one end, on a support that moves to and fro: all of it slips for a
moment."""
STRETCHED = STEEL | {
    "elements": 3,
    "instants": 8,
    "length": 0.63,
    "section": 5.7e-5,
    "friction": 0.72,
    "pressure": 6900.0,
    "friction_law": "slip-dependent",
    "friction_ratio": 0.7,
    "slip_length": 1.9e-4,
    "left_end": "free",
    "right_end": "free",
    "settlement_load": [[0.0, 0.0], [0.5, 1.7e-3], [1.0, 1.9e-3]],
    "settlement_profile": [[0.0, -0.36], [0.63, -0.52]],
}
"""A free rod on a support that shrinks: both halves slip alike, which is not stable."""
RISES_AGAIN = STEEL | {
    "elements": 2,
    "instants": 4,
    "length": 0.245,
    "section": 1e-5,
    "friction": 0.68,
    "pressure": 2100.0,
    "friction_law": "general",
    "strength": [[0.0, 1.0], [1.57e-6, 0.33], [1.91e-6, 1.02]],
    "left_end": "spring",
    "left_spring": 1.1e6,
    "right_end": "free",
    "settlement_load": [[0.0, 0.0], [0.5, 3e-5], [1.0, -1e-5]],
    "settlement_profile": [[0.0, 0.57], [0.245, -0.71]],
}
"""Friction that falls and rises again, far steeper than the rod is stiff."""


def assert_solved_where_equilibria_exist(settings):
    """Compare a solution with the equilibria up to the first instant without."""
    found = reference_of(discretise(settings))
    numbers = numbers_of_equilibria(found)
    lost = np.flatnonzero(~found.converged)
    if len(lost):
        assert numbers[lost[0]] == 0
        return found
    assert kkt_residual(found, found.problem) < 1e-9
    return found


@pytest.mark.parametrize("values", [PULLED, STRETCHED, RISES_AGAIN])
def test_a_rod_that_slips_as_a_whole_for_a_moment_comes_to_an_equilibrium(values):
    found = assert_solved_where_equilibria_exist(settings_of("bar", **values))
    assert found.converged.all()
    assert found.jumps_at is not None


def test_the_rod_that_is_pulled_has_one_equilibrium_at_each_instant():
    found = reference_of(discretise(settings_of("bar", **PULLED)))
    assert numbers_of_equilibria(found).tolist() == [1] * 5


def test_a_rod_that_leaves_a_ridge_says_that_there_are_several_equilibria():
    found = reference_of(discretise(settings_of("bar", **STRETCHED)))
    assert found.ambiguous.any()
    assert np.all(numbers_of_equilibria(found)[found.ambiguous] > 1)


def drawn_rod(seed):
    """A short rod with any ends, loads and strength, on a support that may move."""
    random = np.random.default_rng(seed)
    length = random.uniform(0.1, 1.0)
    section = 10.0 ** random.uniform(-5.0, -4.0)
    elements = int(random.integers(2, 4))
    friction = random.uniform(0.2, 1.5)
    bound = friction * 1e4 * length
    strain = bound / (STEEL["young"] * section)

    def path(size):
        turns = size * random.uniform(-1.0, 1.0, 3)
        return [[0.0, 0.0], [0.3, turns[0]], [0.6, turns[1]], [1.0, turns[2]]]

    spacing = length / elements
    slip = strain * spacing * spacing / length * 10.0 ** random.uniform(-1.5, 1.0)
    factors = random.uniform(0.0, [0.95, 1.5])
    strength = [[0.0, 1.0], [slip, factors[0]], [2.5 * slip, factors[1]]]
    settled = strain * length * 10.0 ** random.uniform(-0.5, 1.5)
    return STEEL | {
        "elements": elements,
        "instants": 5,
        "length": length,
        "section": section,
        "friction": friction,
        "pressure": 1e4,
        "friction_law": "general",
        "strength": strength,
        "left_end": str(random.choice(["pulled", "held", "free", "spring"])),
        "right_end": str(random.choice(["pulled", "held", "free", "spring"])),
        "left_load": path(0.2 * bound),
        "load": path(0.2 * bound),
        "settlement_load": path(settled),
        "settlement_profile": [
            [0.0, random.uniform(-1, 1)],
            [length, random.uniform(-1, 1)],
        ],
    }


@pytest.mark.parametrize("seed", range(12))
def test_short_rods_are_solved_wherever_they_have_an_equilibrium(seed):
    assert_solved_where_equilibria_exist(settings_of("bar", **drawn_rod(seed)))
