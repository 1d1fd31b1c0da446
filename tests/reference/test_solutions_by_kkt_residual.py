"""Fields that obey equilibrium and all laws are called solved, by whatever way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from runs import settings_of

from solver.latin import Ending, Stop, solve
from solver.reference.assembly import NoReferenceError
from solver.reference.distance import distance_to, kkt_residual
from solver.reference.incremental import reference_of
from solver.scenes import discretise
from solver.scenes.method import method_of

PRESSED = {
    "elements": 3,
    "elements_up": 8,
    "substructures": 3,
    "substructures_up": 3,
    "layers": 3,
    "instants": 11,
    "friction": 0.6,
    "pressure": 1e7,
    "deflection": 1e-6,
    "friction_law": "general",
    "tangential_stiffness": 2e12,
    "cohesion": 3e4,
}
"""Layers that are pressed at once, and then bent by little."""


@pytest.mark.parametrize("share", [0.001, 0.01, 0.1])
def test_sticking_points_carry_no_more_than_the_cap(share):
    settings = settings_of("layers", **PRESSED, friction_cap=share * 1e7)
    problem = discretise(settings)
    found = reference_of(problem)
    assert found.converged.all()
    assert kkt_residual(found, problem) < 1e-10
    for name, law in problem.contacts.items():
        carried = np.abs(found.contact(name).tangential_force)
        cap = share * 1e7 * law.by_point(law.weights)
        assert np.all(carried <= cap[:, None] * (1.0 + 1e-9))
    run = solve(
        problem, method_of(settings), distance=distance_to(found, problem), watch=False
    )
    assert run.is_certified
    assert run.records[-1].error_force < 1e-8


BLOCK = {
    "elements": 8,
    "elements_up": 4,
    "instants": 7,
    "friction_law": "general",
    "tangential_stiffness": 5e13,
    "friction_cap": 2e6,
}


@pytest.fixture
def _no_status_step(monkeypatch):
    def refuse(*_arguments):
        raise NoReferenceError("as if the problem were too large")

    monkeypatch.setattr("solver.latin.end.estimate.incremental_solver", refuse)


def without_status_step(finish, iterations):
    """Run the block for a number of iterations, to a tolerance out of reach."""
    settings = settings_of("block", **BLOCK, finish=finish)
    stop = Stop(tolerance=1e-300, iterations=iterations)
    return solve(discretise(settings), replace(method_of(settings), stop=stop))


@pytest.mark.usefixtures("_no_status_step")
@pytest.mark.parametrize("finish", ["at-once", "accuracy", "none"])
def test_an_iterate_that_obeys_all_laws_is_a_solution_without_a_status_step(finish):
    run = without_status_step(finish, 150)
    problem = run.iterate.problem
    assert run.status.ending is Ending.CONVERGED
    assert "laws hold up to rounding" in run.status.advice
    assert run.is_certified is (finish != "none")
    assert kkt_residual(run.iterate, problem) < 1e-10
    assert (
        distance_to(reference_of(problem), problem).of_friction_force(run.iterate)
        < 1e-8
    )


@pytest.mark.usefixtures("_no_status_step")
def test_an_early_iterate_is_no_solution():
    run = without_status_step("at-once", 20)
    assert run.status.ending is Ending.EXHAUSTED
    assert not run.is_certified


def test_the_residual_sees_a_side_that_is_not_where_it_is_moved_to():
    settings = settings_of(
        "bar", elements=4, substructures=1, right_end="held", right_displacement=1e-4
    )
    problem = discretise(settings)
    found = reference_of(problem)
    assert kkt_residual(found, problem) < 1e-12
    found.displacement[problem.prescribed[0]] += 1e-7
    assert kkt_residual(found, problem) > 1e-4
