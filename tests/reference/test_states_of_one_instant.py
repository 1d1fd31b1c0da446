"""Jumps span displacements; states make a linear system;
Newton finds them; time is play.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import pytest
from contact_problems import (
    contact,
    course,
    friction_of,
    on_a_support,
    problem,
    rubbing_strands,
    stiffness,
    substructure,
    two_bodies,
)
from scipy import sparse

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.laws import OPEN, Component, Contact
from solver.laws.play import Play, play
from solver.reference import linear_system
from solver.reference.assembly import Interrupted, never
from solver.reference.condensation import Condensation
from solver.reference.factors import UpdatedFactors
from solver.reference.glued import base_of, from_jumps, self_stresses
from solver.reference.instants import Instants
from solver.reference.linear_system import LinearSystem
from solver.reference.newton import Newton
from solver.reference.rules import HELD, Increment, InstantSolution, RightSides, States
from solver.reference.soft_system import SoftSystem
from solver.scenes import discretise
from solver.scenes.incline import InclineSettings
from solver.scenes.wall import WallSettings

SEEDS = range(6)


# Jumps and what is glued


def random_jumps(seed: int, *, rings: bool) -> sparse.csr_array:
    """Jumps between 12 points and the ground, shuffled; a forest, or with rings."""
    random = np.random.default_rng(seed)
    n_points = 12
    edges = [
        (point, int(random.integers(point + 1, n_points + 1)))
        for point in range(n_points)
        if random.random() < 0.7
    ]
    if rings:
        edges += [(0, 3), (3, 7), (0, 7), (5, n_points), (7, n_points)]
    random.shuffle(edges)
    jumps = np.zeros((len(edges), n_points + 1))
    for row, (first, last) in enumerate(edges):
        sign = random.choice([-1.0, 1.0])
        jumps[row, first] = sign
        jumps[row, last] = -sign
    return sparse.csr_array(jumps[:, :-1])


@pytest.mark.parametrize("seed", SEEDS)
def test_jumps_and_glued_motions_span_every_displacement_once(seed: int) -> None:
    jumps = random_jumps(seed, rings=False)
    along, glued = from_jumps(jumps)
    assert np.array_equal((jumps @ along).toarray(), np.eye(jumps.shape[0]))
    assert not (jumps @ glued).toarray().any()
    both = np.hstack([along.toarray(), glued.toarray()])
    assert both.shape == (12, 12)
    assert abs(np.linalg.det(both)) == pytest.approx(1.0)


@pytest.mark.parametrize("seed", SEEDS)
def test_self_stresses_are_complete(seed: int) -> None:
    jumps = random_jumps(seed, rings=True)
    size = jumps.shape[0]
    rigid = np.ones(size, dtype=bool)
    stresses = self_stresses(jumps, rigid)
    assert stresses.shape[1] == size - np.linalg.matrix_rank(jumps.toarray())
    assert stresses.shape[1] >= 2
    assert jumps.T @ stresses == pytest.approx(np.zeros((12, stresses.shape[1])))
    assert stresses.T @ stresses == pytest.approx(np.eye(stresses.shape[1]))


@pytest.mark.parametrize("seed", SEEDS)
def test_jumps_with_springs_in_series_follow_from_a_base_of_the_others(
    seed: int,
) -> None:
    jumps = random_jumps(seed, rings=True)
    rigid = np.random.default_rng(seed).random(jumps.shape[0]) < 0.4
    base, ties = base_of(jumps, rigid)
    assert np.isin(np.flatnonzero(rigid), base).all()
    assert np.array_equal((ties @ jumps[base]).toarray(), jumps.toarray())
    # What depends in the base is rigid jumps alone.
    loose = len(base) - np.linalg.matrix_rank(jumps[base].toarray())
    stiff = jumps[np.flatnonzero(rigid)].toarray()
    assert loose == len(stiff) - np.linalg.matrix_rank(stiff)


# The linear system of known states


def sides_of(condensed: Condensation, random: np.random.Generator) -> RightSides:
    rules = condensed.rules
    bound = np.where(rules.normal, 0.0, random.uniform(0.0, 0.5, len(rules.gap)))
    held = 0.1 * random.normal(size=len(rules.gap))
    return RightSides(random.normal(size=len(condensed.base)), bound, held)


def random_states(rules, random: np.random.Generator) -> States:
    slips = random.integers(-1, 2, size=len(rules.normal))
    opens = np.where(random.random(len(slips)) < 0.5, HELD, OPEN)
    return np.where(rules.normal, opens, slips).astype(np.int8)


def laws_missed(
    condensed: Condensation, states: States, sides: RightSides, step: Increment
) -> float:
    """Largest error of a step in the laws of its states."""
    rules = condensed.rules
    held = states == HELD
    slips = np.abs(states) == 1
    bound = sides.bound + rules.friction * step.force[rules.partner]
    return max(
        np.abs(step.jump - sides.held)[held].max(initial=0.0),
        np.abs(step.force)[states == OPEN].max(initial=0.0),
        np.abs(step.force + states * bound)[slips].max(initial=0.0),
    )


def system_of(condensed: Condensation) -> LinearSystem:
    return LinearSystem(condensed, condensed.stiffness, condensed.gauge)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("make", [on_a_support, two_bodies])
def test_a_step_balances_and_obeys_the_laws_of_its_states(make, seed: int) -> None:
    random = np.random.default_rng(seed)
    condensed = Condensation(make(random, 4, 0.3))
    system = system_of(condensed)
    for _ in range(5):
        states = random_states(condensed.rules, random)
        sides = sides_of(condensed, random)
        step = system(states, sides)
        needed = condensed.stiffness @ step.strained
        carried = system.on_base(step.force) + sides.load
        size = np.abs(needed).max()
        assert needed == pytest.approx(carried, abs=1e-10 * size)
        assert laws_missed(condensed, states, sides, step) <= 1e-10 * size
        assert system.unbalanced <= 1e-10 * size
    assert system.solutions == 5


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("make", [on_a_support, two_bodies])
def test_states_that_change_a_little_are_solved_as_from_the_start(
    make, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(linear_system, "MANY", 1)
    monkeypatch.setattr(linear_system, "CHANGED", 1)
    random = np.random.default_rng(seed)
    condensed = Condensation(make(random, 12, 0.3))
    system = system_of(condensed)
    states = random_states(condensed.rules, random)
    updates = 0
    for _ in range(20):
        sides = sides_of(condensed, random)
        step = system(states, sides)
        wanted = system_of(condensed)
        for found, exact in zip(step, wanted(states, sides), strict=True):
            size = np.abs(exact).max(initial=0.0)
            assert found == pytest.approx(exact, abs=1e-9 * size)
        assert system.has_negative_determinant == wanted.has_negative_determinant
        assert system.is_singular == wanted.is_singular
        updates += isinstance(system._factors, UpdatedFactors)
        # Two jumps take other states: they open, close, stick or turn back.
        changed = random.choice(len(states), 2, replace=False)
        states = states.copy()
        states[changed] = random_states(condensed.rules, random)[changed]
    assert updates >= 10


@pytest.mark.parametrize("far", [1.0, 1e3, 1e6])
def test_forces_are_in_balance_to_the_last_digit_beside_a_far_larger_motion(
    far: float,
) -> None:
    random = np.random.default_rng(4)
    condensed = Condensation(discretise(WallSettings.checked(WallSettings.SMALL)))
    gauge = condensed.gauge
    assert gauge.size
    system = system_of(condensed)
    slips = np.flatnonzero(~condensed.rules.normal)[::7]
    states = np.zeros(len(condensed.rules.gap), dtype=np.int8)
    states[slips] = 1
    sides = sides_of(condensed, random)
    step = system(states, sides)
    assert gauge.T @ step.strained == pytest.approx(0.0, abs=1e-13)
    # Held jumps are moved along with a rigid motion of the bodies.
    moved = far * gauge[:, 0]
    away = system(states, replace(sides, held=sides.held + moved))
    size = np.abs(condensed.stiffness).max()
    assert away.force == pytest.approx(step.force, abs=1e-14 * far * size)
    # Of the motion itself nothing is left in the forces.
    needed = condensed.stiffness @ away.strained
    carried = system.on_base(away.force) + sides.load
    assert needed == pytest.approx(carried, abs=1e-13 * np.abs(needed).max())


@pytest.mark.parametrize("seed", SEEDS)
def test_beside_a_spring_rigid_motions_are_found_with_the_deformation(
    seed: int,
) -> None:
    random = np.random.default_rng(seed)
    settings = InclineSettings.checked(InclineSettings.SMALL | {"spring": 1e5})
    condensed = Condensation(discretise(settings))
    assert condensed.gauge.size
    states = random_states(condensed.rules, random)
    states[condensed.rules.compliance > 0.0] = HELD
    sides = sides_of(condensed, random)
    soft = SoftSystem(condensed, condensed.stiffness, condensed.gauge)
    plain = system_of(condensed)
    for found, exact in zip(soft(states, sides), plain(states, sides), strict=True):
        size = np.abs(exact).max()
        assert found == pytest.approx(exact, abs=1e-9 * size)
    assert soft.has_negative_determinant == plain.has_negative_determinant


def test_friction_that_grows_with_slip_is_its_tangent_at_the_slip_it_comes_to() -> None:
    random = np.random.default_rng(1)
    condensed = Condensation(rubbing_strands(random, 3, 4))
    system = system_of(condensed)
    size = len(condensed.rules.gap)
    growth = random.uniform(0.1, 2.0, size)
    system.set_friction(np.zeros(size), growth)
    states = random.choice([-1, 0, 1], size=size).astype(np.int8)
    sides = sides_of(condensed, random)
    step = system(states, sides)
    slips = states != HELD
    slip = step.jump - sides.held
    wanted = -(states * sides.bound + growth * slip)
    assert step.force[slips] == pytest.approx(wanted[slips], abs=1e-10)
    assert step.jump[~slips] == pytest.approx(sides.held[~slips], abs=1e-14)


def test_a_caller_interrupts_before_a_system_is_solved() -> None:
    condensed = Condensation(rubbing_strands(np.random.default_rng(0), 2, 2))
    system = LinearSystem(condensed, condensed.stiffness, condensed.gauge, lambda: True)
    random = np.random.default_rng(0)
    states = np.zeros(len(condensed.rules.gap), dtype=np.int8)
    with pytest.raises(Interrupted):
        system(states, sides_of(condensed, random))
    assert system.solutions == 0


# Newton's method


def begin(condensed: Condensation, states: States) -> InstantSolution:
    still = np.zeros(len(condensed.rules.gap))
    base = np.zeros(len(condensed.base))
    return InstantSolution(states, Increment(still, still, base, still[:0]), still)


def known_sides(condensed: Condensation, random: np.random.Generator) -> RightSides:
    load = 2.0 * random.normal(size=len(condensed.base))
    size = len(condensed.rules.gap)
    return RightSides(load, random.uniform(0.1, 1.0, size), np.zeros(size))


def enumerated(matrix: Array, sides: RightSides) -> list[tuple[States, Array]]:
    """All states, and jumps, (n,) each, that obey Coulomb's law of known bound."""
    found = []
    for choice in product((-1, 0, 1), repeat=len(matrix)):
        states = np.array(choice, dtype=np.int8)
        slips = np.flatnonzero(states)
        jump = np.zeros(len(matrix))
        right = (sides.load - states * sides.bound)[slips]
        jump[slips] = np.linalg.solve(matrix[np.ix_(slips, slips)], right)
        force = matrix @ jump - sides.load
        obeys_bound = np.all(np.abs(force) <= sides.bound + 1e-12)
        if obeys_bound and np.all(states * jump >= 0.0):
            found.append((states, jump))
    return found


