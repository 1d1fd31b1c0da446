"""A law on many interfaces is the laws of each, to the bit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solver import Latin, solve
from solver.discrete import Problem
from solver.latin.direction.directions import automatic
from solver.laws import Contact
from solver.reference.assembly import jumps
from solver.reference.rules import OF_JUMPS, rules_of
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE, discretise

SCENES = ["wall", "layers", "incline"]


def problem_of(scene: str) -> Problem:
    kind = CATALOGUE[scene]
    return discretise(kind(**kind.SMALL))


def apart(problem: Problem) -> Problem:
    """The same problem, in which each interface with friction has a law of its own."""
    laws = {
        name: law
        for name, law in problem.interfaces.items()
        if not isinstance(law, Contact)
    }
    return replace(problem, interfaces=dict(problem.contacts) | laws)


@pytest.fixture(scope="module")
def wall() -> Problem:
    return problem_of("wall")


def test_a_wall_has_a_law_for_its_joints_and_one_for_its_supports(
    wall: Problem,
) -> None:
    assert len(wall.contacts.laws) == 2
    assert len(wall.contacts) > 10
    each = apart(wall)
    assert len(each.contacts.laws) == len(wall.contacts)
    assert each.contacts.names == wall.contacts.names


def test_forces_points_and_jumps_are_stacked_alike(wall: Problem) -> None:
    each = apart(wall)
    assert each.contacts.points == wall.contacts.points
    assert each.contacts.forces == wall.contacts.forces
    for matrix in (lambda one: one.sum_of_contact, jumps, lambda one: one.macro[0]):
        found = matrix(wall)
        wanted = matrix(each)
        assert found.shape == wanted.shape
        assert (found != wanted).nnz == 0


def test_rules_and_search_directions_are_equal_to_the_bit(wall: Problem) -> None:
    each = apart(wall)
    for sticks in (False, True):
        found = automatic(wall, sticks=sticks)
        assert np.array_equal(found, automatic(each, sticks=sticks))
    found = rules_of(wall)
    wanted = rules_of(each)
    for name in OF_JUMPS:
        assert np.array_equal(getattr(found, name), getattr(wanted, name)), name


@pytest.mark.parametrize("scene", SCENES)
def test_a_run_is_equal_to_the_bit_and_so_are_its_fields(scene: str) -> None:
    problem = problem_of(scene)
    found = solve(problem, Latin(), watch=False).iterate
    wanted = solve(apart(problem), Latin(), watch=False).iterate
    assert found.number == wanted.number
    assert np.array_equal(found.outgoing, wanted.outgoing)
    assert np.array_equal(found.status, wanted.status)
    assert np.array_equal(found.friction_force, wanted.friction_force)
    for name in problem.contacts:
        one = found.contact(name)
        other = wanted.contact(name)
        assert np.array_equal(one.tangential_force, other.tangential_force)
        assert np.array_equal(one.slip, other.slip)
        if one.opening is not None:
            assert np.array_equal(one.opening, other.opening)


def test_points_of_two_interfaces_may_not_be_mixed(wall: Problem) -> None:
    law = next(law for law in wall.contacts.laws.values() if len(law.names) > 2)
    assert law.interfaces is not None
    with pytest.raises(RefusedError, match="out of order"):
        replace(law, interfaces=law.interfaces[::-1].copy())
    with pytest.raises(RefusedError, match="interfaces"):
        replace(law, interfaces=None)


def test_an_order_without_all_interfaces_is_refused(wall: Problem) -> None:
    with pytest.raises(RefusedError, match=r"Problem\.order"):
        replace(wall, order=wall.order[1:])
    with pytest.raises(RefusedError, match=r"Problem\.order"):
        replace(wall, order=(*wall.order[1:], wall.order[1]))


def test_the_order_may_be_another(wall: Problem) -> None:
    other = replace(wall, order=wall.order[::-1])
    found = solve(other, Latin(), watch=False).iterate
    wanted = solve(wall, Latin(), watch=False).iterate
    for name in wall.contacts:
        one = found.contact(name).tangential_force
        size = np.abs(wanted.contact_force).max()
        assert one == pytest.approx(
            wanted.contact(name).tangential_force, abs=1e-6 * size
        )
