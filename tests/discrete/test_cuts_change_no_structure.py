"""Cut or not, a structure is the same, and so is what lies inside."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from contact_problems import block
from scipy import sparse

from solver.arrays import Array
from solver.discrete import discretise
from solver.discrete.plane.cut_bodies import CutBodies
from solver.discrete.plane.rectangles.bricks import Brick
from solver.discrete.plane.rectangles.sides import Side, SideComponent
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.plane.rectangles.stack_problem import bodies_of, ends_along
from solver.discrete.problem import Problem
from solver.discrete.rods.cut_rods import CutRods
from solver.discrete.rods.end import End
from solver.discrete.rods.rods import Rods
from solver.discrete.schur_complement import SchurComplement
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
    for name, law in whole.contacts.items():
        other = cut.contacts[name]
        bounds = (one.by_point(one.tangential.bound) for one in (law, other))
        assert next(bounds) == pytest.approx(next(bounds), rel=1e-12)
        areas = (one.by_point(one.weights) for one in (law, other))
        assert next(areas) == pytest.approx(next(areas), rel=1e-12)
    wanted = reference_of(whole)
    found = reference_of(cut)
    assert close(found.displacement, wanted.displacement, 1e-9)
    assert found.contact_force == pytest.approx(wanted.contact_force, abs=1e-6)


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
            SideComponent(False, 1e5 * np.linspace(0.0, 1.0, 17), 0.4),
            SideComponent(False, np.zeros(17)),
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
def test_cut_stiffness_and_load_condense_to_the_uncut_ones(
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


def test_a_stiffness_turned_round_is_that_of_the_turned_directions() -> None:
    random = np.random.default_rng(5)
    factor = random.normal(size=(9, 9))
    whole = factor @ factor.T
    kept = np.array([1, 4, 5, 8])
    signs = np.ones(9)
    signs[[1, 5]] = -1.0
    turned = SchurComplement(sparse.csc_array(whole), kept).with_signs(signs[kept])
    wanted = SchurComplement(sparse.csc_array(signs[:, None] * whole * signs), kept)
    force = random.normal(size=(9, 3))
    moved = random.normal(size=(4, 3))
    assert np.array_equal(turned.stiffness, wanted.stiffness)
    assert close(turned.condense(force), wanted.condense(force))
    assert close(turned.recover(moved, force), wanted.recover(moved, force))


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
    left = Side(SideComponent(False, pull), SideComponent(False, still))
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
    cut = CutBodies(bodies_of(pressed((3, 2), bodies=2)))
    areas = [len(part.mesh.elements) for part in cut.parts]
    assert sum(areas) == 2 * 6 * 4
    of_parts = [
        np.concatenate([part.rows(name).ravel() for name in part.traces])
        for part in cut.parts
    ]
    rows = np.concatenate(of_parts)
    assert np.array_equal(np.sort(rows), np.arange(len(rows)))
    lengths: dict[str, float] = {}
    for piece in cut.pieces:
        name = cut.structure.joints[piece.joint].name
        lengths[name] = lengths.get(name, 0.0) + float(piece.weights.sum())
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
