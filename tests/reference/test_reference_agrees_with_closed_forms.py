"""The incremental solver obeys its equations exactly, and both references agree."""

from __future__ import annotations

import numpy as np
import pytest
from bars import pulled
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.discrete import discretise
from solver.discrete.problem import Problem
from solver.discrete.rods.rods import Rods
from solver.reference import rod_minimum as module
from solver.reference.assembly import Interrupted
from solver.reference.closed_forms.pulled_bar import ClosedForm, closed_form
from solver.reference.distance import kkt_residual
from solver.reference.incremental import reference_of
from solver.reference.solution import Reference
from solver.scenes.bar import BarSettings

EXACT = settings(max_examples=25)
FORCES = st.lists(st.floats(-2400.0, 2400.0), min_size=1, max_size=12)


def scene(**values: object) -> Rods:
    return BarSettings.checked({"method": "paper", **values}).structure()


def under(base: Rods, load: list[float] | np.ndarray) -> Rods:
    return pulled(base, load, instants=np.linspace(0.0, 1.0, len(load)))


def solved(base: Rods) -> ClosedForm:
    found = closed_form(base)
    assert found is not None
    return found


def fitted_order(sizes: np.ndarray, errors: list[float]) -> float:
    return -float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


@EXACT
@given(FORCES, st.integers(1, 4))
def test_the_answer_does_not_depend_on_the_rate(corners, points):
    base = scene(elements=10)
    path = [0.0, *corners]
    slowly = np.interp(
        np.arange(len(corners) * points + 1) / points, range(len(path)), path
    )
    fast = solved(under(base, path))
    slow = solved(under(base, slowly))
    np.testing.assert_allclose(
        slow.displacement[:, ::points], fast.displacement, atol=1e-15
    )
    np.testing.assert_allclose(
        slow.normal_force[:, ::points], fast.normal_force, atol=1e-9
    )


@EXACT
@given(st.floats(-2400.0, 2400.0), st.floats(-2400.0, 2400.0), st.floats(0.0, 1.0))
def test_a_closed_inner_loop_leaves_no_trace(first, turn, depth):
    inside = turn + depth * (first - turn)
    load = [first, turn, inside, turn]
    base = under(scene(elements=20, friction_profile="rising"), load)
    exact = solved(base)
    discrete = reference_of(discretise(base))
    for field in (exact.displacement, discrete.displacement):
        np.testing.assert_allclose(field[:, 3], field[:, 1], rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(
        exact.normal_force[:, 3], exact.normal_force[:, 1], atol=1e-9
    )


@EXACT
@given(FORCES, st.integers(1, 60))
def test_friction_forces_of_both_references_are_one_under_a_uniform_bound(
    load, elements
):
    base = under(scene(elements=elements, substructures=1), load)
    exact = solved(base)
    discrete = reference_of(discretise(base))
    off_the_clamp = slice(1, None)
    np.testing.assert_allclose(
        discrete.contact_force[off_the_clamp],
        exact.friction_force[off_the_clamp],
        atol=1e-9,
    )


@pytest.mark.parametrize("profile", ["uniform", "rising", "falling"])
@pytest.mark.parametrize(
    ("load", "peak"), [("sine", 900.0), ("random", 1200.0), ("sine", 2400.0)]
)
def test_incremental_displacement_converges_with_order_two(profile, load, peak):
    sizes = np.array([25, 50, 100, 200])
    errors = []
    for elements in sizes:
        base = scene(
            elements=int(elements), load=load, peak=peak, friction_profile=profile
        )
        exact = solved(base).displacement
        discrete = reference_of(discretise(base)).displacement
        errors.append(float(np.linalg.norm(discrete - exact) / np.linalg.norm(exact)))
    assert fitted_order(sizes, errors) > 1.8
    assert errors[-1] < 1e-4


EVERY = settings(max_examples=30)
EPS = float(np.finfo(float).eps)
SHARES = st.floats(-1.0, 1.0).map(lambda share: share if abs(share) > 1e-200 else 0.0)
"""Of the peak load; what is smaller leaves no digits once it is scaled."""


def problem(**values: object) -> Problem:
    return discretise(BarSettings.checked({"method": "paper", **values}).structure())


def table(values: list[float]) -> list[list[float]]:
    return [
        [float(x), y]
        for x, y in zip(np.linspace(0.0, 1.0, len(values)), values, strict=True)
    ]


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
            st.sampled_from(
                ["uniform", "gap", table([10.0**decade for decade in decades])]
            )
        ),
        "friction": draw(st.sampled_from([0.0, 0.3, 1.0])),
        "support_displacement": draw(st.sampled_from([0.0, 1e-5, 1e-2])),
        "body_force": draw(st.sampled_from([0.0, 500.0, 3000.0])),
    }
    return problem(**values)


def bounds(of: Problem) -> np.ndarray:
    law = of.friction
    most = law.tangential.largest_bound.max(axis=1)
    return np.bincount(law.points, weights=most)[:, None] * of.scales.force


def assert_coulomb(of: Problem, found: Reference) -> None:
    bound = bounds(of)
    force = found.contact_force
    status = found.status
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
    for given_force in of.prescribed_forces:
        load[of.row_dofs[given_force.rows]] += given_force.values
    displacement = found.displacement / of.scales.displacement
    inner = stiffness @ displacement
    outer = load + found.contact_force / of.scales.force
    fixed, prescribed = of.prescribed
    np.testing.assert_allclose(displacement[fixed], prescribed, rtol=0.0, atol=1e-16)
    size = np.abs(stiffness) @ np.abs(displacement) + np.abs(load).max(axis=0)
    moves = np.setdiff1d(np.arange(of.n_dofs), fixed)
    slack = 50.0 * EPS * of.n_instants * size.max()
    np.testing.assert_allclose(inner[moves], outer[moves], rtol=0.0, atol=slack)


@EVERY
@given(problems())
def test_every_bar_ends_in_equilibrium_and_obeys_coulomb(of):
    found = reference_of(of)
    assert_coulomb(of, found)
    assert_equilibrium(of, found)


def test_the_fallback_alone_finds_the_same_minimum(monkeypatch):
    of = problem(load="random", peak=1800.0, instants=15, friction_profile="gap")
    fast = reference_of(of)
    monkeypatch.setattr(module, "NEWTON_LIMIT", 1)
    slow = reference_of(of)
    assert kkt_residual(slow, of) <= 1e-11
    assert np.array_equal(slow.status, fast.status)
    np.testing.assert_allclose(
        slow.displacement, fast.displacement, rtol=0.0, atol=1e-15
    )


def test_decomposition_changes_nothing():
    whole, parts = (reference_of(problem(substructures=number)) for number in (1, 10))
    assert np.array_equal(whole.status, parts.status)
    np.testing.assert_allclose(
        whole.displacement, parts.displacement, rtol=0.0, atol=1e-15
    )
    np.testing.assert_allclose(
        whole.contact_force, parts.contact_force, rtol=0.0, atol=1e-9
    )


def test_a_stop_interrupts_between_instants():
    calls = iter([False, False, True])
    with pytest.raises(Interrupted):
        reference_of(problem(), stop=lambda: next(calls))
    assert next(calls, None) is None
