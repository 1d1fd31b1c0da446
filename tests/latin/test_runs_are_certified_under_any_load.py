"""Overlaps and prescribed displacements of any size drive runs as loads do.

The smallest and the largest sizes are far from any that is physical: what is rounding
is so beside what drives, and not beside one newton or one metre.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.latin import solve
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.load_paths import PRESETS

PLANE = {"elements": 12, "elements_up": 6, "substructures": 2, "instants": 9}
RODS = {"elements": 20, "instants": 21}
YOUNG = 2.1e11
POISSON = 0.3
WEIGHT = 7.8e4


def gap(left: float, right: float) -> list[list[float]]:
    return [[0.0, left], [0.1, right]]


def driven(size: float) -> dict[str, tuple[str, dict[str, Any]]]:
    """Scenes driven by a length, m, and no load but a tiny one in one of them."""
    clamped = {**PLANE, "top": "clamped"}
    moved = {**PLANE, "top": "displacement", "top_normal_displacement": 0.0}
    overlap = gap(-size, -size)
    return {
        "overlap": ("block", {**clamped, "gap": overlap}),
        "overlap at one end": ("block", {**clamped, "gap": gap(-size, size)}),
        "overlap, dragged": (
            "block",
            {**moved, "gap": overlap, "top_tangential_displacement": 0.5 * size},
        ),
        "overlap of a free body": ("block", {**PLANE, "top": "free", "gap": overlap}),
        "a gap that is closed": (
            "block",
            {
                **moved,
                "gap": gap(size, 2.0 * size),
                "top_normal_displacement": -3.0 * size,
                "top_tangential_displacement": size,
            },
        ),
        "a stack that is bent": (
            "layers",
            {
                **PLANE,
                "elements_up": 2,
                "layers": 3,
                "pressure": 0.0,
                "deflection": size,
            },
        ),
        "a support that moves": (
            "bar",
            {**RODS, "peak": 0.0, "support_displacement": size},
        ),
        "a grip that moves": ("strand", {**RODS, "grip": "displacement", "peak": size}),
        "a strand that is bent": (
            "rope",
            {**RODS, "layers": 2, "curvature": min(size, 1e3)},
        ),
    }


@settings(max_examples=14)
@given(
    st.sampled_from(sorted(driven(1.0))),
    st.floats(-14.0, 0.0).map(lambda power: 10.0**power),
    st.sampled_from([0.0, 0.3]),
)
def test_a_run_is_certified_whatever_drives_it_and_however_little(
    name: str, size: float, friction: float
) -> None:
    scene, values = driven(size)[name]
    if scene == "block":
        values = {**values, "friction": friction}
    chosen = CATALOGUE[scene].checked(values)
    problem = discretise(chosen)
    assert reference_of(problem).converged.all()
    assert solve(problem, method_of(chosen), watch=False).is_certified


LEAST = [
    ("rope", {**RODS, "layers": 2, "curvature": 1e-300}),
    ("strand", {**RODS, "peak": 1e-200}),
    ("fault", {"shear_stress": 1e-200, "elements": 24, "instants": 5}),
]


@pytest.mark.parametrize(("scene", "values"), LEAST)
def test_a_run_is_certified_though_squares_of_what_drives_it_vanish(
    scene: str, values: dict[str, Any]
) -> None:
    chosen = CATALOGUE[scene].checked(values)
    assert solve(discretise(chosen), method_of(chosen), watch=False).is_certified


@pytest.mark.parametrize("size", [1e-14, 1e-3, 1e6])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_an_overlap_between_rollers_presses_as_uniaxial_strain_does(
    size: float, friction: float
) -> None:
    held = dict.fromkeys(("left", "right", "top"), "roller")
    values = PLANE | held | {"gap": gap(-size, -size), "friction": friction}
    problem = discretise(CATALOGUE["block"].checked(values))
    found = reference_of(problem)
    modulus = YOUNG * (1.0 - POISSON) / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON))
    pressed = found.contact("support").normal_force.sum(axis=0)
    assert found.converged.all()
    np.testing.assert_allclose(pressed, modulus * size / 0.05 * 0.1, rtol=1e-10)


@pytest.mark.parametrize("size", [1e-9, 1e-3, -1e-6, -0.1])
@pytest.mark.parametrize("tilt", [1.0, 2.0])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_body_that_falls_or_rises_onto_its_support_presses_with_its_weight(
    size: float, tilt: float, friction: float
) -> None:
    values = {**PLANE, "top": "free", "body_force_y": -WEIGHT, "friction": friction}
    chosen = CATALOGUE["block"].checked({**values, "gap": gap(size, tilt * size)})
    problem = discretise(chosen)
    found = reference_of(problem)
    pressed = found.contact("support").normal_force
    assert found.converged.all()
    weight = WEIGHT * 0.1 * 0.05 * PRESETS[chosen.body_load].value(chosen.times(), 1)
    # Of how far it moves, rounding leaves a deformation.
    left = 1e-14 * YOUNG * abs(tilt * size)
    np.testing.assert_allclose(pressed.sum(axis=0), weight, rtol=1e-9, atol=left)
    assert solve(problem, method_of(chosen), watch=False).is_certified


def test_forces_that_rounding_of_a_fall_hides_are_not_called_found() -> None:
    """A body of steel that falls by 1000 km:
    a double has no digits left of how it deforms.
    """
    values = {**PLANE, "top": "free", "body_force_y": -WEIGHT, "gap": gap(1e6, 1e6)}
    found = reference_of(discretise(CATALOGUE["block"].checked(values)))
    assert not found.converged[1:].any()
