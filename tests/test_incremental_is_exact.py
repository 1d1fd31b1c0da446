"""The incremental solver satisfies equilibrium and Coulomb's law exactly, and always ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.discrete.problem import Problem
from solver.reference import search as module
from solver.reference.incremental import Interrupted, Reference, incremental
from solver.scenes.bar import BarSettings, bar

EXACT = settings(max_examples=60)
EPS = float(np.finfo(float).eps)
SHARES = st.floats(-1.0, 1.0).map(lambda share: share if abs(share) > 1e-200 else 0.0)
"""Of the peak load; what is smaller leaves no digits once it is scaled."""


def problem(**values: object) -> Problem:
    return bar(BarSettings.checked({"method": "paper", **values})).discretise()


def table(values: list[float]) -> list[list[float]]:
    return [[float(x), y] for x, y in zip(np.linspace(0.0, 1.0, len(values)), values, strict=True)]


@st.composite
def problems(draw: st.DrawFn) -> Problem:
    """Bars with any load path, one reversal an instant, and bounds over six decades."""
    elements = draw(st.integers(1, 80))
    load = draw(st.lists(SHARES, min_size=2, max_size=15))
    peak = draw(st.sampled_from([1.0, 900.0, 2400.0, 1e5]))
    decades = draw(st.lists(st.floats(-6.0, 0.0), min_size=2, max_size=12))
    values: dict[str, object] = {
        "elements": elements,
        "instants": len(load),
        "substructures": draw(st.integers(1, min(elements, 6))),
        "load": table([peak * force for force in load]),
        "friction_profile": draw(
            st.sampled_from(["uniform", "gap", table([10.0**decade for decade in decades])])
        ),
        "friction": draw(st.sampled_from([0.0, 0.3, 1.0])),
        "support_displacement": draw(st.sampled_from([0.0, 1e-5, 1e-2])),
        "body_force": draw(st.sampled_from([0.0, 500.0, 3000.0])),
    }
    return problem(**values)


def bounds(of: Problem) -> np.ndarray:
    law = of.friction
    return np.bincount(law.points, weights=law.tangential.most)[:, None] * of.scales.force


def assert_coulomb(of: Problem, found: Reference) -> None:
    bound, force, status = bounds(of), found.friction_force, found.status
    slip = np.diff(found.displacement, axis=1, prepend=0.0)
    slides = status != 0
    assert np.all(np.abs(force) <= bound * (1.0 + 4.0 * EPS))
    np.testing.assert_allclose(force[slides], (-bound * status)[slides], rtol=4.0 * EPS)
    assert np.all(slip[~slides] == 0.0)
    assert np.all(slip * status >= 0.0)


def assert_equilibrium(of: Problem, found: Reference) -> None:
    stiffness = np.zeros((of.n_dofs, of.n_dofs))
    load = np.zeros((of.n_dofs, of.n_instants))
    for part in of.substructures:
        stiffness[np.ix_(part.dofs, part.dofs)] += part.elasticity.stiffness.toarray()
        if part.body_force is not None:
            load[part.dofs] += part.body_force
    for pulled in of.given_forces:
        load[of.row_dofs[pulled.rows]] += pulled.values
    displacement = found.displacement / of.scales.displacement
    inner = stiffness @ displacement
    outer = load + found.friction_force / of.scales.force
    fixed, prescribed = of.prescribed
    np.testing.assert_allclose(displacement[fixed], prescribed, rtol=0.0, atol=1e-16)
    size = np.abs(stiffness) @ np.abs(displacement) + np.abs(load).max(axis=0)
    moves = np.setdiff1d(np.arange(of.n_dofs), fixed)
    slack = 50.0 * EPS * of.n_instants * size.max()
    np.testing.assert_allclose(inner[moves], outer[moves], rtol=0.0, atol=slack)


@EXACT
@given(problems())
def test_every_bar_ends_in_equilibrium_and_obeys_coulomb(of):
    found = incremental(of)
    assert found.residual <= 1e-12
    assert_coulomb(of, found)
    assert_equilibrium(of, found)


@pytest.mark.parametrize("load", ["ramp", "triangle", "cycle", "sine", "decaying", "random"])
@pytest.mark.parametrize("peak", [900.0, 2400.0])
def test_every_preset_is_solved_to_rounding(load, peak):
    of = problem(load=load, peak=peak, elements=100)
    found = incremental(of)
    assert found.residual <= 1e-13
    assert_coulomb(of, found)
    assert_equilibrium(of, found)


@pytest.mark.parametrize("elements", [1, 2, 7, 50, 300])
def test_full_reversals_at_every_instant_end(elements):
    of = problem(
        elements=elements, substructures=1, load=table([2400.0, -2400.0] * 10), instants=20
    )
    found = incremental(of)
    assert found.residual <= 1e-12
    assert np.all(found.status[1:] == np.resize([1, -1], 20))


def test_the_fallback_alone_finds_the_same_minimum(monkeypatch):
    of = problem(load="random", peak=1800.0, instants=15, friction_profile="gap")
    fast = incremental(of)
    monkeypatch.setattr(module, "NEWTON_LIMIT", 0)
    slow = incremental(of)
    assert slow.residual <= 1e-12
    assert np.array_equal(slow.status, fast.status)
    np.testing.assert_allclose(slow.displacement, fast.displacement, rtol=0.0, atol=1e-15)


def test_decomposition_changes_nothing():
    whole, parts = (incremental(problem(substructures=number)) for number in (1, 10))
    assert np.array_equal(whole.status, parts.status)
    np.testing.assert_allclose(whole.displacement, parts.displacement, rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(whole.friction_force, parts.friction_force, rtol=0.0, atol=1e-9)


def test_numbering_of_the_degrees_of_freedom_changes_nothing():
    of = problem(load="random", peak=1800.0)
    number = np.arange(of.n_dofs).reshape(-1, 3)[:, [1, 2, 0]].ravel()
    parts = tuple(replace(part, dofs=number[part.dofs]) for part in of.substructures)
    plain, mixed = incremental(of), incremental(replace(of, substructures=parts))
    assert np.array_equal(plain.status, mixed.status)
    np.testing.assert_allclose(mixed.displacement[number], plain.displacement, rtol=0.0, atol=1e-15)


def test_without_load_nothing_moves():
    found = incremental(problem(peak=0.0))
    assert not found.displacement.any()
    assert not found.friction_force.any()
    assert not found.status.any()
    assert found.residual == 0.0


def test_without_friction_the_bar_is_elastic():
    scene = bar(BarSettings.checked({"method": "paper", "friction": 0.0}))
    found = incremental(scene.discretise())
    elastic = scene.nodes[:, None] * scene.load / scene.stiffness
    np.testing.assert_allclose(found.displacement, elastic, rtol=0.0, atol=1e-15)
    assert not found.friction_force.any()
    assert np.all(found.status[1:] == np.sign(np.diff(scene.load, prepend=0.0)))


def test_one_instant_is_solved_from_rest():
    found = incremental(problem(instants=1, load="ramp", peak=900.0))
    assert found.displacement.shape == (51, 1)
    assert found.displacement[-1, 0] == pytest.approx(900.0**2 / (2 * 659_400.0 * 1500.0), rel=1e-3)


def test_a_held_load_sticks_everywhere_and_keeps_every_force():
    path = [[0.0, 0.0], [0.3, 900.0], [0.6, 900.0], [1.0, -900.0]]
    of = problem(load=path)
    found = incremental(of)
    held = (of.instants > 0.31) & (of.instants < 0.6)
    assert not found.status[:, held].any()
    assert np.ptp(found.displacement[:, held], axis=1).max() == 0.0
    assert np.ptp(found.friction_force[:, held], axis=1).max() < 1e-10


def test_friction_at_the_clamp_is_counted_only_while_it_moves():
    of = problem(peak=100.0, support_displacement=1e-3, support_load="triangle")
    still = incremental(problem(peak=2400.0))
    moving = incremental(of)
    assert not still.friction_force[0].any()
    assert np.array_equal(moving.status[0], np.sign(np.diff(of.prescribed[1][0], prepend=0.0)))
    np.testing.assert_allclose(moving.friction_force[0], -bounds(of)[0] * moving.status[0])


def test_twenty_thousand_elements_are_solved():
    of = problem(elements=20_000, instants=5, substructures=20, peak=1200.0)
    found = incremental(of)
    assert found.residual <= 1e-11
    assert_coulomb(of, found)


def test_a_stop_interrupts_between_instants():
    calls = iter([False, False, True])
    with pytest.raises(Interrupted):
        incremental(problem(), stop=lambda: next(calls))
    assert next(calls, None) is None
