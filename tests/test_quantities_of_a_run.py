"""Quantities of a run are what closed forms say, and say so where a run has none."""

from __future__ import annotations

import functools
import math
from itertools import islice
from typing import Any

import numpy as np
import pytest

from solver.latin import Solution, iterations
from solver.latin.status import CANCELLED
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.study.quantities.cycles import turning_points
from solver.study.quantities.finished import FinishedRun, finished_run
from solver.study.quantities.quantities import QUANTITIES, reading

STIFFNESS, BOUND = 210e9 * 3.14e-6, 1500.0
SMALL = {"elements": 20, "instants": 21, "substructures": 2}
DECIDED_BY_THE_LOAD = "residual_displacement", "holding_friction", "cycle_energy_ratio"
SMALL_BLOCK = {"elements": 12, "elements_up": 6, "instants": 13, "substructures": 1}


@functools.cache
def made(scene: str, errors: bool, changes: tuple[tuple[str, Any], ...]) -> FinishedRun:
    return finished_run(CATALOGUE[scene].settings.checked(dict(changes)), errors=errors)


def ran(scene: str, *, errors: bool = False, **changes: Any) -> FinishedRun:
    return made(scene, errors, tuple(changes.items()))


def taken(text: str, run: FinishedRun) -> float:
    return reading(text)(run)


@pytest.mark.parametrize("peak", [600.0, 900.0, 1200.0])
def test_the_end_of_the_bar_moves_as_the_closed_form_says(peak: float) -> None:
    run = ran("bar", load="cycle", peak=peak, instants=41)
    exact = peak**2 / (2.0 * STIFFNESS * BOUND)
    assert taken("end_displacement", run) == pytest.approx(exact, rel=1e-6)
    assert taken("peak_displacement", run) == pytest.approx(exact, rel=1e-6)
    assert taken("peak_slip", run) == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("peak", [600.0, 900.0, 1200.0])
def test_a_full_cycle_of_the_bar_dissipates_what_the_closed_form_says(peak: float) -> None:
    run = ran("bar", load="cycle", peak=peak, instants=41)
    exact = 2.0 * peak**3 / (3.0 * STIFFNESS * BOUND)
    assert taken("dissipation@1", run) == pytest.approx(exact, rel=2e-3)
    # The first pull takes a quarter of a full cycle: a front half as long, over half the way.
    assert taken("dissipation", run) == pytest.approx(1.25 * exact, rel=2e-3)


def test_the_energy_of_a_cycle_converges_with_the_mesh() -> None:
    exact = 2.0 * 900.0**3 / (3.0 * STIFFNESS * BOUND)
    errors = [
        abs(taken("dissipation@1", ran("bar", load="cycle", elements=n, instants=21)) / exact - 1.0)
        for n in (25, 50, 100)
    ]
    assert errors[0] > 3.0 * errors[1] > 9.0 * errors[2]


def test_unloading_and_loading_again_is_a_cycle_of_half_the_amplitude() -> None:
    """Masing's rule."""
    run = ran("bar", load=((0.0, 0.0), (1.0, 900.0), (2.0, 0.0), (3.0, 900.0)), duration=3.0)
    exact = 2.0 * 450.0**3 / (3.0 * STIFFNESS * BOUND)
    assert taken("dissipation@1", run) == pytest.approx(exact, rel=0.02)


def test_unloading_the_bar_leaves_half_of_its_displacement() -> None:
    run = ran("bar", load="triangle", **SMALL)
    left = taken("residual_displacement", run) / taken("end_displacement", run)
    assert left == pytest.approx(0.5, rel=1e-6)
    assert math.isnan(taken("residual_displacement", ran("bar", load="ramp", **SMALL)))


def test_the_bar_slips_as_far_as_its_load_reaches() -> None:
    run = ran("bar", load="ramp", peak=800.0, elements=60, instants=61)
    assert taken("slipped_share", run) == pytest.approx(800.0 / BOUND, abs=0.02)
    assert taken("peak_friction", run) == pytest.approx(800.0, rel=1e-6)
    assert taken("stuck_share", run) == pytest.approx(1.0 - 800.0 / BOUND, abs=0.02)
    assert taken("stiffness", run) == pytest.approx(2.0 * STIFFNESS * BOUND / 800.0, rel=1e-2)
    assert taken("first_slip_time", run) == run.problem.instants[1]
    reached = taken("first_slip_time@0.25", run)
    assert reached == pytest.approx(0.25 * BOUND / 800.0, abs=0.04)
    assert taken("first_slip_displacement@0.25", run) == pytest.approx(
        (800.0 * reached) ** 2 / (2.0 * STIFFNESS * BOUND), rel=0.02
    )
    assert taken("first_slip_time@0.75", run) == math.inf


