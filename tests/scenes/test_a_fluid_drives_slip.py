"""A fluid along a fault drives a slip front as published."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import solve_banded
from scipy.special import erfc

from solver import discrete
from solver.arrays import Array
from solver.discrete.plane.rectangles.sides import Side, SideComponent, Support
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.problem import Problem
from solver.files.saved import dump, read_settings, settings_from_command
from solver.latin import Auto, Ending, Latin, Stop, solve
from solver.reference.closed_forms.fluid_driven_slip import (
    fronts,
    slip_under_growing_strength,
    spread,
    stress_ahead,
)
from solver.reference.incremental import reference_of
from solver.reference.solution import Reference
from solver.scenes import discretise
from solver.scenes.fault import FaultSettings
from solver.settings.values import SettingError
from solver.study.quantities import reading
from solver.study.scene_run import finished_run

SMALL = {"elements": 48, "elements_up": 24, "instants": 31}


def solved(**changes: Any) -> tuple[FaultSettings, Problem, Reference]:
    settings = FaultSettings.checked(SMALL | changes)
    problem = discretise(settings)
    return settings, problem, reference_of(problem)


def reached(problem: Problem, found: Reference) -> Array:
    """Farthest place that slips at every instant, (n_instants,), m."""
    slips = found.contact("support").status == 1
    return np.where(slips, problem.contacts["support"].positions[:, None], 0.0).max(
        axis=0
    )


def test_pressure_spreads_as_diffusion_has_it_whatever_is_given_at_the_well() -> None:
    """Crank and Nicolson's steps on a fine line, for a pressure up and down."""
    length = 12.0
    parts = 600
    step = 0.05
    rate = 0.7
    place = np.linspace(0.0, length, parts + 1)
    instants = np.arange(41) * step
    given = np.where(instants < 1.0, 1.0 + instants, 2.0 - 1.2 * (instants - 1.0))
    found = spread(place, instants, given, rate)
    many = 40
    share = 0.5 * rate * step / many / place[1] ** 2
    bands = np.zeros((3, parts - 1))
    bands[0, 1:] = bands[2, :-1] = -share
    bands[1] = 1.0 + 2.0 * share
    now = np.zeros(parts + 1)
    for instant in range(1, len(instants)):
        for part in range(1, many + 1):
            now[0] = np.interp(
                (part - 1) / many, [0, 1], given[instant - 1 : instant + 1]
            )
            right = now[1:-1] + share * (now[2:] - 2.0 * now[1:-1] + now[:-2])
            now[0] = np.interp(part / many, [0, 1], given[instant - 1 : instant + 1])
            right[0] += share * now[0]
            now[1:-1] = solve_banded((1, 1), bands, right)
        if instant > 3:
            assert now == pytest.approx(found[:, instant], abs=3e-4)


def test_stress_ahead_of_a_zone_holds_the_balance_of_forces() -> None:
    """Surroundings carry the load of a zone: the sum over the line is nothing."""
    place = np.linspace(0.0, 4.0, 4001)
    lack = (0.5 - erfc(place))[:, None]
    (front,) = fronts(place, lack)
    angle = (np.arange(4000) + 0.5) * np.pi / 8000
    within = front * np.sum(
        np.interp(front * np.sin(angle), place, lack[:, 0]) * np.cos(angle)
    )
    # Beyond, x = a / s, so that all of it is seen, and ds / s^2 of it is dx.
    share = (np.arange(20000) + 0.5) / 20000
    beyond = front * np.mean(
        stress_ahead(front / share, place, lack[:, 0], front) / share**2
    )
    assert within * np.pi / 8000 + beyond == pytest.approx(0.0, abs=2e-4)


@pytest.mark.parametrize(
    "changes", [{"young": 1e9}, {"poisson": 0.0}, {"plane": "stress"}]
)
def test_the_front_does_not_depend_on_the_elastic_constants(
    changes: dict[str, Any],
) -> None:
    """As published: only slip does. It may differ by the width of an element."""
    _, problem, usual = solved()
    _, _, other = solved(**changes)
    apart = np.abs(reached(problem, usual) - reached(problem, other))
    assert apart.max() <= 1.001 * problem.contacts["support"].positions[1]
    assert reached(problem, usual)[-1] > 100.0


def test_the_front_does_not_depend_on_the_size_of_the_body() -> None:
    _, problem, usual = solved()
    larger = {"length": 1200.0, "height": 1200.0, "elements": 96, "elements_up": 48}
    _, other, found = solved(**larger)
    apart = np.abs(reached(problem, usual) - reached(other, found))
    assert apart.max() <= 1.001 * problem.contacts["support"].positions[1]


