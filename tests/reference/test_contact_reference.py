"""The incremental reference obeys contact exactly, or says where it does not."""

from itertools import product

import numpy as np
import pytest
from contact_problems import (
    COURSES,
    block,
    on_a_support,
    problem,
    rubbing_strands,
    stiffness,
    substructure,
    two_bodies,
)

from solver.cache import CACHE
from solver.discrete import discretise
from solver.reference.assembly import (
    Interrupted,
    NoReferenceError,
    assembled_stiffness,
    external_force,
)
from solver.reference.distance import determinate_forces, kkt_residual
from solver.reference.incremental import reference_of
from solver.reference.instants import Instants
from solver.reference.newton import Newton
from solver.scenes import CATALOGUE
from solver.scenes import discretise as discretise_scene

SMALL = 1e-10


def components(of, found):
    """Opening or None, slip, normal force or bound, friction of every interface."""
    displacement = found.displacement
    for name, law in of.contacts.items():
        fields = found.contact(name)
        slip = np.diff(fields.slip, axis=1, prepend=0.0)
        if law.opens:
            bound = law.tangential.friction[:, None] * fields.normal_force
            yield (
                fields.opening,
                slip,
                fields.normal_force,
                bound,
                fields.tangential_force,
            )
        else:
            bound = np.broadcast_to(law.tangential.bound, slip.shape)
            yield None, slip, None, bound, fields.tangential_force
    assert np.isfinite(displacement).all()


def assert_laws(of, found, slack=SMALL):
    """Check Signorini and Coulomb on the fields, and equilibrium of the structure."""
    for opening, slip, normal, bound, friction in components(of, found):
        if opening is not None:
            assert opening.min() >= -slack
            assert normal.min() >= -slack
            np.testing.assert_allclose(opening * normal, 0.0, atol=slack)
        assert np.all(np.abs(friction) <= bound + slack)
        np.testing.assert_allclose(friction * slip, -bound * np.abs(slip), atol=slack)
    free = np.setdiff1d(np.arange(of.n_dofs), of.prescribed[0])
    total = external_force(of) - assembled_stiffness(of) @ found.displacement
    for name, law in of.contacts.items():
        fields = found.contact(name)
        force = [fields.normal_force, fields.tangential_force][-len(law.components) :]
        for one, component in zip(force, law.components, strict=True):
            for rows, sign in zip(component.sides, (1.0, -1.0), strict=False):
                total[of.row_dofs[rows]] += sign * one
    np.testing.assert_allclose(total[free], 0.0, atol=slack)


def system_in(of, states, before, instant):
    """System for displacements and contact forces of a body in given states."""
    load = external_force(of)[:, instant]
    law = of.contacts["support"]
    size = of.n_dofs
    system = np.zeros((2 * size, 2 * size))
    right = np.concatenate([load, np.zeros(size)])
    system[:size, size:] = -np.eye(size)
    system[:size, :size] = of.substructures[0].elasticity.stiffness
    for point, state in enumerate(states):
        tangent = 2 * point
        normal = 2 * point + 1
        if state == "open":
            forces = [size + tangent, size + normal]
            system[forces, forces] = 1.0
            continue
        system[size + normal, normal] = 1.0
        right[size + normal] = -law.normal.gap[point]
        if state == "stick":
            right[size + tangent] = before[tangent]
            system[size + tangent, tangent] = 1.0
        else:
            friction = state * law.tangential.friction[point]
            system[size + tangent, size + tangent] = 1.0
            system[size + tangent, size + normal] = friction
    return system, right


