"""The references against the formulas of solver/README.md, 6, and against each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.discrete.rods.rods import Rods
from solver.reference.closed_forms.pulled_bar import ClosedForm, closed_form
from solver.reference.incremental import incremental
from solver.scenes.bar import BarSettings, bar

BOUND = 1500.0
STIFFNESS = 659_400.0
EXACT = settings(max_examples=25)
FORCES = st.lists(st.floats(-2400.0, 2400.0), min_size=1, max_size=12)


def scene(**values: object) -> Rods:
    return bar(BarSettings.checked({"method": "paper", **values}))


def under(base: Rods, load: list[float] | np.ndarray) -> Rods:
    return replace(base, load=np.array(load), instants=np.linspace(0.0, 1.0, len(load)))


def solved(base: Rods) -> ClosedForm:
    found = closed_form(base)
    assert found is not None
    return found


def monotone_path(*corners: float, points: int = 20) -> np.ndarray:
    return np.interp(
        np.arange((len(corners) - 1) * points + 1) / points, range(len(corners)), corners
    )


@pytest.mark.parametrize("peak", [300.0, 900.0, 1500.0, 2400.0])
def test_loading_follows_the_front_until_the_whole_bar_slides(peak):
    base = scene(load="ramp", peak=peak)
    found = solved(base)
    x, force = base.nodes[:, None], base.load
    swept = np.maximum(0.0, x - 1.0 + force / BOUND)
    normal = np.maximum(0.0, force - BOUND * (1.0 - x))
    partly = BOUND / (2.0 * STIFFNESS) * swept**2
    fully = ((force - BOUND) * x + 0.5 * BOUND * x**2) / STIFFNESS
    displacement = np.where(force <= BOUND, partly, fully)
    np.testing.assert_allclose(found.normal_force, normal, rtol=0.0, atol=1e-12 * peak)
    scale = displacement.max()
    np.testing.assert_allclose(found.displacement, displacement, rtol=0.0, atol=1e-6 * scale)


@pytest.mark.parametrize("peak", [900.0, 1200.0, 1500.0])
def test_unloading_and_reloading_are_twice_as_stiff(peak):
    force = monotone_path(0.0, peak, -peak, peak)
    end = solved(under(scene(), force)).end_displacement
    most = peak**2 / (2.0 * STIFFNESS * BOUND)
    unloading = most - (peak - force[20:41]) ** 2 / (4.0 * STIFFNESS * BOUND)
    reloading = -most + (peak + force[40:]) ** 2 / (4.0 * STIFFNESS * BOUND)
    np.testing.assert_allclose(end[20:41], unloading, rtol=0.0, atol=1e-6 * most)
    np.testing.assert_allclose(end[40:], reloading, rtol=0.0, atol=1e-6 * most)


def loop_area(force: np.ndarray, end: np.ndarray) -> float:
    return float(np.trapezoid(force, end))


@pytest.mark.parametrize(("peak", "stated"), [(900.0, 0.4914), (1200.0, 1.1647)])
def test_a_closed_cycle_dissipates_two_thirds_of_the_cube_of_its_force(peak, stated):
    formula = 2.0 * peak**3 / (3.0 * STIFFNESS * BOUND)
    assert formula == pytest.approx(stated, abs=5e-5)
    force = monotone_path(0.0, peak, -peak, peak, points=400)
    found = solved(under(scene(), force))
    assert loop_area(force[400:], found.end_displacement[400:]) == pytest.approx(formula, rel=1e-5)


def test_dissipation_of_the_incremental_solution_converges_with_order_two():
    formula = 2.0 * 900.0**3 / (3.0 * STIFFNESS * BOUND)
    force = monotone_path(0.0, 900.0, -900.0, 900.0, points=400)
    sizes = np.array([10, 20, 40, 80])
    errors = []
    for elements in sizes:
        found = incremental(under(scene(elements=int(elements)), force).discretise())
        errors.append(abs(loop_area(force[400:], found.displacement[-1, 400:]) - formula))
    assert fitted_order(sizes, errors) == pytest.approx(2.0, abs=0.02)
    assert errors[-1] < 1e-3 * formula


def fitted_order(sizes: np.ndarray, errors: list[float]) -> float:
    return -float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


@EXACT
@given(FORCES, st.integers(1, 4))
def test_the_answer_does_not_depend_on_the_rate(corners, points):
    base = scene(elements=10)
    slowly = monotone_path(0.0, *corners, points=points)
    fast = solved(under(base, [0.0, *corners]))
    slow = solved(under(base, slowly))
    np.testing.assert_allclose(slow.displacement[:, ::points], fast.displacement, atol=1e-15)
    np.testing.assert_allclose(slow.normal_force[:, ::points], fast.normal_force, atol=1e-9)


@EXACT
@given(st.floats(-2400.0, 2400.0), st.floats(-2400.0, 2400.0), st.floats(0.0, 1.0))
def test_a_closed_inner_loop_leaves_no_trace(first, turn, depth):
    inside = turn + depth * (first - turn)
    load = [first, turn, inside, turn]
    base = under(scene(elements=20, friction_profile="rising"), load)
    exact, discrete = solved(base), incremental(base.discretise())
    for field in (exact.displacement, discrete.displacement):
        np.testing.assert_allclose(field[:, 3], field[:, 1], rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(exact.normal_force[:, 3], exact.normal_force[:, 1], atol=1e-9)


@EXACT
@given(FORCES, st.integers(1, 60))
def test_friction_forces_of_both_references_are_one_under_a_uniform_bound(load, elements):
    base = under(scene(elements=elements, substructures=1), load)
    exact, discrete = solved(base), incremental(base.discretise())
    off_the_clamp = slice(1, None)
    np.testing.assert_allclose(
        discrete.friction_force[off_the_clamp], exact.friction_force[off_the_clamp], atol=1e-9
    )


@pytest.mark.parametrize("profile", ["uniform", "rising", "falling"])
@pytest.mark.parametrize(("load", "peak"), [("sine", 900.0), ("random", 1200.0), ("sine", 2400.0)])
def test_incremental_displacement_converges_with_order_two(profile, load, peak):
    sizes = np.array([25, 50, 100, 200])
    errors = []
    for elements in sizes:
        base = scene(elements=int(elements), load=load, peak=peak, friction_profile=profile)
        exact, discrete = solved(base).displacement, incremental(base.discretise()).displacement
        errors.append(float(np.linalg.norm(discrete - exact) / np.linalg.norm(exact)))
    assert fitted_order(sizes, errors) > 1.8
    assert errors[-1] < 1e-4