def of_two_strands(
    seed: int,
) -> tuple[np.random.Generator, Condensation, Newton, RightSides]:
    """Random numbers, and an instant of two strands whose bound is known."""
    random = np.random.default_rng(seed)
    condensed = Condensation(rubbing_strands(random, 2, 5))
    return random, condensed, Newton(condensed), known_sides(condensed, random)


@pytest.mark.parametrize("seed", SEEDS)
def test_newton_finds_the_one_solution_among_all_states(seed: int) -> None:
    random, condensed, newton, sides = of_two_strands(seed)
    (only,) = enumerated(condensed.stiffness, sides)
    reached = 0
    for _ in range(10):
        guess = random.integers(-1, 2, size=5).astype(np.int8)
        found = newton.seek(newton.system, begin(condensed, guess), sides)
        if found is None:
            continue
        reached += 1
        assert np.array_equal(found.states, only[0])
        assert found.step.jump == pytest.approx(only[1], abs=1e-11)
        assert newton.stability.continues(found, found, sides)
    assert reached >= 8


@pytest.mark.parametrize("seed", SEEDS)
def test_a_solution_is_found_again_from_itself_in_one_step(seed: int) -> None:
    random = np.random.default_rng(seed)
    condensed = Condensation(rubbing_strands(random, 3, 4))
    newton = Newton(condensed)
    sides = known_sides(condensed, random)
    held = np.zeros(len(condensed.rules.gap), dtype=np.int8)
    at = begin(condensed, held)
    found = newton.follow(at, sides, [at, *newton.approach(at, sides)])
    assert found is not None
    before = newton.system.solutions
    again = newton.seek(newton.system, found, sides)
    assert again is not None
    assert newton.system.solutions == before + 1
    assert np.array_equal(again.step.jump, found.step.jump)


