"""Displacements seen from the contacts, and the stiffness between these."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import sparse

from solver.reference.assembly import assembled_stiffness
from solver.reference.condensation import Condensation
from solver.reference.glued import from_jumps, jumps
from solver.scenes import CATALOGUE, discretise


@st.composite
def graphs(draw: st.DrawFn) -> sparse.csr_array:
    """Jumps between up to eight points and the ground, in rings too and several between two."""
    n_points = draw(st.integers(1, 8))
    ends = st.lists(st.integers(0, n_points), min_size=2, max_size=2, unique=True)
    pairs = draw(st.lists(ends, min_size=1, max_size=12))
    found = np.zeros((len(pairs), n_points + 1))
    for row, (above, below) in enumerate(pairs):
        found[row, above], found[row, below] = 1.0, -1.0
    return sparse.csr_array(found[:, :n_points])


@given(graphs())
def test_jumps_make_displacements_and_all_others_jump_nowhere(own: sparse.csr_array) -> None:
    whole = own.toarray()
    jumped, glued = (one.toarray() for one in from_jumps(own))
    makes = np.flatnonzero(jumped.any(axis=0))
    np.testing.assert_array_equal(whole[makes] @ jumped[:, makes], np.eye(len(makes)))
    np.testing.assert_array_equal(whole @ glued, 0.0)
    assert len(makes) == np.linalg.matrix_rank(whole)
    both = np.hstack([jumped[:, makes], glued])
    assert both.shape[0] == both.shape[1] == np.linalg.matrix_rank(both)


@pytest.mark.parametrize(
    ("scene", "changes"),
    [
        ("strand", {"wires": 4, "elements": 6}),
        ("layers", {"layers": 3, "elements": 4, "elements_up": 2}),
        ("block", {"elements": 6, "elements_up": 3}),
        ("incline", {"elements": 6, "elements_up": 3}),
    ],
)
def test_the_stiffness_between_contacts_is_the_least_energy_with_these_jumps(
    scene: str, changes: dict[str, Any]
) -> None:
    problem = discretise(CATALOGUE[scene].settings.checked(changes | {"instants": 3}))
    condensed = Condensation(problem)
    fixed, _ = problem.prescribed
    free = np.setdiff1d(np.arange(problem.n_dofs), fixed)
    own = jumps(problem)[:, free][condensed.moving[condensed.base]].toarray()
    stiffness = assembled_stiffness(problem)[free][:, free].toarray()
    moved = np.random.default_rng(7).normal(size=len(free))
    # All displacements with the same jumps differ by what jumps nowhere.
    *_, right = np.linalg.svd(own)
    still = right[np.linalg.matrix_rank(own) :].T
    least = (
        moved - still @ np.linalg.lstsq(still.T @ stiffness @ still, still.T @ stiffness @ moved)[0]
    )
    jump = own @ moved
    jump -= condensed.gauge @ (condensed.gauge.T @ jump)
    found = float(jump @ condensed.stiffness @ jump)
    assert found == pytest.approx(float(least @ stiffness @ least), rel=1e-10)
