"""Quantities of a run and of the cycles of its load are what closed forms say."""

from __future__ import annotations

import functools
import math
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_scenes import SMALL as SMALL_SCENES

from solver.discrete.rope.rope import Rope
from solver.latin import Solution, iterations
from solver.latin.end.status import CANCELLED
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.study.lessons import lesson_from_file
from solver.study.quantities import QUANTITIES, reading
from solver.study.quantities.cycles import LoadCycles, cycles_of, fate_of, n_cycles_of
from solver.study.quantities.finished import FinishedRun
from solver.study.scene_run import finished_run

STIFFNESS = 210e9 * 3.14e-6
BOUND = 1500.0
SMALL = {"elements": 20, "instants": 21, "substructures": 2}
DECIDED_BY_THE_LOAD = (
    "residual_displacement",
    "holding_friction",
    "cycle_energy_ratio",
    "displacement",
    "force",
)
SMALL_BLOCK = {"elements": 12, "elements_up": 6, "instants": 13, "substructures": 1}


@functools.cache
def made(scene: str, errors: bool, changes: tuple[tuple[str, Any], ...]) -> FinishedRun:
    return finished_run(CATALOGUE[scene].checked(dict(changes)), errors=errors)


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
    assert taken("stiffness", run) == pytest.approx(
        2.0 * STIFFNESS * BOUND / 800.0, rel=1e-2
    )
    assert taken("first_slip_time", run) == run.problem.instants[1]
    reached = taken("first_slip_time@0.25", run)
    assert reached == pytest.approx(0.25 * BOUND / 800.0, abs=0.04)
    assert taken("first_slip_displacement@0.25", run) == pytest.approx(
        (800.0 * reached) ** 2 / (2.0 * STIFFNESS * BOUND), rel=0.02
    )
    assert taken("first_slip_time@0.75", run) == math.inf


@pytest.mark.parametrize(
    ("scene", "changes", "exact"),
    [
        ("bar", {"peak": 900.0}, 0.18),
        ("bar", {"peak": 1600.0}, math.nan),
        (
            "incline",
            {"slope": 20.0, "friction": 0.5, "slack": 1.0},
            math.tan(math.radians(20)),
        ),
        ("incline", {"slope": 20.0, "friction": 0.3, "slack": 1e-3}, math.nan),
    ],
)
def test_holding_friction_is_load_over_pressing_force(
    scene: str, changes: dict[str, Any], exact: float
) -> None:
    """F / (p L) where slip has not come to the clamp, and the tangent of a slope."""
    if scene == "bar":
        sizes = SMALL
    else:
        sizes = {"elements": 12, "elements_up": 4, "instants": 11}
    found = taken("holding_friction", ran(scene, **changes, **sizes))
    assert found == pytest.approx(exact, rel=1e-9, nan_ok=True)


@pytest.mark.parametrize(
    ("scene", "changes", "most"),
    [
        ("bar", {"peak": 900.0}, 1500.0),
        ("bar", {"peak": 900.0, "friction": 0.0}, 0.0),
        ("incline", {"slope": 20.0, "friction": 0.5, "weight": 2e3}, 940.0),
    ],
)
def test_holding_force_is_mu_times_the_pressing_force(
    scene: str, changes: dict[str, Any], most: float
) -> None:
    """mu p L along the bar, mu W cos(slope) on the incline."""
    if scene == "bar":
        sizes = SMALL
    else:
        sizes = {"elements": 12, "elements_up": 4, "instants": 11}
    assert taken("holding_force", ran(scene, **changes, **sizes)) == pytest.approx(
        most, rel=1e-3
    )


def test_wires_that_stretch_alike_rub_by_nothing_and_could_hold_by_all() -> None:
    """Rounding takes no energy, and is no share of friction that is in use.

    So the force that could hold is that of the instant at which the most presses: it
    was that at which rounding was largest.
    """
    run = ran(
        "strand",
        broken=0,
        wires=4,
        elements=6,
        instants=36,
        substructures=1,
        pressure_load="tightening",
        friction_law="compliant",
    )
    for name in ("dissipation", "peak_slip", "ratchet", "holding_friction"):
        assert taken(name, run) == 0.0
    assert taken("holding_force", run) == pytest.approx(1500.0)