@pytest.mark.parametrize("seed", SEEDS)
def test_springs_that_soften_lead_to_the_solution_from_any_states(seed: int) -> None:
    _, condensed, newton, sides = of_two_strands(seed)
    (only,) = enumerated(condensed.stiffness, sides)
    wrong = begin(condensed, np.where(only[0] == 1, -1, 1).astype(np.int8))
    found = newton.follow(wrong, sides, newton.approach(wrong, sides))
    assert found is not None
    assert np.array_equal(found.states, only[0])
    assert found.step.jump == pytest.approx(only[1], abs=1e-11)
    # States that stay the same while the springs soften are yielded once.
    yielded = [at.states.tobytes() for at in newton.approach(wrong, sides)]
    assert all(earlier != later for earlier, later in pairwise(yielded))


# Instants


def single(k_along: float, k_across: float, bound: float, mu: float, force: Array):
    """A point with springs along and across it, on a support; force (2, n_instants)."""
    part = substructure(np.diag([k_along, k_across]), (0, 0), force)
    if mu > 0.0:
        law = contact(np.array([1]), np.array([0]), None, np.zeros(1), mu)
    else:
        law = Contact(
            tangential=friction_of(Component(np.array([0])), bound=bound),
            points=np.zeros(1, dtype=int),
            positions=np.zeros(1),
            weights=np.ones(1),
        )
        part = substructure(np.array([[k_along]]), (0, 0), force[:1])
    return problem([part], {"support": law}, force.shape[1])


