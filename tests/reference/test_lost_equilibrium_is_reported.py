"""A run without equilibrium says when, under which loads, and what to try."""

from __future__ import annotations

import numpy as np
import pytest

from solver import End, Rods, discrete, solve
from solver.discrete.problem import Problem
from solver.latin import Ending
from solver.reference.incremental import reference_of
from solver.reference.limit_analysis import collapse_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.scene import Settings

STACKED = {
    "friction": 1.2135699865817597,
    "elements": 3,
    "elements_up": 10,
    "bricks": 3,
    "courses": 3,
    "bond": "stack",
    "height": 0.7812596567934593,
    "pressure": 82402.4189541535,
    "top": "pulled",
    "traction": 4917.755209961714,
    "slope": -0.15435751153878552,
    "unit_weight": 1252.2348782600523,
    "instants": 6,
    "max_iterations": 2,
}
"""Columns of high bricks that lean on each other under their own weight."""


def stacked() -> Settings:
    return CATALOGUE["wall"].checked(STACKED)


def pulled_rod(strength: float) -> Problem:
    times = np.linspace(0.0, 1.0, 5)
    rods = Rods(
        length=1.0,
        stiffness=1e6,
        elements=6,
        substructures=1,
        instants=times,
        duration=1.0,
        strength=np.full(7, strength),
        left=End(force=0.0 * times),
        right=End(force=900.0 * times),
    )
    return discrete.discretise(rods)


def test_columns_that_lean_are_given_up_without_trying_the_same_states_again() -> None:
    """Columns fall with the same states under softer and softer springs."""
    problem = discretise(stacked())
    found = reference_of(problem)
    assert found.is_lost
    assert found.collapse is None
    # Each of the sixty springs took up to thirty systems more.
    assert found.steps < 400


@pytest.mark.parametrize("ratio", [0.8, 1.2])
def test_friction_that_changes_with_slip_does_not_prolong_the_search(
    ratio: float,
) -> None:
    law = {"friction_law": "slip-dependent", "friction_ratio": ratio}
    found = reference_of(discretise(CATALOGUE["wall"].checked(STACKED | law)))
    assert found.is_lost
    assert found.collapse is None
    # Springs are softened on no piece of the laws twice: 2500 to 3100 where they were.
    assert found.steps < 1300


def test_a_run_says_where_it_found_no_equilibrium_though_forces_could_balance() -> None:
    settings = stacked()
    problem = discretise(settings)
    assert collapse_of(problem) is None
    run = solve(problem, method_of(settings), watch=False)
    assert run.status.ending is not Ending.CONVERGED
    assert not run.is_certified
    lost = int(np.argmin(reference_of(problem).converged))
    advice = run.status.advice
    assert advice.startswith(f"At {problem.instants[lost]:.4g} s, with traction = ")
    assert "no equilibrium was found" in advice
    assert "contact forces within friction could balance the loads" in advice


def test_a_rod_that_friction_alone_does_not_hold_is_told_so() -> None:
    run = solve(pulled_rod(10.0), watch=False)
    assert run.status.ending in (Ending.STALLED, Ending.EXHAUSTED)
    assert "friction alone seems not to hold what is pulled" in run.status.advice
    assert solve(pulled_rod(1000.0), watch=False).is_certified


def test_beyond_an_instant_without_solution_nothing_is_sought():
    problem = discretise(stacked())
    found = reference_of(problem)
    lost = int(np.argmin(found.converged))
    assert 0 < lost < problem.n_instants - 1
    assert not found.converged[lost:].any()
    assert found.contact_force[:, lost].any()
    assert not found.contact_force[:, lost + 1 :].any()
