"""All that acts sums to zero at every instant: forces, reactions, and moments."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np
import pytest
from contact_problems import block
from friction_laws import LAWS, law_of
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st
from ropes import SMALL_ROPE
from small_scenes import SMALL

from solver import discrete
from solver.arrays import Array, Indices
from solver.discrete import Side, SideComponent, Stack, Support
from solver.discrete.plane.rectangles.bricks import Brick
from solver.discrete.probes import LoopFields, reaction, reaction_moment
from solver.discrete.problem import Problem
from solver.discrete.rods.rods import Rods
from solver.latin import Latin, iterations
from solver.reference.assembly import external_force
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.settings.scene import Settings
from solver.study.scene_run import finished_run

ROUNDING = 1e-9
"""Share of the largest force up to which sums of forces vanish."""
END = st.sampled_from(["held", "spring", "pulled", "free"])
SIDE = st.sampled_from(
    ["free", "roller", "clamped", "displacement", "traction", "pushed", "dragged"]
)
HELD_TOP = st.sampled_from(["displacement", "pushed", "clamped"])


def assert_vanish(total: Array, terms: list[Array]) -> None:
    """Sums over time are nothing beside the largest of their terms."""
    largest = max(float(np.abs(term).max()) for term in terms)
    assert np.abs(total).max() <= ROUNDING * largest


def assert_rods_balance(rods: Rods, problem: Problem, fields: LoopFields) -> None:
    """Along rods: both ends, body forces and what supports rub."""
    shares = np.full(rods.elements + 1, rods.length / rods.elements)
    shares[[0, -1]] *= 0.5
    terms = [
        rods.wires * rods.end_force(problem, side).of(fields)
        for side in ("left", "right")
    ]
    if rods.body_force is not None:
        along = np.broadcast_to(rods.body_force, (len(shares), problem.n_instants))
        terms.append(rods.wires * shares @ along)
    if rods.wires == 1:
        terms.append(fields.contact("friction").tangential_force.sum(axis=0))
    assert_vanish(np.sum(terms, axis=0), terms)


def loads_of(problem: Problem) -> tuple[Array, Array, Array]:
    """Resultants, N, of all loads, and their moment, N m, (n_instants,) each."""
    assert problem.inside is not None
    force = external_force(problem) * problem.scales.force
    (x, y) = problem.positions.T
    along_x, along_y, turn = problem.inside.directions.T
    moment = x * along_y - y * along_x + turn
    return along_x @ force, along_y @ force, moment @ force


def on_supports(
    problem: Problem, fields: LoopFields
) -> tuple[list[Array], list[Array], list[Array]]:
    """Forces along x and y of supports and springs, (n_instants,) each.

    And their moments about the origin.
    """
    x = []
    y = []
    moments = []
    for name, law in problem.contacts.items():
        if not law.is_on_support:
            continue
        contact = fields.contact(name)
        _, pairs = np.unique(law.points, return_index=True)
        if law.is_spring:
            assert contact.normal_force is not None
            x.append(contact.normal_force.sum(axis=0))
            continue
        forces = [(law.tangent, contact.tangential_force)]
        if contact.normal_force is not None and law.normal is not None:
            forces.append((law.normal.component, contact.normal_force))
        for component, force in forces:
            rows = component.above[pairs]
            along_x, along_y, moment = resultants(problem, rows, force)
            x.append(along_x)
            y.append(along_y)
            moments.append(moment)
    return x, y, moments


def resultants(
    problem: Problem, rows: Indices, force: Array
) -> tuple[Array, Array, Array]:
    """Resultants, N, and moment about the origin, N m, (n_instants,) each.

    Of forces, (n_rows, n_instants), N, on boundary rows, (n_rows,).
    """
    assert problem.inside is not None
    dofs = problem.row_dofs[rows]
    across, up = problem.positions[dofs].T
    along_x, along_y, _ = problem.inside.directions[dofs].T
    moment = (across * along_y - up * along_x) @ force
    return along_x @ force, along_y @ force, moment


def assert_bodies_balance(problem: Problem, fields: LoopFields) -> None:
    """Check bodies in the plane along x and y, and about the origin."""
    loads = loads_of(problem)
    every = [
        [load, *more]
        for load, more in zip(loads, on_supports(problem, fields), strict=True)
    ]
    for side in problem.held_dofs:
        for component in (0, 1):
            every[component].append(reaction(problem, side, component).of(fields))
        every[2].append(reaction_moment(problem, side).of(fields))
    length = float(np.ptp(problem.positions, axis=0).max())
    forces = [*every[0], *every[1]]
    for terms in every[:2]:
        assert_vanish(np.sum(terms, axis=0), forces)
    turning = np.sum(every[2], axis=0)
    # Friction acts on both sides of a gap, which its forces turn.
    turning = np.maximum(np.abs(turning) - turned_by_friction(problem, fields), 0.0)
    assert_vanish(turning, [length * force for force in forces])


def turned_by_friction(problem: Problem, fields: LoopFields) -> Array:
    """Largest moment of friction forces across open gaps, (n_instants,), N m."""
    moment = np.zeros(problem.n_instants)
    for name, law in problem.contacts.items():
        if law.normal is not None and not law.is_spring:
            gap = float(np.abs(law.normal.gap).max()) * problem.scales.displacement
            moment += gap * np.abs(fields.contact(name).tangential_force).sum(axis=0)
    return moment


def assert_balance(settings: Settings, fields: LoopFields, problem: Problem) -> None:
    structure = settings.structure()
    if isinstance(structure, Rods):
        assert_rods_balance(structure, problem, fields)
    elif settings.kind == "plane":
        assert_bodies_balance(problem, fields)
    else:
        friction = [
            fields.contact(name).tangential_force.sum(axis=0)
            for name in problem.contacts
        ]
        loads = external_force(problem).sum(axis=0) * problem.scales.force
        ends = [reaction(problem, end).of(fields) for end in ("support", "load")]
        terms = [*friction, *ends, loads]
        assert_vanish(
            np.sum(terms, axis=0), [*terms, np.abs(external_force(problem)).sum(axis=0)]
        )


def small(scene: str, law: str) -> Settings:
    kind = "plane" if CATALOGUE[scene].kind == "plane" else "rod"
    sizes = SMALL[scene] | {"instants": 7, "substructures": 2}
    if scene == "rope":
        sizes = {**SMALL_ROPE, "elements": 6, "instants": 7}
    if scene == "wall":
        del sizes["substructures"]
    if scene == "belt":
        # Where friction softens, less of the drum holds.
        sizes["pull"] = 300.0
    return CATALOGUE[scene].checked(sizes | law_of(kind, law))


@pytest.mark.parametrize("law", [*LAWS, "general"])
@pytest.mark.parametrize("scene", SMALL)
def test_every_scene_balances_under_every_law(scene: str, law: str) -> None:
    settings = small(scene, law)
    problem = discretise(settings)
    reference = reference_of(problem)
    assert reference.converged.all()
    assert_balance(settings, reference, problem)


@pytest.mark.parametrize("scene", SMALL)
def test_the_answer_of_a_run_balances(scene: str) -> None:
    run = finished_run(small(scene, "coulomb"), errors=False, indicators=False)
    assert run.solution.is_certified
    assert_balance(run.settings, run.iterate, run.problem)


LAW = st.sampled_from([*LAWS, "general"])


@examples(max_examples=12)
@given(
    left=END, right=END, law=LAW, seed=st.integers(0, 10**6), parts=st.integers(1, 3)
)
def test_a_rod_balances_whatever_is_at_its_ends(
    left: str, right: str, law: str, seed: int, parts: int
) -> None:
    generator = np.random.default_rng(seed)
    sizes = generator.uniform(-1.0, 1.0, 7)
    settings = CATALOGUE["bar"].checked(
        {
            "left_end": left,
            "right_end": right,
            "left_force": 300.0 * sizes[0],
            "peak": 300.0 * sizes[1],
            "support_displacement": 1e-3 * sizes[2],
            "right_displacement": 1e-3 * sizes[3],
            "right_load": "hold",
            "right_spring": 10.0 ** generator.uniform(4.0, 8.0),
            "temperature": 50.0 * sizes[4],
            "settlement": 1e-3 * sizes[5],
            "settlement_load": "random",
            "body_force": 300.0 * sizes[6],
            "seed": seed,
            "elements": 6,
            "instants": 7,
            "substructures": parts,
            **law_of("rod", law),
        }
    )
    problem = discretise(settings)
    reference = reference_of(problem)
    assert reference.converged.all()
    assert_balance(settings, reference, problem)


@examples(max_examples=10)
@given(left=SIDE, right=SIDE, top=HELD_TOP, law=LAW, seed=st.integers(0, 10**6))
def test_a_block_balances_whatever_is_at_its_sides(
    left: str, right: str, top: str, law: str, seed: int
) -> None:
    generator = np.random.default_rng(seed)
    sizes = generator.uniform(-1.0, 1.0, 8)
    sides = {"left": left, "right": right, "top": top}
    on_a_side = {
        "normal_displacement": -1e-5 * abs(sizes[0]),
        "tangential_displacement": 2e-5 * sizes[1],
        "normal_traction": -1e6 * abs(sizes[2]),
        "tangential_traction": 1e6 * sizes[3],
        "normal_slope": sizes[4],
        "normal_load": "sine",
    }
    given_there: dict[str, Any] = {}
    for side in sides:
        given_there |= {f"{side}_{name}": value for name, value in on_a_side.items()}
    settings = CATALOGUE["block"].checked(
        sides
        | given_there
        | {
            "top_normal_load": "hold",
            "gap": "flat",
            "body_force_y": -1e6 * abs(sizes[5]),
            "body_force_x": 1e5 * sizes[6],
            "elements": 6,
            "elements_up": 2,
            "instants": 7,
            "substructures": 2,
            "substructures_up": 1,
        }
        | law_of("plane", law)
    )
    problem = discretise(settings)
    reference = reference_of(problem)
    assert reference.converged.all()
    assert_balance(settings, reference, problem)


def test_bodies_whose_ends_are_moved_and_turned_rub_there_as_the_law_says() -> None:
    """The ends' last moves are alike: their difference is rounding, and no slip."""
    times = np.linspace(0.0, 1.0, 9)
    free = SideComponent(False, 0.0 * times)
    turned = SideComponent(
        True, 1e-5 * np.sin(6.0 * times), 1e-5 * np.minimum(3.0 * times, 1.0)
    )
    stack = Stack(
        length=0.2,
        height=0.1,
        elements=(8, 4),
        substructures=(2, 1),
        young=1e9,
        poisson=0.3,
        instants=times,
        duration=1.0,
        friction=0.3,
        bricks=[Brick(0, 0, 8, 4), Brick(0, 4, 8, 4)],
        support=Support(gap=np.zeros(9), friction=0.2),
        sides={
            "left": Side(turned, free),
            "top": Side(
                free, SideComponent(False, -1e6 * np.minimum(4.0 * times, 1.0))
            ),
        },
    )
    problem = discrete.discretise(stack)
    reference = reference_of(problem)
    iterate = next(islice(iterations(problem, Latin()), 200, None))
    for fields in (reference, iterate):
        between = fields.contact("contact 1-2")
        friction = between.tangential_force[0]
        bound = 0.3 * between.normal_force[0]
        np.testing.assert_allclose(friction[1:3], bound[1:3], rtol=1e-6)
        assert (np.abs(friction) <= (1.0 + 1e-9) * bound).all()
        # Where both stand, as much per area as beside, where the share is whole.
        beside = np.clip(0.5 * between.tangential_force[1], -bound, bound)
        np.testing.assert_allclose(friction[5:], beside[5:], rtol=1e-6)
    assert_bodies_balance(problem, reference)