@pytest.mark.parametrize("grip", ["force", "displacement"])
@pytest.mark.parametrize("elements", [2, 7, 20])
def test_wires_press_on_each_other_up_to_their_clamp(elements: int, grip: str) -> None:
    """mu p L on any mesh: the node at the clamp, which does not rub, was left out."""
    sizes = {"elements": elements, "substructures": 2, "instants": 11}
    run = ran("strand", grip=grip, peak=300.0, **sizes)
    assert taken("holding_force", run) == pytest.approx(1500.0, rel=1e-12)


@pytest.mark.parametrize("elements", [10, 23])
def test_a_wire_of_a_rope_presses_from_clamp_to_end(elements: int) -> None:
    """T sin^2(alpha) / R a metre of wire, of six around a core (Costello)."""
    run = ran("rope", layers=1, tension=4e4, elements=elements, substructures=2)
    structure = run.settings.structure()
    assert isinstance(structure, Rope)
    wire = structure.wires[0]
    tension = float(wire.tension[-1])
    across = math.sin(wire.layer_data.lay) ** 2 / wire.radius
    exact = run.settings.friction * tension * across * wire.length
    assert taken("holding_force", run) == pytest.approx(exact, rel=1e-9)


def test_a_block_that_only_its_side_holds_presses_on_nothing() -> None:
    """Rounding of its weight along the support pressed, rubbed, and slid as a whole."""
    run = ran(
        "block",
        top="free",
        right="roller",
        gap="parabola",
        radius=5e4,
        height=0.001,
        length=0.08,
        body_force_x=-5e8,
        elements=22,
        elements_up=6,
        instants=4,
        substructures=11,
        substructures_up=3,
    )
    assert run.solution.is_certified
    names = ("peak_pressing", "peak_pressure", "peak_friction", "peak_slip")
    names += ("holding_friction", "holding_force", "contact_width", "dissipation")
    assert {name: taken(name, run) for name in names} == dict.fromkeys(names, 0.0)


def test_reactions_of_both_sides_balance() -> None:
    """Layers bent at one end and held at the other carry nothing else along y."""
    run = ran("layers", elements=12, instants=11, substructures=2)
    assert taken("left_force", run) == pytest.approx(
        taken("right_force", run), rel=1e-6
    )
    assert taken("right_force", run) == pytest.approx(np.abs(run.force).max(), rel=1e-9)
    assert math.isnan(taken("top_force", run))


def test_counts_to_an_error_are_where_the_records_pass_it() -> None:
    run = ran(
        "bar",
        errors=True,
        method="paper",
        max_iterations=40,
        **{**SMALL, "substructures": 5},
    )
    number = int(taken("iterations_to_force@0.2", run))
    assert (
        taken(f"error_force@{number}", run)
        <= 0.2
        < taken(f"error_force@{number - 1}", run)
    )
    records = run.solution.records
    assert taken("seconds_to_force@0.2", run) == records[number - 1].seconds
    assert taken("error_force", run) == records[-1].error_force
    assert taken("iterations_to_displacement@1e-12", run) == math.inf
    assert math.isnan(taken("error_force@41", run))
    assert taken("iterations", run) == 40


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


def test_a_block_pressed_without_friction_has_one_pressure_stress_and_width() -> None:
    pressed = {
        "gap": "flat",
        "top": "traction",
        "top_normal_traction": -1e7,
        "friction": 0.0,
    }
    run = ran("block", plane="stress", **pressed, **SMALL_BLOCK)
    assert taken("peak_pressure", run) == pytest.approx(1e7, rel=1e-6)
    assert taken("peak_stress", run) == pytest.approx(1e7, rel=1e-6)
    assert taken("contact_width", run) == pytest.approx(0.1, rel=1e-9)
    bar = ran("bar", **SMALL)
    assert all(
        math.isnan(taken(name, bar)) for name in ("peak_pressure", "peak_stress")
    )


