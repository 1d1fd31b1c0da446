"""Cut or not, a structure is the same;
contacts alike are one; driven points obey their law.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import chain
from typing import Any

import numpy as np
import pytest
from contact_problems import block, friction_of

from solver.arrays import Array
from solver.discrete import discretise
from solver.discrete.contacts import NO_SLIP, ContactGroup, Contacts
from solver.discrete.driven_friction import DrivenFriction, driven_friction
from solver.discrete.drives import Drive, beyond, loads_at
from solver.discrete.elements import SchurComplement
from solver.discrete.plane.bricks import Brick
from solver.discrete.plane.cut_stack import CutStack, ends_along
from solver.discrete.plane.sides import Given, Side
from solver.discrete.plane.stack import Stack
from solver.discrete.problem import Problem
from solver.discrete.rods.cut_rods import CutRods
from solver.discrete.rods.rods import End, Rods
from solver.laws import OPEN, Component, Contact, SlipFactor, Unilateral
from solver.laws.play import play
from solver.reference.assembly import assembled_stiffness, external_force
from solver.reference.incremental import reference_of

INSTANTS = np.linspace(0.0, 1.0, 5)


def close(found: Array, wanted: Array, share: float = 1e-12) -> bool:
    size = max(np.abs(wanted).max(initial=0.0), 1e-300)
    return bool(np.abs(found - wanted).max(initial=0.0) <= share * size)


# Rods


def rods(substructures: int, **changes: Any) -> Rods:
    random = np.random.default_rng(1)
    section = random.uniform(0.5, 2.0, 12)
    given: dict[str, Any] = {
        "length": 2.0,
        "stiffness": 3e4,
        "elements": 12,
        "substructures": substructures,
        "strength": random.uniform(10.0, 20.0, 13),
        "left": End(displacement=1e-4 * INSTANTS, spring=5e4),
        "right": End(force=1e3 * np.sin(6.0 * INSTANTS)),
        "instants": INSTANTS,
        "duration": 1.0,
        "body_force": random.normal(size=(13, 5)),
        "strain": 1e-3 * random.normal(size=(12, 5)),
        "section": section * np.mean(1.0 / section),
    }
    return Rods(**given | changes)


SEVERAL = {"wires": 3, "factors": np.array([1.0, 0.5])}
KINDS = {
    "single": {},
    "on a support that settles": {
        "settlement": 1e-4 * np.random.default_rng(2).normal(size=(13, 5))
    },
    "held at both ends": {"right": End(displacement=2e-4 * INSTANTS)},
    "several": SEVERAL,
    "broken": {**SEVERAL, "broken": (2, 5)},
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("cuts", [2, 3, 7])
def test_cut_or_not_rods_have_one_stiffness_and_load(kind: str, cuts: int) -> None:
    whole = discretise(rods(1, **KINDS[kind]))
    cut = discretise(rods(cuts, **KINDS[kind]))
    if kind != "broken" or cuts > 2:
        assert len(cut.substructures) > len(whole.substructures)
    stiffness = assembled_stiffness(whole).toarray()
    assert close(assembled_stiffness(cut).toarray(), stiffness)
    assert close(external_force(cut), external_force(whole))
    assert np.array_equal(cut.positions, whole.positions)
    for name, law in whole.rubbing.items():
        other = cut.rubbing[name]
        bounds = (one.by_point(one.tangential.bound) for one in (law, other))
        assert next(bounds) == pytest.approx(next(bounds), rel=1e-12)
        areas = (one.by_point(one.weights) for one in (law, other))
        assert next(areas) == pytest.approx(next(areas), rel=1e-12)
    wanted = reference_of(whole)
    found = reference_of(cut)
    assert close(found.displacement, wanted.displacement, 1e-9)
    assert found.friction_force == pytest.approx(wanted.friction_force, abs=1e-6)


def test_stiffness_of_a_rod_is_that_of_springs_in_series() -> None:
    """Pulled at an end whose other is held: the sum of compliances, in m/N."""
    of = rods(
        4, left=End(displacement=0.0 * INSTANTS), strength=np.zeros(13), strain=None
    )
    problem = discretise(replace(of, body_force=None))
    assert of.section is not None
    compliance = float(np.sum(2.0 / 12.0 / (3e4 * of.section)))
    found = reference_of(problem).displacement[-1]
    assert found == pytest.approx(compliance * 1e3 * np.sin(6.0 * INSTANTS), rel=1e-10)
    assert compliance == pytest.approx(2.0 / 3e4)


def test_a_rod_that_is_heated_is_longer_by_its_strain_and_pulls_where_it_is_held() -> (
    None
):
    strain = np.tile(1e-3 * INSTANTS, (12, 1))
    held = End(displacement=0.0 * INSTANTS)
    plain = {"strength": np.zeros(13), "body_force": None, "strain": strain}
    free = discretise(rods(3, left=held, right=End(), **plain))
    ends = reference_of(free).displacement[-1]
    assert ends == pytest.approx(2.0 * 1e-3 * INSTANTS, rel=1e-10)


def test_a_support_that_settles_moves_no_rod_that_does_not_rub() -> None:
    settlement = 1e-4 * np.random.default_rng(2).normal(size=(13, 5))
    still = discretise(rods(3, strength=np.zeros(13)))
    moved = discretise(rods(3, strength=np.zeros(13), settlement=settlement))
    assert np.abs(reference_of(moved).displacement).max() > 0.0
    assert moved.absolute(reference_of(moved).displacement) == pytest.approx(
        reference_of(still).displacement, abs=1e-14
    )


def test_cuts_of_rods_are_opposite_rows_of_one_degree_of_freedom() -> None:
    of = rods(5, **SEVERAL)
    places = [np.linspace(0.0, 2.0, 13)] * 3
    problem = CutRods([of] * 3, places, ["1-2", "2-3"], (True, True)).problem()
    assert len(problem.cuts) == 4
    for cut in problem.cuts:
        assert len(cut.first) == 3
        dofs = problem.row_dofs
        assert np.array_equal(dofs[cut.first], dofs[cut.second])


# Bodies in the plane


def pressed(cuts: tuple[int, int], **changes: Any) -> Stack:
    random = np.random.default_rng(3)
    weight = 1e6 * random.normal(size=(2, 17))
    stack = block(elements=(6, 4), cuts=cuts, slope=0.3, **changes)
    return replace(stack, body_force=weight)


STACKS = {
    "block": {},
    "pile": {"bodies": 2},
    "pulled aside": {
        "right": Side(
            Given(False, 1e5 * np.linspace(0.0, 1.0, 17), 0.4),
            Given(False, np.zeros(17)),
        )
    },
}


def by_place(problem: Problem) -> dict[tuple[Any, ...], int]:
    """Degrees of freedom by body, scaled place and direction."""
    inside = problem.inside
    assert inside is not None
    bodies = np.empty(problem.n_dofs, dtype=int)
    elements = [(grid.shape[0] - 1) * (grid.shape[1] - 1) for grid in inside.grids]
    firsts = np.cumsum([0, *elements[:-1]])
    for dofs, first in zip(inside.dofs, firsts, strict=True):
        bodies[dofs] = inside.bodies[first]
    return {
        (int(body), *np.round(place, 9).tolist(), int(component)): dof
        for dof, (body, place, component) in enumerate(
            zip(bodies, inside.positions, inside.directions[:, 1], strict=True)
        )
    }


@pytest.mark.parametrize("kind", STACKS)
@pytest.mark.parametrize("cuts", [(2, 1), (3, 2)])
def test_what_the_cuts_add_condenses_to_the_uncut_stiffness_and_load(
    kind: str, cuts: tuple[int, int]
) -> None:
    whole = discretise(pressed((1, 1), **STACKS[kind]))
    cut = discretise(pressed(cuts, **STACKS[kind]))
    assert cut.n_dofs > whole.n_dofs
    places = by_place(cut)
    order = np.array([places[place] for place in by_place(whole)])
    assert len(order) == whole.n_dofs
    kept = np.sort(order)
    condensed = SchurComplement(assembled_stiffness(cut).tocsc(), kept)
    at = np.searchsorted(kept, order)
    wanted = assembled_stiffness(whole).toarray()
    assert close(condensed.stiffness[np.ix_(at, at)], wanted, 1e-10)
    load = condensed.condense(external_force(cut))[at]
    assert close(load, external_force(whole), 1e-10)


def test_tractions_and_weight_add_up_to_their_resultants() -> None:
    stack = pressed((3, 2))
    problem = discretise(stack)
    inside = problem.inside
    assert inside is not None
    total = inside.directions[:, :2].T @ external_force(problem)
    assert stack.body_force is not None
    top = np.stack([given.mean for given in stack.sides["top"]])
    area = stack.length * stack.height
    wanted = top * stack.length + stack.body_force * area
    assert close(total * problem.scales.force, wanted)


def test_a_side_is_loaded_where_bodies_reach_farthest_and_not_beside_them() -> None:
    pull = np.linspace(0.0, 1e5, 17)
    still = np.zeros(17)
    left = Side(Given(False, pull), Given(False, still))
    stack = replace(
        block(elements=(6, 4), bodies=2, left=left),
        bricks=[Brick(0, 0, 6, 4), Brick(3, 4, 3, 4)],
    )
    problem = discretise(stack)
    inside = problem.inside
    assert inside is not None
    top = stack.sides["top"].x.mean
    # Where the lower body stands out below the upper one its top lies open, too.
    along = inside.directions[:, 0] @ external_force(problem)
    wanted = pull * stack.height + top * stack.length
    assert close(along * problem.scales.force, wanted)


def test_substructures_end_at_cuts_and_where_bodies_end() -> None:
    ends = ends_along(12, 3, [12, 7])
    assert ends.tolist() == [4, 7, 8, 12]


def test_parts_tile_their_bodies_and_pairs_their_joints() -> None:
    cut = CutStack(pressed((3, 2), bodies=2))
    areas = [part.rectangle.columns * part.rectangle.rows for part in cut.parts]
    assert sum(areas) == 2 * 6 * 4
    sides = chain.from_iterable(part.rows.values() for part in cut.parts)
    rows = np.concatenate([rows.ravel() for rows in sides])
    assert np.array_equal(np.sort(rows), np.arange(len(rows)))
    lengths: dict[str, float] = {}
    for joint, (_, length) in cut.pairs.items():
        name = cut.name(joint)
        lengths[name] = lengths.get(name, 0.0) + float(length.sum())
    assert lengths["support"] == pytest.approx(1.0)
    assert lengths["contact 1-2"] == pytest.approx(1.0)


# Inside of substructures


@pytest.mark.parametrize("kind", STACKS)
def test_the_inside_is_recovered_alike_whatever_the_cuts(kind: str) -> None:
    found = []
    for cuts in ((1, 1), (3, 2)):
        problem = discretise(pressed(cuts, **STACKS[kind]))
        inside = problem.inside
        assert inside is not None
        solution = reference_of(problem)
        nodes = inside.displacement(solution.displacement, [4, 16])
        stress = inside.stress(nodes[:, :, 1])
        centres = inside.nodes[inside.elements].mean(axis=1)
        order = np.lexsort((*np.round(centres, 9).T, inside.bodies))
        found.append((nodes, stress[order]))
    assert close(found[1][0], found[0][0], 1e-6)
    assert close(found[1][1], found[0][1], 1e-6)


@pytest.mark.parametrize("cuts", [(1, 1), (3, 2)])
def test_a_weighted_sum_of_the_inside_is_its_adjoint_on_the_outside(
    cuts: tuple[int, int],
) -> None:
    random = np.random.default_rng(4)
    problem = discretise(pressed(cuts, bodies=2))
    inside = problem.inside
    assert inside is not None
    field = 1e-3 * random.normal(size=(problem.n_dofs, problem.n_instants))
    weights = random.normal(size=(len(inside.nodes), 2))
    whole = inside.displacement(field, slice(None))
    outside, constant = inside.adjoint(weights)
    wanted = np.einsum("ij,ijk->k", weights, whole)
    assert outside @ field + constant == pytest.approx(wanted, abs=1e-13)
    assert np.abs(constant).max() > 1e-9


def test_rigid_motions_cost_no_force_move_nothing_held_and_are_all_there_are() -> None:
    problem = discretise(pressed((3, 2), bodies=2))
    inside = problem.inside
    assert inside is not None
    stiffness = assembled_stiffness(problem)
    for fixed, count in (([], 6), ([0], 5), ([0, 1], 4)):
        held = np.array(fixed, dtype=int)
        motions = inside.rigid_motions(held)
        assert motions is not None
        assert motions.shape[1] == count
        assert np.linalg.matrix_rank(motions) == count
        assert np.abs(stiffness @ motions).max() <= 1e-9
        assert np.abs(motions[held]).max(initial=0.0) <= 1e-12
    every = np.arange(problem.n_dofs)
    assert inside.rigid_motions(every) is None


def test_a_linear_displacement_has_one_stress_everywhere() -> None:
    stack = pressed((3, 2))
    inside = discretise(stack).inside
    assert inside is not None
    gradient = np.array([[1e-4, 2e-4], [-3e-4, 5e-4]])
    stress = inside.stress(inside.nodes @ gradient.T)
    strain = np.array([1e-4, 5e-4, 2e-4 - 3e-4])
    young = 1e9
    poisson = 0.3
    if stack.state == "strain":
        share = young / (1.0 + poisson) / (1.0 - 2.0 * poisson)
        elastic = share * np.array(
            [
                [1.0 - poisson, poisson, 0.0],
                [poisson, 1.0 - poisson, 0.0],
                [0.0, 0.0, 0.5 - poisson],
            ]
        )
    else:
        share = young / (1.0 - poisson**2)
        elastic = share * np.array(
            [[1.0, poisson, 0.0], [poisson, 1.0, 0.0], [0.0, 0.0, 0.5 - 0.5 * poisson]]
        )
    assert stress == pytest.approx(np.tile(elastic @ strain, (24, 1)), rel=1e-9)


# Contacts


def interface(first: int, sizes: int, *, opens: bool, start: float = 0.0) -> Contact:
    rows = first + np.arange(2 * sizes)
    along = friction_of(Component(rows[:sizes]), bound=0.0 if opens else 0.4)
    along = replace(along, start=np.full(sizes, start))
    across = Unilateral(component=Component(rows[sizes:]), gap=np.full(sizes, 0.2))
    return Contact(
        tangential=along,
        normal=across if opens else None,
        points=np.arange(sizes),
        positions=np.arange(float(sizes)),
        weights=np.ones(sizes),
    )


@pytest.mark.parametrize("opens", [False, True])
def test_contacts_put_together_show_what_each_shows(opens: bool) -> None:
    random = np.random.default_rng(5)
    laws = [
        interface(0, 3, opens=opens, start=0.1),
        interface(100, 2, opens=opens),
        interface(6, 4, opens=opens, start=-0.2),
    ]
    stacks = Contacts(dict(zip("abc", laws, strict=True))).stacks
    both = ContactGroup([stacks[0], stacks[2]])
    alone = [ContactGroup([stacks[number]]) for number in (0, 2)]
    assert both.numbers.tolist() == [0, 2]
    assert both.points.tolist() == [0, 1, 2, 5, 6, 7, 8]
    displacement = random.normal(size=(14, 6))
    displacement[6:] *= 1e-10
    force = random.normal(size=(14, 6))
    assert np.array_equal(
        both.slip(displacement, force),
        np.concatenate([one.slip(displacement, force) for one in alone]),
    )
    assert np.array_equal(
        both.status(displacement, force),
        np.concatenate([one.status(displacement, force) for one in alone]),
    )
    first = both.slip(displacement, force)[:, 0]
    start = np.repeat([0.1, -0.2], [3, 4])
    sliders = displacement[[0, 1, 2, 6, 7, 8, 9], 0]
    assert first == pytest.approx(sliders - start, abs=1e-15)
    values = random.normal(size=(7, 6))
    parts = values[:3], values[3:]
    assert both.largest(values) == pytest.approx([part.max() for part in parts])
    assert both.sums(values[:, 0]) == pytest.approx(
        [part[:, 0].sum() for part in parts]
    )


def test_status_is_the_sign_of_slip_beyond_rounding_and_open_without_force() -> None:
    group = ContactGroup(Contacts({"one": interface(0, 2, opens=True)}).stacks)
    displacement = np.zeros((4, 4))
    displacement[0] = [1.0, 1.0, 0.5, 0.5 + 0.1 * NO_SLIP]
    displacement[1] = [0.0, -1.0, -1.0, -1.0]
    force = np.ones((4, 4))
    force[3, 2:] = 0.0
    status = group.status(displacement, force)
    assert status[0].tolist() == [1, 0, -1, 0]
    assert status[1].tolist() == [0, -1, OPEN, OPEN]
    still = group.status(displacement, force, still=0.7)
    assert still[0].tolist() == [1, 0, 0, 0]


def test_fields_of_a_contact_are_its_forces_jumps_and_gap_in_si() -> None:
    problem = discretise(block(elements=(6, 4), cuts=(2, 1), bodies=2))
    random = np.random.default_rng(6)
    (name,) = [name for name in problem.rubbing if name != "support"]
    law = problem.rubbing[name]
    # One displacement above and one below, all along.
    displacement = np.zeros((problem.n_rows, problem.n_instants))
    displacement[law.tangent.above] = 3e-3
    displacement[law.tangent.below] = 1e-3
    assert law.normal is not None
    displacement[law.normal.component.above] = 5e-3
    contacts = problem.rubbing
    force = random.normal(size=(contacts.n_forces, problem.n_instants))
    status = random.integers(-1, 3, size=(contacts.n_points, problem.n_instants))
    scale = problem.scales.displacement
    fields = contacts.fields(force, displacement, status.astype(np.int8), scale)[name]
    shape = len(law.positions), problem.n_instants
    assert fields.slip == pytest.approx(np.full(shape, 2e-3 * scale))
    assert fields.opening == pytest.approx(np.full(shape, 5e-3 * scale))
    assert np.array_equal(fields.status, status[contacts.points[name]])
    across, along = problem.rubbing.forces[name]
    assert np.array_equal(fields.normal_force, force[across])
    assert np.array_equal(fields.tangential_force, force[along])


# Driven points


def driven(**along: Any) -> tuple[DrivenFriction, Array]:
    """Two points of three whose displacement is given, and that displacement."""
    random = np.random.default_rng(7)
    values = np.cumsum(random.normal(size=(2, 30)), axis=1)
    values[:, 10:14] = values[:, 10:11]
    bound = friction_of(Component(np.arange(3)), bound=np.array([0.2, 0.3, 0.5]))
    law = Contact(
        tangential=replace(bound, **along),
        points=np.arange(3),
        positions=np.array([0.0, 1.0, 2.0]),
        weights=np.array([0.5, 1.0, 0.5]),
    )
    prescribed = np.array([0, 2]), values
    found = driven_friction(law, (slice(0, 3),), np.arange(3), prescribed, 1.0)
    assert found is not None
    return found, values


def test_driven_points_rub_against_their_slip_and_else_as_their_neighbour() -> None:
    found, values = driven()
    forces = np.random.default_rng(8).uniform(-1.0, 1.0, size=(3, 30))
    friction = found.force(forces, np.zeros((3, 30)))
    slip = np.diff(values, axis=1, prepend=0.0)
    bound = np.array([[0.2], [0.5]])
    slips = slip != 0.0
    assert friction[slips] == pytest.approx((-bound * np.sign(slip))[slips])
    # Both have half of the area of the point between them.
    even = np.clip(0.5 * forces[1], -bound, bound)
    assert friction[~slips] == pytest.approx(even[~slips])
    assert np.count_nonzero(~slips) == 6
    assert found.rubbing.tolist() == [0, 2]


def test_driven_points_on_springs_lag_like_play_and_on_stiff_ones_not() -> None:
    soft = np.array([0.4, 1.0, 0.6])
    found, values = driven(compliance=soft)
    still = np.zeros((3, 30))
    friction = found.force(still, still)
    bound = np.array([0.2, 0.5])
    slider = play(values, bound * soft[[0, 2]])
    assert friction == pytest.approx((slider - values) / soft[[0, 2], None])
    stiff, _ = driven(compliance=np.full(3, 1e-9))
    rigid, _ = driven()
    slips = np.diff(values, axis=1, prepend=0.0) != 0.0
    assert stiff.force(still, still)[slips] == pytest.approx(
        rigid.force(still, still)[slips]
    )


def test_friction_of_driven_points_changes_with_the_slip_that_has_gone_by() -> None:
    slip_factor = SlipFactor((0.0, 5.0, 10.0), (1.0, 0.5, 0.8))
    found, values = driven(slip_factor=slip_factor)
    still = np.zeros((3, 30))
    slip = np.diff(values, axis=1, prepend=0.0)
    wanted = np.array([[0.2], [0.5]]) * slip_factor(np.cumsum(np.abs(slip), axis=1))
    assert np.abs(found.force(still, still))[slip != 0.0] == pytest.approx(
        wanted[slip != 0.0]
    )


def test_where_nothing_is_prescribed_no_point_is_driven() -> None:
    law = interface(0, 3, opens=False)
    nothing = np.zeros(0, dtype=int), np.zeros((0, 4))
    assert driven_friction(law, (slice(0, 3),), np.arange(6), nothing, 0.0) is None


# Drives

VALUES = np.array([0.0, 2.0, 2.0, -4.0, -1.0, 3.0])
PEAK = Drive("peak", "N", VALUES)


def test_the_end_of_a_step_of_a_drive_is_the_beginning_of_the_next() -> None:
    for instant in range(5):
        assert PEAK.at(instant, 1.0) == PEAK.at(instant + 1, 0.0)
        assert PEAK.before(instant + 1) == VALUES[instant]
    changes = [PEAK.changes(instant) for instant in range(6)]
    assert changes == [False, True, False, True, True, True]
    assert [PEAK.falls(instant) for instant in range(6)] == [False] * 4 + [True, False]
    assert PEAK.largest == 4.0


def test_a_load_is_told_with_its_share_of_the_largest_of_its_sign() -> None:
    assert PEAK.at(1, 0.75) == "peak = 1.5 N (0.5 times its largest value)"
    assert PEAK.at(4) == "peak = -1 N (0.25 times its largest value)"
    assert PEAK.at(0) == "peak = 0 N"
    doubled = replace(PEAK, values=2.0 * VALUES)
    words = [of.at(3).partition(" (")[2] for of in (PEAK, doubled)]
    assert words[0] == words[1]


def test_only_what_changes_is_told_and_what_falls_is_passed_downwards() -> None:
    falling = Drive("pressure", "Pa", np.array([8.0, 8.0, 8.0, 4.0, 4.0, 4.0]))
    assert loads_at([PEAK, falling], 2) == ""
    assert beyond([PEAK, falling], 2, 0.5) == ""
    assert loads_at([PEAK, falling], 1) == PEAK.at(1)
    both = beyond([PEAK, falling], 3, 0.5)
    assert both == f"beyond {PEAK.at(3, 0.5)} and below {falling.at(3, 0.5)}"
    assert beyond([PEAK], 1, 0.0) == f"with {PEAK.at(1)}"
    assert PEAK.during(slice(2, 4)).values.tolist() == [2.0, -4.0]