LYING: dict[str, tuple[list[Brick], int]] = {
    "beside its left end": ([Brick(0, 0, 6, 4), Brick(2, 4, 4, 4)], 6),
    "in the middle": ([Brick(0, 0, 6, 4), Brick(1, 4, 3, 4)], 6),
    "at both ends": (
        [Brick(0, 0, 6, 4), Brick(0, 4, 2, 4), Brick(4, 4, 2, 4)],
        6,
    ),
    "beyond it": ([Brick(0, 0, 5, 4), Brick(2, 4, 4, 4)], 6),
    "below a third": (
        [Brick(0, 0, 6, 4), Brick(2, 4, 2, 2), Brick(0, 6, 6, 2)],
        10,
    ),
}
"""Where a body lies on another, and the elements of all tops that lie open."""


@pytest.mark.parametrize("cuts", [1, 2])
@pytest.mark.parametrize("name", LYING)
def test_pressure_on_a_partly_covered_body_balances_its_support(
    name: str, cuts: int
) -> None:
    """The top is all that lies open above: the load presses any piece it lies on."""
    bricks, open_tops = LYING[name]
    stack = block(elements=(6, 4), cuts=(cuts, 1), bodies=2, shear=0.05)
    stack = replace(stack, bricks=bricks)
    problem = discrete.discretise(stack)
    reference = reference_of(problem)
    assert reference.converged.all()
    assert_bodies_balance(problem, reference)
    on_support = [
        reference.contact(contact).normal_force.sum(axis=0)
        for contact, law in problem.contacts.items()
        if law.is_on_support
    ]
    element = stack.length / stack.elements[0]
    pressure = -stack.sides["top"].y.mean
    pressed = open_tops * element * pressure
    np.testing.assert_allclose(np.sum(on_support, axis=0), pressed, rtol=1e-9)