def test_the_largest_stress_below_a_contact_is_where_hertz_has_it() -> None:
    """Johnson, Contact Mechanics, 4.2: at a depth of 0.70 half-widths for nu = 0.3."""
    total = 2e7
    pressed = {
        "gap": "parabola",
        "radius": 1.0,
        "length": 0.1,
        "height": 0.05,
        "friction": 0.0,
    }
    loaded = {"top": "traction", "top_normal_traction": -total / 0.1, "instants": 1}
    run = ran("block", elements=80, elements_up=40, poisson=0.3, **pressed, **loaded)
    half_width = 0.5 * taken("contact_width", run)
    assert 0.008 < half_width < 0.02
    assert taken("peak_stress_x", run) == pytest.approx(0.05, abs=0.1 / 80)
    assert taken("peak_stress_y", run) == pytest.approx(
        0.7 * half_width, abs=1.5 * 0.05 / 40
    )
    assert math.isnan(taken("peak_stress_x", ran("bar", **SMALL)))


def test_the_spring_carries_a_weight_that_nothing_else_holds() -> None:
    run = ran(
        "incline", friction=0.0, elements=6, elements_up=4, instants=9, substructures=1
    )
    assert taken("spring_force", run) == pytest.approx(
        1000.0 * math.sin(math.radians(40.0))
    )
    assert math.isnan(taken("stiffness", run))


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
def test_quantities_apply_where_runs_have_them(
    scene: str, changes: dict[str, Any]
) -> None:
    run = ran(scene, errors=True, **(SMALL | changes))
    for name, quantity in QUANTITIES.items():
        needed = quantity.parameter is not None and quantity.parameter.needed
        value = taken(f"{name}@0.1" if needed else name, run)
        if not quantity.applies(run.settings):
            assert math.isnan(value), name
        elif name not in DECIDED_BY_THE_LOAD:
            assert not math.isnan(value), name


@pytest.mark.parametrize("scene", CATALOGUE)
def test_zero_quantities_are_shown_without_rounding_errors(
    scene: str,
) -> None:
    """Also at iterates on the way, such as one at which nothing touches yet."""
    settings = CATALOGUE[scene].checked(SMALL_SCENES[scene] | {"method": "paper"})
    for iterate in islice(iterations(discretise(settings), method_of(settings)), 2):
        run = FinishedRun(settings, Solution(iterate, [], CANCELLED))
        for values in (run.displacement, run.force):
            sizes = np.abs(values[values != 0.0])
            assert sizes.min(initial=1e300) > 1e-12 * sizes.max(initial=0.0)


TIMES = {"load": "cycles", "instants": 161}
LESSON = Path(__file__).parents[2] / "app/lessons/shakedown.toml"
ROCKED = {
    "gap": "flat",
    "elements": 16,
    "elements_up": 8,
    "substructures": 1,
    "instants": 121,
    "top": "traction",
    "body_force_y": -2e8,
    "top_normal_traction": -1e6,
    "top_normal_load": "cycles",
    "top_tangential_load": "hold",
}
"""A block that its weight holds down, rocked from above."""


def cut(run: FinishedRun) -> LoadCycles:
    return cycles_of(run.settings, run.iterate)


def of(
    slip: list[list[float]], net: list[list[float]] | None = None, **more: Any
) -> LoadCycles:
    """Make cycles of points whose slip, and what is left of it, is given."""
    slips = np.array(slip, dtype=float)
    values = {
        "ends": list(range(slips.shape[1] + 1)),
        "slip": slips,
        "net": np.zeros_like(slips) if net is None else np.array(net, dtype=float),
        "work": slips,
        "before": np.ones(len(slips)),
        "is_repeated": True,
    }
    return LoadCycles(**(values | more))


STEADY = [[2, 2, 2]]


@pytest.mark.parametrize(
    ("slip", "net", "said"),
    [
        ([[2, 1, 0, 0]], None, "elastic shakedown"),
        ([[2, 1, 0.5]], None, "shakedown with slip that dies"),
        ([[8, 4, 1]], None, "shakedown with slip that dies"),
        ([[9, 2, 2, 2]], None, "steady slip"),
        # It falls, but to what it will not fall below; or too slowly to tell.
        ([[2, 1.5, 1.25]], None, None),
        ([[1, 0.97, 0.941]], None, None),
        ([[1, 2, 3]], None, None),
        ([[2, 2]], None, None),
        # Each point for itself: what is largest says nothing of where.
        ([[2, 1, 2], [1, 2, 1]], None, None),
        # Only what goes on one way ratchets.
        (STEADY, [[1, 1, 1]], "ratcheting"),
        (STEADY, [[-1, -1, -1]], "ratcheting"),
        (STEADY, [[1, 0.1, 0.01]], "steady slip"),
        (STEADY, [[1, -1, 1]], "steady slip"),
        (STEADY, [[1, 0.8, 0.6]], "steady slip"),
    ],
)
def test_slip_is_classified_by_its_last_three_cycles(
    slip: list[list[float]], net: list[list[float]] | None, said: str | None
) -> None:
    assert fate_of(of(slip, net)) == said