def test_slip_goes_on_after_the_fluid_is_stopped() -> None:
    """Fluid that has spread still acts: the front runs on, the well sticks again."""
    settings, problem, found = solved(
        injection_load="stopped", shear_stress=5e6, instants=61
    )
    stopped = int(np.argmax(settings.path("injection_load") == 0.0))
    front = reached(problem, found)
    assert front.max() > front[stopped - 1]
    after = found.contact("support").status[:, stopped + 1]
    assert after[0] == 0
    assert after.any()


def test_a_barrier_stops_the_front() -> None:
    settings, problem, found = solved(normal_profile="barrier", duration=3e5)
    _, _, free = solved(duration=3e5)
    end = 0.16 * settings.length
    assert (
        reached(problem, found).max() <= end < 2.0 * end < reached(problem, free).max()
    )


@pytest.mark.parametrize(
    "changes",
    [
        {"injection_load": "stopped"},
        {"injection_load": "pulses"},
        {"friction_law": "slip-dependent"},
        {"duration": 1e6},
        {"overpressure": 0.0},
        {"shear_stress": -3.6e6},
    ],
    ids=lambda changes: str(changes),
)
def test_no_closed_form_is_drawn_where_none_holds(changes: dict[str, Any]) -> None:
    settings = FaultSettings.checked(SMALL | changes)
    assert list(settings.exact(discretise(settings))) == []


@pytest.mark.parametrize(
    ("changes", "name", "words"),
    [
        ({"overpressure": 1.1e7}, "overpressure", "normal stress"),
        ({"injection_load": [[0.0, 1.1e7]]}, "injection_load", "normal stress"),
        (
            {"normal_profile": [[0.0, 1.0], [600.0, -1.0]]},
            "normal_profile",
            "factors of at least",
        ),
        ({"normal_profile": [[0.0, 1.0], [5.0, 0.1]]}, "overpressure", "normal stress"),
        ({"diffusivity": 0.0}, "diffusivity", "above 0"),
        ({"overpressure": -1.0}, "overpressure", "0"),
    ],
)
def test_fluids_that_open_the_fault_are_refused(
    changes: dict[str, Any], name: str, words: str
) -> None:
    with pytest.raises(SettingError) as refused:
        FaultSettings.checked(changes)
    assert name in str(refused.value)
    assert words in str(refused.value)


JOINT = {
    "friction_law": "general",
    "tangential_stiffness": 5e8,
    "shear_stress": 3.3e6,
    "overpressure": 0.0,
    "instants": 1,
    "elements": 24,
    "elements_up": 12,
}


def test_a_joint_slips_by_shear_over_stiffness_between_both_of_its_sides() -> None:
    """Some 6.5 mm between its sides, of which the body that is solved moves half."""
    settings, problem, found = solved(**JOINT)
    law = problem.contacts["support"]
    contact = found.contact("support")
    shear = -contact.tangential_force / law.by_point(law.weights)[:, None]
    assert shear == pytest.approx(5e8 * contact.slip, rel=1e-9)
    assert contact.slip.max() == pytest.approx(0.0065, rel=0.015)
    above = problem.row_dofs[law.tangent.above]
    assert found.displacement[above] == pytest.approx(
        0.5 * contact.slip[law.points], rel=1e-12
    )
    across, _ = settings.structure().loop(problem).along(found)
    assert across == pytest.approx(contact.slip[0], rel=1e-12)


def test_quantities_of_a_fault_are_those_between_both_of_its_sides() -> None:
    """A point over that across from it, which moves as much the other way."""
    run = finished_run(FaultSettings.checked(SMALL | JOINT), errors=False)
    inside = run.problem.inside
    moved = inside.displacement(run.iterate.displacement, slice(None))[:, 0]
    contact = run.iterate.contact("support")
    assert reading("peak_slip")(run) == contact.slip.max()
    assert reading("peak_displacement")(run) == pytest.approx(2.0 * moved.max())


@pytest.mark.parametrize("law", ["slip-dependent", "general"])
def test_friction_of_a_fault_has_its_last_value_after_the_slip_length_between_its_sides(
    law,
):
    """All of the fault slides, as its top is moved by more than friction holds."""
    length = 0.02
    ratio = 0.5
    changes = {"friction_law": law, "friction_ratio": ratio, "slip_length": length}
    if law == "general":
        changes |= {"strength": "linear"}
    else:
        changes |= {}
    changes |= {
        "overpressure": 0.0,
        "shear_stress": 6.3e6,
        "instants": 2,
        "elements": 8,
    }
    _, problem, found = solved(**{**changes, "elements_up": 4})
    contact = found.contact("support")
    where = problem.contacts["support"]
    factor = (
        np.abs(contact.tangential_force) / where.by_point(where.weights)[:, None] / 6e6
    )
    slip = np.abs(contact.slip)
    assert found.converged.all()
    assert slip.max() > 0.001
    assert factor == pytest.approx(
        1.0 - (1.0 - ratio) * np.minimum(slip / length, 1.0), rel=1e-9
    )


OLD = """
scene = "fault"
friction_law = "general"
strength = "linear"
slip_length = 1e-3
tangential_stiffness = 1e9
"""


