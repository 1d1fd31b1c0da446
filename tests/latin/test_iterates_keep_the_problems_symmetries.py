"""Iterates keep the symmetries of their problem, and indicators are what they say."""

from __future__ import annotations

import numpy as np
import pytest
from bars import SMALL, boundary_of, options, relative, table
from runs import iterates, sample

from solver.latin import Iterate
from solver.laws import Contact, Dirichlet, Neumann
from solver.reference.incremental import reference_of
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of


def test_a_path_with_pauses_gives_every_iterate_again_with_pauses():
    forces = np.random.default_rng(1).uniform(-1500.0, 1500.0, 20)
    quick = options(**{**SMALL, "instants": 20}, load=table(forces))
    times = np.concatenate([[1, 3, 2, 5], np.full(16, 2)])
    paused = np.repeat(forces, times)
    slow = options(**{**SMALL, "instants": len(paused)}, load=table(paused))
    for number in (1, 5, 30):
        expected = np.repeat(sample(quick, number).displacement, times, axis=1)
        assert relative(sample(slow, number).displacement, expected) < 1e-12


@pytest.mark.parametrize("factor", [0.37, 8.0, -1.0])
def test_scaling_or_reversing_the_load_does_so_to_the_answer(factor):
    plain, scaled = (
        sample(options(**SMALL, peak=900.0 * c, pressure=5000.0 * abs(c)), 20)
        for c in (1.0, factor)
    )
    assert relative(scaled.displacement, factor * plain.displacement) < 1e-12
    assert relative(scaled.friction_force, factor * plain.friction_force) < 1e-12
    assert scaled.indicator == pytest.approx(plain.indicator, rel=1e-9)


@pytest.mark.parametrize("method", ["fast", "paper"])
@pytest.mark.parametrize(
    ("metre", "newton", "second"),
    [
        (1e3, 1.0, 1e3),
        (1.0 / 0.0254, 1.0 / 4.4482216152605, 1.0),
        (1e-3, 1e-9, 1.0 / 3600.0),
    ],
    ids=[
        "millimetres and milliseconds",
        "inches and pounds",
        "kilometres, giganewtons and hours",
    ],
)
def test_other_units_give_the_same_iterates(method, metre, newton, second):
    def in_units(metre, newton, second):
        table = BarSettings.checked({})
        values = {
            "length": table.length * metre,
            "section": table.section * metre**2,
            "young": table.young * newton / metre**2,
            "pressure": table.pressure * newton / metre,
            "peak": table.peak * newton,
            "duration": table.duration * second,
        }
        settings = BarSettings.checked({"method": method} | SMALL | values)
        return iterates(settings, 40)

    for own, other in zip(
        in_units(1.0, 1.0, 1.0), in_units(metre, newton, second), strict=True
    ):
        assert relative(other.displacement, own.displacement * metre) < 1e-10
        assert relative(other.friction_force, own.friction_force * newton) < 1e-10


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
    problem = iterate.problem
    k = iterate.k[:, None]
    time_step = 1.0 / (problem.n_instants - 1)

    def squared(displacement, force):
        return np.trapezoid(
            (k * displacement**2 + force**2 / k).sum(axis=0), dx=time_step
        )

    linear = iterate.boundary_displacement, iterate.boundary_force
    local = iterate.local_displacement, iterate.boundary_local_force
    distance = squared(linear[0] - local[0], linear[1] - local[1])
    expected = distance / (0.5 * (squared(*linear) + squared(*local)))
    assert iterate.indicator == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("load", ["sine", "random"])
@pytest.mark.parametrize(
    "change", [{}, {"body_force": 800.0, "support_displacement": 3e-4}], ids=str
)
def test_the_k_free_indicator_vanishes_at_the_reference_and_nowhere_near_it(
    load, change
):
    chosen = options(load=load, peak=1300.0, **change)
    problem = discretise(chosen)
    k = method_of(chosen).direction.of(problem)
    displacement, force = boundary_of(problem, reference_of(problem))
    exact = iterate_of(problem, k, displacement, force).violation
    assert 0.0 <= exact < 1e-8
    random = np.random.default_rng(5)
    for kind in (Contact, Dirichlet):
        (law,) = (one for one in problem.interfaces.values() if isinstance(one, kind))
        moved = displacement.copy()
        moved[law.rows] += (
            1e-3 * displacement.max() * random.normal(size=moved[law.rows].shape)
        )
        assert iterate_of(problem, k, moved, force).violation > 1e-6
    for kind in (Contact, Neumann):
        (law,) = (one for one in problem.interfaces.values() if isinstance(one, kind))
        pulled = force.copy()
        pulled[law.rows] *= 1.01
        assert iterate_of(problem, k, displacement, pulled).violation > 1e-6


@pytest.mark.parametrize("number", [1, 5, 40, 200])
def test_the_k_free_indicator_does_not_depend_on_k(number):
    iterate = sample(options(**SMALL), number)
    displacement = iterate.boundary_displacement
    force = iterate.boundary_force
    found = [
        iterate_of(iterate.problem, factor * iterate.k, displacement, force).violation
        for factor in (1e-3, 1.0, 40.0)
    ]
    assert found[1] > 0.0
    for other in (found[0], found[2]):
        assert other == pytest.approx(found[1], rel=1e-9, abs=1e-12)


def short(**values):
    return BarSettings.checked({"method": "paper", "instants": 31, **values})


@pytest.mark.parametrize(
    "change", [{}, {"multiscale": False}, {"body_force": 800.0}], ids=str
)
@pytest.mark.parametrize("substructures", [1, 10])
def test_dense_and_sparse_boundary_responses_agree(monkeypatch, change, substructures):
    chosen = short(substructures=substructures, **change)
    dense = sample(chosen, 25)
    monkeypatch.setattr("solver.latin.stages.response.DENSE_UP_TO", 0)
    sparse = sample(chosen, 25)
    assert relative(sparse.outgoing, dense.outgoing) < 1e-10
    assert relative(sparse.incoming, dense.incoming) < 1e-10