def test_slip_is_not_classified_without_slip_or_with_unequal_cycles() -> None:
    still = of([[0, 0, 0]])
    assert fate_of(still) == "elastic shakedown"
    assert fate_of(of([[0, 0, 0]], before=np.zeros(1))) is None
    assert fate_of(of([[2, 2, 2]], is_repeated=False)) is None


@pytest.mark.parametrize("peak", [600.0, 900.0, 1200.0])
def test_every_cycle_of_the_bar_takes_what_the_closed_form_says(peak: float) -> None:
    run = ran("bar", peak=peak, **TIMES)
    cycles = cut(run)
    exact = 2.0 * peak**3 / (3.0 * STIFFNESS * BOUND)
    np.testing.assert_allclose(cycles.energy, exact, rtol=3e-3)
    assert [reading(f"dissipation@{n}")(run) for n in range(1, 6)] == pytest.approx(
        cycles.energy
    )
    assert math.isnan(reading("dissipation@6")(run))
    # The end moves by u to one side and the other, and so twice to and fro.
    assert cycles.slip[-1] == pytest.approx(
        4.0 * peak**2 / (2.0 * STIFFNESS * BOUND), rel=1e-6
    )


def test_a_weight_that_is_constant_but_for_rounding_leaves_cycles_alike() -> None:
    run = ran("incline", slope_load="cycles", instants=61)
    cycles = cut(run)
    assert np.ptp(cycles.energy) < 1e-6 * cycles.energy[0]
    assert fate_of(cycles) == "steady slip"


def lesson(**changes: Any) -> FinishedRun:
    return finished_run(
        lesson_from_file(LESSON).settings.replace(**changes), errors=False
    )


def test_the_lesson_on_shakedown_shows_slip_that_dies_and_slip_that_does_not() -> None:
    dying = cut(lesson())
    steady = cut(lesson(friction=0.15))
    assert fate_of(dying) == "shakedown with slip that dies"
    assert fate_of(steady) == "steady slip"
    ratios = [one.slip[:, -1].max() / one.slip[:, -2].max() for one in (dying, steady)]
    assert ratios[0] < 0.9 < 0.99 < ratios[1] < 1.01
    assert fate_of(cut(lesson(friction=0.6))) is None


def test_a_rocked_block_walks_the_way_it_is_sheared() -> None:
    """Below its friction at every instant, and farther in each cycle, at all points."""
    moved = []
    for shear in (2e6, -2e6):
        run = ran(
            "block",
            **ROCKED,
            top_normal_slope=math.copysign(10.0, shear),
            top_tangential_traction=shear,
        )
        cycles = cut(run)
        assert fate_of(cycles) == "ratcheting"
        assert np.ptp(cycles.net[:, -1]) < 0.3 * np.abs(cycles.net[:, -1]).max()
        moved.append(cycles.net[:, -1])
    assert moved[0].min() > 0.0
    np.testing.assert_allclose(moved[1], -moved[0][::-1], rtol=1e-6)
    assert reading("ratchet")(run) == np.abs(moved[1]).max()


COMES_BACK = {
    "fault": {"injection_load": "pulses"},
    "belt": {"pull_load": "delayed"},
}
"""Of scenes whose usual load does not, one that does."""


@pytest.mark.parametrize("scene", CATALOGUE)
def test_every_scene_has_as_many_cycles_as_it_is_asked_for(scene: str) -> None:
    """A preset with one cycle more has as many cycles more of the load."""
    settings = CATALOGUE[scene]
    values = {"instants": 401, **COMES_BACK.get(scene, {})}
    counted = [
        n_cycles_of(settings.checked({**values, "cycles": n})) for n in (2, 3, 9)
    ]
    more = counted[1] - counted[0]
    assert more >= 1
    assert counted[2] == counted[0] + 7 * more