def test_a_settings_file_of_before_is_told_that_slip_is_that_of_both_sides(
    tmp_path,
) -> None:
    settings, told = read_settings(OLD, "old.toml")
    assert told.keys() == {"slip_length", "tangential_stiffness"}
    assert "give 0.002 m" in told["slip_length"]
    assert "give 5e8 N/m^3" in told["tangential_stiffness"]
    again, told = read_settings(dump(settings), "new.toml")
    assert again.values() == settings.values()
    assert told == {}
    saved = tmp_path / "old.toml"
    saved.write_text(OLD, encoding="utf-8")
    _, told = settings_from_command(str(saved), ["slip_length=2e-3"])
    assert told.keys() == {"tangential_stiffness"}
    with pytest.raises(SettingError, match="later version"):
        read_settings("format = 3" + OLD, "later.toml")


def test_what_friction_never_changes_is_not_told_of_a_file_of_before() -> None:
    for line in ('friction_law = "coulomb"', "slip_length = 1e-3", ""):
        assert read_settings(f'scene = "fault"\n{line}\n', "old.toml")[1] == {}
    bar = 'scene = "bar"\nfriction_law = "slip-dependent"\nslip_length = 1e-3\n'
    assert read_settings(bar, "old.toml")[1] == {}


VIESCA = {0.1: 3.6405, 0.3: 1.3474, 0.5: 0.79161, 0.7: 0.43513, 0.9: 0.13981}
"""lambda over T: the condition of Viesca, J. Fluid Mech. 928, A29, 2021, evaluated
elsewhere."""


@pytest.mark.parametrize(("stress", "factor"), VIESCA.items())
def test_the_front_of_a_fluid_runs_with_the_factor_of_its_stress(stress, factor):
    place = np.linspace(0.0, 20.0, 20_001)
    assert fronts(place, (stress - erfc(place))[:, None]) == pytest.approx(
        factor, rel=5e-5
    )


@pytest.mark.parametrize("place", [0.0, 0.3, 0.9])
def test_slip_under_growing_strength_is_that_of_the_drop_of_stress(place):
    """Slip at a place is an integral of the drop, with a point force's logarithm."""
    half = 2.0
    drop = 1e5
    stiffness = 5e8
    here = place * half

    def slipped(there):
        roots = np.sqrt((half**2 - here**2) * (half**2 - there**2))
        green = np.log((half**2 - here * there + roots) / (half * abs(here - there)))
        return drop * (1.0 - abs(there) / half) * green

    parts = sorted({-half, 0.0, here, half})
    found = sum(quad(slipped, *ends, limit=200)[0] for ends in pairwise(parts))
    exact = slip_under_growing_strength(np.array([here]), half, drop, stiffness)[0]
    assert 2.0 / (np.pi * stiffness) * found == pytest.approx(exact, rel=1e-6)


def loosened(substructures):
    """Shear a body to and fro on a strength that falls from the middle."""
    x = np.linspace(0.0, 1.0, 21)
    time = np.linspace(0.0, 1.0, 9)
    strength = 1e6 - 8e5 * np.sin(np.pi * time) * np.exp(-8.0 * x[:, None])
    none = SideComponent(False, 0.0 * time)
    shear = SideComponent(False, np.full_like(time, 6e5))
    level = SideComponent(True, 0.0 * time)
    return Stack(
        length=1.0,
        height=0.5,
        elements=(20, 10),
        substructures=substructures,
        young=1e9,
        poisson=0.3,
        instants=time,
        duration=1.0,
        support=Support(np.zeros(21), 0.0, strength),
        sides={
            "left": Side(none, level),
            "top": Side(shear, level),
            "right": Side(none, shear),
        },
    )


@pytest.mark.parametrize("substructures", [(1, 1), (4, 2)])
def test_a_known_bound_in_the_plane_is_obeyed_and_presses_nothing(substructures):
    problem = discrete.discretise(loosened(substructures))
    reference = reference_of(problem)
    method = Latin(direction=Auto(), stop=Stop(accuracy=1e-4, iterations=300))
    solution = solve(problem, method, watch=False)
    assert reference.converged.all()
    assert solution.status.ending is Ending.CONVERGED
    law = problem.contacts["support"]
    there = reference.contact("support")
    found = solution.iterate.contact("support")
    bound = law.by_point(law.tangential.bound) * problem.scales.force
    assert there.normal_force is None
    assert np.all(np.abs(there.tangential_force) <= bound * (1.0 + 1e-9))
    moves = there.status != 0
    assert 3 < np.count_nonzero(moves) < 0.5 * moves.size
    held = np.abs(there.tangential_force)[moves]
    assert held == pytest.approx(bound[moves], rel=1e-9)
    scale = np.abs(there.tangential_force).max()
    assert np.abs(found.tangential_force - there.tangential_force).max() < 1e-3 * scale