@pytest.mark.parametrize(
    ("changes", "exact"),
    [({}, 0.2), ({"pressure": 2500.0}, 0.4), ({"peak": 300.0}, 0.1), ({"wires": 2}, 0.4)],
)
def test_a_broken_wire_regains_its_force_over_its_tension_by_the_friction(
    changes: dict[str, Any], exact: float
) -> None:
    changes = {"broken": 1, **changes} if "wires" in changes else changes
    run = ran("strand", load="ramp", **{"peak": 600.0, **changes}, instants=11)
    assert taken("recovery_length", run) == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize(
    ("scene", "changes", "exact"),
    [
        ("bar", {"peak": 900.0}, 0.18),
        ("bar", {"peak": 1600.0}, math.nan),
        ("incline", {"slope": 20.0, "friction": 0.5, "slack": 1.0}, math.tan(math.radians(20))),
        ("incline", {"slope": 20.0, "friction": 0.3, "slack": 1e-3}, math.nan),
    ],
)
def test_what_holds_as_a_whole_takes_the_load_over_what_presses(
    scene: str, changes: dict[str, Any], exact: float
) -> None:
    """F / (p L) where the slip has not come to the clamp, and the tangent of a slope."""
    sizes = SMALL if scene == "bar" else {"elements": 12, "elements_up": 4, "instants": 11}
    found = taken("holding_friction", ran(scene, **changes, **sizes))
    assert found == pytest.approx(exact, rel=1e-9, nan_ok=True)


def test_a_wire_that_never_regains_its_force_says_so() -> None:
    run = ran("strand", load="ramp", grip="displacement", friction=0.03, peak=2000.0, instants=11)
    assert taken("recovery_length", run) == math.inf
    assert math.isnan(taken("recovery_length", ran("strand", broken=0, instants=11)))


def test_counts_to_an_error_are_where_the_records_pass_it() -> None:
    run = ran(
        "bar", errors=True, method="paper", max_iterations=40, **{**SMALL, "substructures": 5}
    )
    number = int(taken("iterations_to_force@0.2", run))
    assert taken(f"error_force@{number}", run) <= 0.2 < taken(f"error_force@{number - 1}", run)
    records = run.solution.records
    assert taken("seconds_to_force@0.2", run) == records[number - 1].seconds
    assert taken("error_force", run) == records[-1].error_force
    assert taken("iterations_to_displacement@1e-12", run) == math.inf
    assert math.isnan(taken("error_force@41", run))
    assert taken("iterations", run) == 40


def test_a_run_without_errors_has_none() -> None:
    run = ran("bar", **SMALL)
    for text in ("iterations_to_force@0.1", "seconds_to_displacement@0.1", "error_force"):
        assert math.isnan(taken(text, run)), text


def test_more_instants_take_more_memory_and_a_field_of_them_is_the_least_of_it() -> None:
    found = [taken("memory", ran("bar", elements=200, instants=instants)) for instants in (51, 801)]
    field = 8.0 * 201 * (801 - 51)
    assert found[1] - found[0] > 3.0 * field
    assert found[1] < 1e3 * field


def test_modes_are_those_of_the_largest_basis_and_a_smooth_field_needs_fewer() -> None:
    run = ran("bar", linear_stage="pgd", pgd_modes=4, max_iterations=20, **SMALL)
    assert taken("modes", run) == 4
    full = ran("bar", **SMALL)
    assert math.isnan(taken("modes", full))
    displacement, force = (
        [taken(f"svd_modes_{field}@{level}", full) for level in (0.1, 0.01, 1e-3)]
        for field in ("displacement", "force")
    )
    assert displacement == sorted(displacement)
    assert force == sorted(force)
    assert displacement[1] < force[1] <= 21


def test_a_pressed_block_carries_what_presses_it() -> None:
    pressed = {"gap": "flat", "top": "traction", "top_normal_traction": -1e7}
    run = ran("block", **pressed, **SMALL_BLOCK)
    assert taken("peak_pressing", run) == pytest.approx(1e7 * 0.1, rel=1e-6)
    assert math.isnan(taken("peak_pressing", ran("bar", **SMALL)))


def test_a_block_pressed_without_friction_has_one_pressure_stress_and_width() -> None:
    pressed = {"gap": "flat", "top": "traction", "top_normal_traction": -1e7, "friction": 0.0}
    run = ran("block", plane="stress", **pressed, **SMALL_BLOCK)
    assert taken("peak_pressure", run) == pytest.approx(1e7, rel=1e-6)
    assert taken("peak_stress", run) == pytest.approx(1e7, rel=1e-6)
    assert taken("contact_width", run) == pytest.approx(0.1, rel=1e-9)
    bar = ran("bar", **SMALL)
    assert all(math.isnan(taken(name, bar)) for name in ("peak_pressure", "peak_stress"))


def test_the_largest_stress_below_a_contact_is_where_hertz_has_it() -> None:
    """Johnson, Contact Mechanics, 4.2: below the middle, at 0.70 of the half-width for nu = 0.3."""
    total = 2e7
    pressed = {"gap": "parabola", "radius": 1.0, "length": 0.1, "height": 0.05, "friction": 0.0}
    loaded = {"top": "traction", "top_normal_traction": -total / 0.1, "instants": 1}
    run = ran("block", elements=80, elements_up=40, poisson=0.3, **pressed, **loaded)
    half_width = 0.5 * taken("contact_width", run)
    assert 0.008 < half_width < 0.02
    assert taken("peak_stress_x", run) == pytest.approx(0.05, abs=0.1 / 80)
    assert taken("peak_stress_y", run) == pytest.approx(0.7 * half_width, abs=1.5 * 0.05 / 40)
    assert math.isnan(taken("peak_stress_x", ran("bar", **SMALL)))


