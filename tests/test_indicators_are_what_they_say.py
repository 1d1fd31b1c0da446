"""The LATIN indicator is the paper's; the k-free one is zero at the solution alone."""

from __future__ import annotations

import numpy as np
import pytest
from bars import SMALL, boundary_of, options, sample

from solver.latin import Iterate
from solver.latin.indicators import behaviour_indicator, latin_indicator
from solver.laws import Contact, Dirichlet, Neumann
from solver.reference.incremental import incremental
from solver.scenes import discretise
from solver.scenes.method import method_of


def iterate_of(problem, k, displacement, force):
    """Make the iterate whose linear and local stage both are one pair of fields."""
    incoming = displacement - force / k[:, None]
    return Iterate(
        number=1,
        seconds=0.0,
        problem=problem,
        k=k,
        outgoing=displacement + force / k[:, None],
        incoming=incoming,
        local_displacement=displacement,
        local_incoming=incoming,
    )


@pytest.mark.parametrize("number", [1, 4, 25])
@pytest.mark.parametrize("multiscale", [True, False])
def test_the_latin_indicator_is_equation_2(number, multiscale):
    iterate = sample(options(**SMALL, multiscale=multiscale, k_scale=2.0), number)
    problem, k = iterate.problem, iterate.k[:, None]
    time_step = 1.0 / (problem.n_instants - 1)

    def squared(displacement, force):
        return np.trapezoid((k * displacement**2 + force**2 / k).sum(axis=0), dx=time_step)

    linear = iterate.boundary_displacement, iterate.boundary_force
    local = iterate.local_displacement, iterate.boundary_local_force
    distance = squared(linear[0] - local[0], linear[1] - local[1])
    expected = distance / (0.5 * (squared(*linear) + squared(*local)))
    assert latin_indicator(iterate) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("load", ["sine", "random"])
@pytest.mark.parametrize(
    "change", [{}, {"body_force": 800.0, "support_displacement": 3e-4}], ids=str
)
def test_the_behaviour_indicator_vanishes_at_the_reference_and_nowhere_near_it(load, change):
    chosen = options(load=load, peak=1300.0, **change)
    problem = discretise(chosen)
    k = method_of(chosen).direction.of(problem)
    displacement, force = boundary_of(problem, incremental(problem))
    exact = behaviour_indicator(iterate_of(problem, k, displacement, force))
    assert 0.0 <= exact < 1e-8
    random = np.random.default_rng(5)
    for kind in (Contact, Dirichlet):
        (law,) = (one for one in problem.interfaces.values() if isinstance(one, kind))
        moved = displacement.copy()
        moved[law.rows] += 1e-3 * displacement.max() * random.normal(size=moved[law.rows].shape)
        assert behaviour_indicator(iterate_of(problem, k, moved, force)) > 1e-6
    for kind in (Contact, Neumann):
        (law,) = (one for one in problem.interfaces.values() if isinstance(one, kind))
        pulled = force.copy()
        pulled[law.rows] *= 1.01
        assert behaviour_indicator(iterate_of(problem, k, displacement, pulled)) > 1e-6


@pytest.mark.parametrize("number", [1, 5, 40, 200])
def test_the_behaviour_indicator_sees_no_k(number):
    iterate = sample(options(**SMALL), number)
    displacement, force = iterate.boundary_displacement, iterate.boundary_force
    found = [
        behaviour_indicator(iterate_of(iterate.problem, factor * iterate.k, displacement, force))
        for factor in (1e-3, 1.0, 40.0)
    ]
    assert found[1] > 0.0
    for other in (found[0], found[2]):
        assert other == pytest.approx(found[1], rel=1e-9, abs=1e-12)