def all_solutions(of, before, instant):
    """Enumerate the states of a body on a support;
    give the displacements that obey every law.
    """
    law = of.contacts["support"]
    found = []
    for states in product(("open", "stick", 1.0, -1.0), repeat=of.n_dofs // 2):
        system, right = system_in(of, states, before, instant)
        displacement, force = np.linalg.solve(system, right).reshape(2, of.n_dofs)
        slip = (displacement - before)[::2]
        friction = force[::2]
        normal = force[1::2]
        bound = law.tangential.friction * normal
        good = (
            normal.min() >= -1e-12
            and (displacement[1::2] + law.normal.gap).min() >= -1e-12
        )
        good &= np.all(np.abs(friction) <= bound + 1e-12)
        if good and np.all(np.abs(friction * slip + bound * np.abs(slip)) <= 1e-12):
            found.append(displacement)
    return found


@pytest.mark.parametrize("friction", [0.3, 1.0, 4.0])
@pytest.mark.parametrize("points", [1, 2, 3])
def test_the_solution_is_one_of_those_that_trying_all_states_finds(points, friction):
    rng = np.random.default_rng(points)
    alone = 0
    for load in COURSES:
        of = on_a_support(rng, points, friction, load=load)
        found = reference_of(of).displacement
        before = np.zeros(of.n_dofs)
        for instant, displacement in enumerate(found.T):
            ways = all_solutions(of, before, instant)
            apart = [np.abs(displacement - one).max() for one in ways]
            assert min(apart) < SMALL
            alone += max(apart) < SMALL
            before = displacement
    assert alone > 12 or friction > 1.0


def test_an_instant_that_is_called_ambiguous_has_several_solutions():
    rng = np.random.default_rng(0)
    seen = 0
    for _ in range(60):
        of = on_a_support(rng, 2, 6.0, instants=4)
        found = reference_of(of)
        before = np.zeros((of.n_dofs, 1))
        for instant in np.flatnonzero(found.ambiguous):
            path = np.hstack([before, found.displacement])
            assert len(all_solutions(of, path[:, instant], instant)) > 2
            seen += 1
    assert seen > 1
    assert not reference_of(on_a_support(rng, 20, 0.3)).ambiguous.any()


@pytest.mark.parametrize("friction", [0.0, 0.3, 10.0])
@pytest.mark.parametrize("load", COURSES)
@pytest.mark.parametrize("make", [on_a_support, two_bodies])
def test_whatever_the_load_and_the_friction_held_bodies_obey_every_law(
    make, load, friction
):
    rng = np.random.default_rng(5)
    for points in (1, 4, 15):
        of = make(rng, points, friction, load=load, instants=8)
        found = reference_of(of)
        assert kkt_residual(found, of) <= SMALL
        assert found.converged.all()
        assert_laws(of, found)


@pytest.mark.parametrize("ring", [False, True])
@pytest.mark.parametrize("strands", [3, 4])
def test_strands_that_rub_on_each_other_obey_every_law(strands, ring):
    of = rubbing_strands(np.random.default_rng(3), strands, 9, ring=ring)
    found = reference_of(of)
    assert kkt_residual(found, of) <= SMALL
    assert determinate_forces(of).all() != ring
    assert_laws(of, found)
    assert {-1, 0, 1} == set(np.unique(found.status))


def test_a_block_under_more_shear_than_friction_carries_is_said_to_be_lost():
    of = discretise(block(shear=0.5, height=0.2))
    found = reference_of(of)
    shear = 0.5 * np.sin(2.0 * np.pi * np.maximum(of.instants - 0.25, 0.0) / 0.75)
    carried = np.logical_and.accumulate(np.abs(shear) < 0.3)
    assert np.array_equal(found.converged, carried)
    last = int(carried.sum()) - 1
    share = (0.3 - shear[last]) / (shear[last + 1] - shear[last])
    exact = of.instants[last] + share * (of.instants[last + 1] - of.instants[last])
    assert found.collapse.time == pytest.approx(exact, rel=1e-9)
    assert kkt_residual(found, of) > 1e-3
    assert np.abs(found.displacement).max() < 0.1


def test_an_instant_that_no_guess_leads_to_is_found_in_parts(monkeypatch):
    settings = CATALOGUE["arch"].checked({"voussoirs": 9, "instants": 5})
    moved = discretise_scene(settings)
    expected = reference_of(moved)
    missing = []
    follow = Newton.follow
    solved = Instants._solved

    def noted(self, right_sides, instant):
        # Where nothing has acted before there is no solution to begin from.
        if instant > 1:
            missing.extend(["from a guess", "from softer springs"])
        return solved(self, right_sides, instant)

    def missed(self, begin, right_sides, guesses):
        if missing:
            missing.pop()
            return None
        return follow(self, begin, right_sides, guesses)

    monkeypatch.setattr(Instants, "_solved", noted)
    monkeypatch.setattr(Newton, "follow", missed)
    found = reference_of(moved)
    assert not expected.is_lost
    assert not found.is_lost
    size = np.abs(expected.contact_force).max()
    np.testing.assert_allclose(
        found.contact_force, expected.contact_force, rtol=0.0, atol=1e-9 * size
    )


def test_a_body_that_nothing_holds_even_glued_is_refused():
    rng = np.random.default_rng(0)
    rigid = np.ones((1, 4))  # moves all points together, at no energy
    keep = np.eye(4) - rigid.T @ rigid / 4.0
    parts = [
        substructure(
            keep @ stiffness(rng, 4) @ keep, (4 * one, 4 * one), np.ones((4, 2))
        )
        for one in range(2)
    ]
    of = rubbing_strands(rng, 2, 4, instants=2)
    with pytest.raises(
        NoReferenceError, match="even where all its contacts are closed"
    ):
        reference_of(problem(parts, of.interfaces, 2))


def test_a_stop_is_asked_before_every_system_and_interrupts_at_any():
    of = on_a_support(np.random.default_rng(0), 2, 0.3)
    asked: list[int] = []
    steps = reference_of(of, stop=lambda: bool(asked.append(0))).steps
    assert steps > 2 * of.n_instants
    assert len(asked) >= steps
    for last in range(len(asked)):
        CACHE.clear()  # a condensation that is kept asks no more
        answers = iter([False] * last + [True])
        with pytest.raises(Interrupted):
            reference_of(of, stop=lambda answers=answers: next(answers))
        assert next(answers, None) is None