def test_the_spring_carries_a_weight_that_nothing_else_holds() -> None:
    run = ran("incline", friction=0.0, elements=6, elements_up=4, instants=9, substructures=1)
    assert taken("spring_force", run) == pytest.approx(1000.0 * math.sin(math.radians(40.0)))
    assert math.isnan(taken("stiffness", run))


def test_compliant_friction_dissipates_by_slip_alone() -> None:
    """Below the bound the contact gives way, and gives back all that it took."""
    run = ran("bar", friction_law="compliant", contact_stiffness=1.0, peak=100.0, **SMALL)
    assert taken("slipped_share", run) == 0.0
    size = 100.0 * taken("peak_displacement", run)
    assert abs(taken("dissipation", run)) < 1e-12 * size


def test_a_loop_over_an_angle_has_no_displacement() -> None:
    run = ran("incline", elements=6, elements_up=4, instants=9, substructures=1)
    for name in ("end_displacement", "residual_displacement", "first_slip_displacement"):
        assert math.isnan(taken(name, run)), name


@pytest.mark.parametrize(
    ("path", "turns"),
    [
        ([0, 1, 2, 1, 0], [2]),
        ([0, -1, -2, -1, 0], [2]),
        ([0, 1, 0, -1, 0, 1], [1, 3, 5]),
        ([0, 1, 0, -1, 0, 0.5], [1, 3]),
        ([0, 1, 1, 0, 0, 1, 1, 0], [1, 3, 5, 7]),
        ([0, 0.5, 0.49, 1, 0], [3]),
        ([0, 0, 0], []),
    ],
)
def test_turning_points_are_where_a_path_turns_back(path: list[float], turns: list[int]) -> None:
    assert turning_points(np.array(path, dtype=float)) == turns


def test_there_are_no_cycles_beyond_those_of_the_load() -> None:
    run = ran("bar", load="cycle", peak=900.0, instants=41)
    assert math.isnan(taken("dissipation@2", run))


def test_every_quantity_can_be_taken_of_every_scene() -> None:
    for scene in CATALOGUE:
        run = ran(
            scene, errors=True, **(SMALL_BLOCK if CATALOGUE[scene].kind == "plane" else SMALL)
        )
        for name, quantity in QUANTITIES.items():
            if name == "memory" and scene != "bar":  # it takes a process of its own
                continue
            needed = quantity.parameter is not None and quantity.parameter.needed
            found = reading(f"{name}@0.1" if needed else name)
            assert isinstance(found(run), int | float), name
            assert found.title


@pytest.mark.parametrize(
    ("scene", "changes"),
    [
        ("bar", {}),
        ("bar", {"linear_stage": "pgd"}),
        ("strand", {}),
        ("strand", {"broken": 0}),
        ("incline", SMALL_BLOCK),
        ("block", SMALL_BLOCK),
        ("layers", {"elements_up": 2}),
        ("layers", {"elements_up": 2, "bending": "moment"}),
    ],
)
def test_a_quantity_that_does_not_apply_is_one_that_the_run_does_not_have(
    scene: str, changes: dict[str, Any]
) -> None:
    run = ran(scene, errors=True, **{**SMALL, **changes})
    # that of memory takes a process of its own
    for name, quantity in (one for one in QUANTITIES.items() if one[0] != "memory"):
        needed = quantity.parameter is not None and quantity.parameter.needed
        value = taken(f"{name}@0.1" if needed else name, run)
        if not quantity.applies(run.settings):
            assert math.isnan(value), name
        elif name not in DECIDED_BY_THE_LOAD:
            assert not math.isnan(value), name


@pytest.mark.parametrize("method", ["fast", "paper"])
@pytest.mark.parametrize("scene", CATALOGUE)
def test_what_is_zero_is_shown_as_zero_and_not_as_what_rounding_leaves(
    scene: str, method: str
) -> None:
    """Also at iterates on the way, such as one at which nothing touches yet."""
    settings = CATALOGUE[scene].settings.checked({"method": method})
    for iterate in islice(iterations(discretise(settings), method_of(settings)), 2):
        run = FinishedRun(settings, Solution(iterate, [], CANCELLED), has_errors=False)
        for values in (run.displacement, run.force):
            sizes = np.abs(values[values != 0.0])
            assert sizes.min(initial=1e300) > 1e-12 * sizes.max(initial=0.0)


def test_a_broken_strand_and_a_wire_that_comes_back_leave_no_residue() -> None:
    run = finished_run(CATALOGUE["strand"].settings.checked({}), errors=False, indicators=False)
    assert taken("holding_friction", run) == 0.0
    assert taken("ratchet", run) == 0.0