def test_a_moved_top_is_that_of_the_highest_bodies_however_they_are_cut() -> None:
    """A displacement of the top is that of a press, which touches no lower body."""
    stack = block(elements=(6, 4), cuts=(1, 1), bodies=2)
    still = SideComponent(True, 0.0 * stack.instants)
    pushed = SideComponent(True, -1e-4 * np.minimum(4.0 * stack.instants, 1.0))
    bricks, _ = LYING["in the middle"]
    stack = replace(stack, bricks=bricks, sides={"top": Side(still, pushed)})
    forces = []
    for cuts in ((1, 1), (6, 2)):
        problem = discrete.discretise(replace(stack, substructures=cuts))
        reference = reference_of(problem)
        assert reference.converged.all()
        assert_bodies_balance(problem, reference)
        inside = problem.inside
        assert inside is not None
        moved = inside.displacement(reference.displacement, [16])[:, 1, 0]
        x, y = (inside.nodes / (stack.length / 6, stack.height / 4)).T.round(6)
        np.testing.assert_allclose(moved[y == 8.0], -1e-4, rtol=1e-12)
        assert np.abs(moved[(y == 4.0) & (x == 6.0)]).max() < 1e-5
        forces.append(reaction(problem, "top", 1).of(reference))
    np.testing.assert_allclose(forces[0], forces[1], rtol=1e-9, atol=1e-6)
