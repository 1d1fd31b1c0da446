"""A wall of bricks that only touch: equilibrium, symmetry, rigid limits."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from solver import discrete
from solver.discrete.plane.rectangles.bricks import bonded, grouped, with_opening
from solver.discrete.plane.rectangles.sides import Side, SideComponent, Support
from solver.discrete.plane.rectangles.stack import Stack
from solver.latin import Ending, Latin, iterations, solve
from solver.latin.end.status import collapses
from solver.laws import OPEN, FrictionLaw, SlipFactor
from solver.reference.distance import distance_to, kkt_residual
from solver.reference.incremental import reference_of
from solver.reference.limit_analysis import Motion, collapse_of
from solver.reference.linear_system import LinearSystem
from solver.reference.newton import SINGULAR_STEPS, Newton
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.values import SettingError
from solver.study.known_reference import known_reference

TIMES = np.linspace(0.0, 1.0, 21)
DOWN = np.minimum(TIMES / 0.25, 1.0)
PRESSED = SideComponent(False, -1e6 * DOWN)
PUSH = np.where(TIMES < 0.25, 0.0, np.sin(2.0 * np.pi * (TIMES - 0.25) / 0.75))


def wall(columns=4, courses=4, *, bond="running", size=(4, 2), moved=5e-5, **others):
    """A wall pressed by a quarter of the interval, then moved to and fro."""
    return Stack(
        length=0.24,
        height=0.12,
        elements=size,
        substructures=(1, 1),
        bricks=bonded(bond, columns, courses, size),
        young=1e10,
        poisson=0.2,
        state="stress",
        friction=0.6,
        support=Support(np.zeros(columns * size[0] + 1), 0.6),
        body_force=np.stack([0.0 * TIMES, -2e4 * DOWN]),
        sides={"top": Side(SideComponent(True, moved * PUSH), PRESSED)},
        instants=TIMES,
        duration=1.0,
        macro_degree=2,
        **others,
    )


def forces(found, names, component):
    """Sums of forces at some interfaces, shape (n_instants,)."""
    return sum(getattr(found.contact(name), component).sum(axis=0) for name in names)


def on_ground(problem):
    return [name for name in problem.contacts if name.startswith("support")]


def door():
    """A wall of 6 by 5 bricks with an opening of 2 by 2 in its middle."""
    whole = wall(6, 5, moved=3e-5)
    return replace(whole, bricks=with_opening(whole.rectangles, (4, 2), (2, 4), 2))


def test_the_weight_over_an_opening_goes_round_it():
    """The lintel lies on half a brick at each end; the ground beside carries all."""
    built = door()
    lintel = max(built.rectangles, key=lambda brick: brick.columns)
    assert (lintel.x, lintel.y, lintel.columns) == (6, 4, 12)
    area = sum(brick.columns * brick.rows for brick in built.rectangles)
    assert area == 6 * 4 * 5 * 2 - 2 * 4 * 2 * 2
    problem = discrete.discretise(built)
    reference = reference_of(problem)
    weight = 2e4 * area * 0.06 * 0.06
    carried = forces(reference, on_ground(problem), "normal_force")[-1]
    assert carried == pytest.approx(weight + 1e6 * 6 * 0.24, rel=1e-9)
    run = solve(problem, Latin(), distance=distance_to(reference, problem), watch=False)
    assert run.is_certified
    assert run.records[-1].error_force < 1e-9


def test_an_opening_leaves_bricks_beside_and_above_it():
    settings = CATALOGUE["wall"]
    for values, name in (
        ({"opening": 11}, "opening"),
        ({"opening": 2, "opening_height": 6}, "opening_height"),
        ({"opening": 2, "elements": 5, "bond": "stack"}, "elements"),
    ):
        with pytest.raises(SettingError, match=f"^{name} = "):
            settings.checked(values)


@pytest.mark.parametrize("bond", ["running", "stack"])
def test_latin_and_the_incremental_solver_come_to_one_solution(bond):
    problem = discrete.discretise(wall(bond=bond))
    reference = reference_of(problem)
    assert reference.converged.all()
    assert np.any(reference.status == 2)
    assert np.any(np.abs(reference.status) == 1)
    run = solve(problem, Latin(), distance=distance_to(reference, problem), watch=False)
    assert run.is_certified
    assert run.records[-1].error_force < 1e-10
    assert kkt_residual(run.iterate, problem) < 1e-10


def test_the_ground_carries_what_weighs_and_presses():
    made = wall()
    problem = discrete.discretise(made)
    run = solve(problem, Latin(), watch=False)
    pressed = forces(run.iterate, on_ground(problem), "normal_force")
    expected = made.size[0] * 1e6 * DOWN - made.weight[1]
    np.testing.assert_allclose(pressed, expected, rtol=1e-9)
    shear = made.loop(problem).force(run.iterate)
    rubbed = forces(run.iterate, on_ground(problem), "tangential_force")
    np.testing.assert_allclose(shear, -rubbed, atol=1e-9 * np.abs(shear).max())


def test_a_wall_that_is_moved_the_other_way_is_its_mirror_image():
    first, second = (
        solve(discrete.discretise(wall(moved=way)), Latin(), watch=False)
        for way in (5e-5, -5e-5)
    )
    shears = []
    for run, sign in ((first, 1.0), (second, -1.0)):
        names = on_ground(run.iterate.problem)
        shears.append(sign * forces(run.iterate, names, "tangential_force"))
    np.testing.assert_allclose(*shears, atol=1e-9 * np.abs(shears[0]).max())


def test_the_order_of_the_bricks_changes_nothing():
    made = wall()
    order = np.random.default_rng(4).permutation(len(made.rectangles))
    mixed = replace(made, bricks=[made.rectangles[number] for number in order])
    sums = []
    for each in (made, mixed):
        problem = discrete.discretise(each)
        run = solve(problem, Latin(), watch=False)
        assert run.is_certified
        sums.append(forces(run.iterate, on_ground(problem), "tangential_force"))
    np.testing.assert_allclose(*sums, atol=1e-9 * np.abs(sums[0]).max())


@pytest.mark.parametrize("cuts", [(2, 1), (3, 2)])
def test_bricks_that_are_cut_pass_on_the_same_forces(cuts):
    """A side has joints of several parts where cuts of two bricks do not meet."""
    whole = wall(3, 3, size=(6, 2))
    cut = replace(whole, substructures=cuts)
    found = []
    for made in (whole, cut):
        problem = discrete.discretise(made)
        run = solve(problem, Latin(), watch=False)
        assert run.is_certified
        names = sorted(problem.contacts)
        sums = [run.iterate.contact(name).normal_force.sum(axis=0) for name in names]
        found.append([made.loop(problem).force(run.iterate), *sums])
    np.testing.assert_allclose(*found, atol=1e-6 * np.abs(found[0]).max())


def column(shear, courses, *, friction, **law):
    """A pile of single bricks under a pressure, and a growing traction on top."""
    made = wall(1, courses, bond="stack", size=(8, 4), **law)
    grown = SideComponent(False, shear * np.clip((TIMES - 0.25) / 0.75, 0.0, 1.0))
    return replace(
        made,
        body_force=None,
        sides={"top": Side(grown, PRESSED)},
        friction=friction,
        support=replace(made.support, friction=friction),
    )


@pytest.mark.parametrize(
    ("courses", "friction", "limit"),
    [(1, 0.3, 0.3), (1, 0.6, 0.6), (2, 0.9, 0.5), (3, 0.6, 0.24 / 0.72), (3, 0.2, 0.2)],
)
def test_a_pile_slides_or_tips_at_the_limit_of_rigid_blocks(courses, friction, limit):
    """A brick slides at mu p, and tips about its toe at p b / (2 h)."""
    for share, stands in ((0.97, True), (1.03, False)):
        made = column(share * limit * 1e6, courses, friction=friction)
        found = reference_of(discrete.discretise(made))
        assert bool(found.converged[-1]) is stands
        assert found.converged[:5].all()
    collapse = collapse_of(discrete.discretise(made))
    assert (collapse.motion is Motion.TIPS) is (limit < friction)


@pytest.mark.parametrize(
    ("law", "limit"),
    [
        (FrictionLaw(), 0.3),
        (FrictionLaw(slip_factor=SlipFactor((0.0, 1e-6), (1.0, 1.5))), 0.45),
        (FrictionLaw(cohesion=1e5), 0.4),
        (FrictionLaw(cap=2e5), 0.2),
    ],
)
def test_limit_analysis_finds_the_shear_that_no_contact_force_balances(law, limit):
    """The load reaches its limit halfway;
    hardening that slip may bring is counted in.
    """
    made = column(2.0 * limit * 1e6, 1, friction=0.3, friction_law=law)
    collapse = collapse_of(discrete.discretise(made))
    assert collapse.time == pytest.approx(0.25 + 0.75 * 0.5, rel=1e-9)
    assert np.abs(collapse.mechanism).max() == pytest.approx(1.0)
    safe = column(0.99 * limit * 1e6, 1, friction=0.3, friction_law=law)
    assert collapse_of(discrete.discretise(safe)) is None


def test_of_loads_on_a_line_that_holds_only_both_ends_are_looked_at():
    problem = discretise(CATALOGUE["wall"].checked({"instants": 21}))
    asked = []
    # It is asked before each linear program.
    assert collapse_of(problem, lambda: bool(asked.append(0))) is None
    assert len(asked) == 2


PILE = {
    "top": "pulled",
    "bond": "stack",
    "bricks": 1,
    "courses": 3,
    "unit_weight": 0.0,
    "elements": 4,
    "elements_up": 2,
}


@pytest.mark.parametrize("friction", [0.2, 0.6])
@pytest.mark.parametrize("instants", [2, 12])
def test_a_pile_says_the_load_that_it_carries_in_the_name_of_its_setting(
    friction, instants
):
    """A brick slides at mu p, and tips at p b / (2 h), whatever the path."""
    values = {**PILE, "friction": friction, "instants": instants, "traction": 5e5}
    settings = CATALOGUE["wall"].checked(values)
    limit = min(friction, 0.25 / (2.0 * 0.36)) * 1e6
    problem = discretise(settings)
    words = known_reference(problem).doubt
    told = re.search(
        r"beyond traction = (\S+) Pa \((\S+) times its largest value\)", words
    )
    assert float(told[1]) == pytest.approx(limit, rel=1e-3)
    assert float(told[2]) == pytest.approx(limit / 5e5, rel=3e-3)
    assert told[0] in solve(problem, method_of(settings), watch=False).status.advice


def test_loads_of_which_no_share_is_carried_are_told_as_they_are():
    """At the one instant the top is pulled by more than any pressed share holds."""
    at_once = {"pressure_load": ((0.0, 1e6),), "top_load": ((0.0, 5e5),), "instants": 1}
    problem = discretise(CATALOGUE["wall"].checked(PILE | at_once))
    words = known_reference(problem).doubt
    assert "no equilibrium with pressure_load = 1e6 Pa (1 times" in words
    assert "and top_load = 500000 Pa (1 times" in words


def test_loads_that_fall_until_nothing_holds_are_told_from_above():
    loosened = {**PILE, "top_load": ((0.0, 2e5),), "friction": 0.6}
    loosened["pressure_load"] = ((0.0, 1e6), (1.0, 0.0))
    words = known_reference(discretise(CATALOGUE["wall"].checked(loosened))).doubt
    told = re.search(
        r"below pressure_load = (\S+) Pa \((\S+) times its largest value\)", words
    )
    exact = 2e5 * 2.0 * 0.36 / 0.25
    assert float(told[1]) == pytest.approx(exact, rel=1e-3)
    assert float(told[2]) == pytest.approx(exact / 1e6, rel=3e-3)


def test_the_limit_of_a_wall_is_said_to_be_its_meshs_and_rises_with_its_elements():
    """Towards that of rigid stones: up to 5 % more than on the coarsest mesh."""
    found = {}
    for elements in (2, 12):
        size = {
            "elements": elements,
            "elements_up": max(elements // 2, 2),
            "instants": 2,
        }
        values = PILE | {"bond": "running", "bricks": 3, "traction": 1e6} | size
        problem = discretise(
            CATALOGUE["wall"].checked({**values, "top_load": "delayed"})
        )
        assert problem.has_short_joints
        collapse = collapse_of(problem)
        found[elements] = collapse.share
        assert (
            "rigid stones carry up to 5 % more" in collapses(problem, collapse).advice
        )
    assert 1.01 < found[12] / found[2] < 1.05
    assert not discretise(CATALOGUE["wall"].checked(PILE)).has_short_joints


@pytest.mark.parametrize("moved", [2e-4, 1e-3])
def test_bricks_that_hang_loose_have_an_equilibrium_at_every_instant(moved):
    problem = discrete.discretise(wall(3, 4, moved=moved))
    reference = reference_of(problem)
    assert reference.converged.all()
    assert kkt_residual(reference, problem) < 1e-11
    is_open = reference.status == OPEN
    assert is_open.mean() > 0.1


def test_groups_lead_from_a_whole_coarse_problem_to_none():
    whole = wall(moved=3e-5)
    count = len(whole.rectangles)
    reference = distance_to(
        reference_of(discrete.discretise(whole)), discrete.discretise(whole)
    )
    needed = {}
    for number in (1, 4, count):
        groups = grouped(whole.rectangles, (4, 2), number)
        assert np.bincount(groups).min() >= 1
        problem = discrete.discretise(replace(whole, groups=groups))
        for iterate in iterations(problem, Latin()):
            if reference.of_friction_force(iterate) < 0.01:
                break
        needed[number] = iterate.number
    assert needed[count] < needed[4] < needed[1]


def test_the_number_of_iterations_does_not_grow_with_the_bricks():
    needed = {}
    for multiscale in (True, False):
        for count in (3, 7):
            problem = discrete.discretise(wall(count, count))
            distance = distance_to(reference_of(problem), problem)
            for iterate in iterations(
                problem, Latin(finish=None, multiscale=multiscale)
            ):
                if distance.of_friction_force(iterate) < 0.01:
                    break
            needed[multiscale, count] = iterate.number
    assert needed[True, 7] <= needed[True, 3] + 2
    assert needed[False, 7] > 1.5 * needed[False, 3]
    assert needed[False, 7] > 4 * needed[True, 7]


def test_a_run_ends_by_itself_within_its_accuracy():
    problem = discrete.discretise(wall(6, 6))
    distance = distance_to(reference_of(problem), problem)
    run = solve(problem, Latin(finish=None), distance=distance, watch=False)
    assert run.status.ending is Ending.CONVERGED
    assert run.records[-1].error_force < 0.01


def test_states_that_leave_bricks_free_are_given_up_for_springs(monkeypatch):
    solved = LinearSystem.__call__
    sought = Newton.seek
    free = []

    def counted(self, states, sides):
        found = solved(self, states, sides)
        free[-1] += self.is_singular
        return found

    def seek(self, system, guess, sides):
        free.append(0)
        return sought(self, system, guess, sides)

    monkeypatch.setattr(LinearSystem, "__call__", counted)
    monkeypatch.setattr(Newton, "seek", seek)
    settings = CATALOGUE["wall"].checked(
        {
            "bricks": 4,
            "courses": 3,
            "elements": 4,
            "elements_up": 2,
            "instants": 17,
            "displacement": 5e-4,
        }
    )
    reference = reference_of(discretise(settings))
    assert reference.converged.all()
    assert max(free) == SINGULAR_STEPS + 1