def marched(of: Problem, stop=never) -> tuple[Array, Array]:
    """Jumps and forces of all instants, (n_jumps, n_instants) each."""
    condensed = Condensation(of)
    instants = Instants(condensed, None, None, lambda _: True, stop)
    steps = [instants(number) for number in range(of.n_instants)]
    jump = np.cumsum([step.jump for step in steps], axis=0).T
    return jump, np.array([step.force for step in steps]).T


@pytest.mark.parametrize("seed", SEEDS)
def test_one_point_of_known_bound_is_the_play_operator(seed: int) -> None:
    random = np.random.default_rng(seed)
    force = np.cumsum(random.normal(size=(2, 40)), axis=1)
    jump, friction = marched(single(3.0, 1.0, 0.8, 0.0, force))
    wanted = play(force[:1] / 3.0, np.array([0.8 / 3.0]))
    assert jump == pytest.approx(wanted, abs=1e-12)
    assert friction == pytest.approx(3.0 * wanted - force[:1], abs=1e-12)


@pytest.mark.parametrize("seed", SEEDS)
def test_one_point_that_opens_is_play_with_slack_by_the_pressing_force(
    seed: int,
) -> None:
    random = np.random.default_rng(seed)
    force = np.cumsum(random.normal(size=(2, 40)), axis=1)
    jump, found = marched(single(3.0, 2.0, 0.0, 0.4, force))
    pressing = np.maximum(-force[1], 0.0)
    across = np.maximum(force[1], 0.0) / 2.0
    along = Play(1, 40)(force[:1] / 3.0, 0.4 * pressing[None] / 3.0)[0]
    assert jump == pytest.approx(np.array([across, along]), abs=1e-12)
    assert found[0] == pytest.approx(pressing, abs=1e-12)
    assert found[1] == pytest.approx(3.0 * along - force[0], abs=1e-12)


def test_a_point_is_lifted_off_by_any_pull() -> None:
    force = np.zeros((2, 41))
    force[1] = np.linspace(-0.2, 0.2, 41)
    jump, found = marched(single(3.0, 2.0, 0.0, 0.4, force))
    assert jump[0] == pytest.approx(np.maximum(force[1], 0.0) / 2.0, abs=1e-14)
    assert found[0] == pytest.approx(np.maximum(-force[1], 0.0), abs=1e-14)


def test_an_instant_once_more_adds_nothing() -> None:
    random = np.random.default_rng(5)
    of = on_a_support(random, 4, 0.3, load="wander", instants=8)
    (part,) = of.substructures
    force = part.body_force
    assert force is not None
    twice = substructure(part.elasticity.stiffness, (0, 0), np.repeat(force, 2, axis=1))
    jump, found = marched(of)
    longer = problem([twice], dict(of.interfaces), 16)
    again, forces = marched(longer)
    assert again[:, 1::2] == pytest.approx(again[:, ::2], abs=1e-12)
    assert again[:, 1::2] == pytest.approx(jump, abs=1e-10)
    assert forces[:, 1::2] == pytest.approx(found, abs=1e-10)


def test_nothing_moves_before_something_acts() -> None:
    random = np.random.default_rng(2)
    matrix = stiffness(random, 4)
    force = np.hstack([np.zeros((4, 3)), course(random, "random", 4, 2)])
    law = contact(np.array([1, 3]), np.array([0, 2]), None, np.full(2, 0.1), 0.3)
    jump, found = marched(
        problem([substructure(matrix, (0, 0), force)], {"support": law}, 5)
    )
    assert not jump[:, :3].any()
    assert not found[:, :3].any()
    assert jump[:, 3:].any()
