"""The incremental solver satisfies equilibrium and Coulomb's law exactly, and always ends."""

from __future__ import annotations

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


def test_without_friction_the_bar_is_elastic():
    scene = bar(BarSettings.checked({"method": "paper", "friction": 0.0}))
    found = incremental(scene.discretise())
    elastic = scene.nodes[:, None] * scene.load / scene.stiffness
    np.testing.assert_allclose(found.displacement, elastic, rtol=0.0, atol=1e-15)
    assert not found.friction_force.any()
    assert np.all(found.status[1:] == np.sign(np.diff(scene.load, prepend=0.0)))


def test_friction_at_the_clamp_is_counted_only_while_it_moves():
    of = problem(peak=100.0, support_displacement=1e-3, support_load="triangle")
    still = incremental(problem(peak=2400.0))
    moving = incremental(of)
    assert not still.friction_force[0].any()
    assert np.array_equal(moving.status[0], np.sign(np.diff(of.prescribed[1][0], prepend=0.0)))
    np.testing.assert_allclose(moving.friction_force[0], -bounds(of)[0] * moving.status[0])


def test_a_stop_interrupts_between_instants():
    calls = iter([False, False, True])
    with pytest.raises(Interrupted):
        incremental(problem(), stop=lambda: next(calls))
    assert next(calls, None) is None
