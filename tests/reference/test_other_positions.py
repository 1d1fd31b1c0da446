"""Other positions of bodies under the same contact forces are proven ones."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver.discrete.problem import Problem
from solver.latin import solve
from solver.reference.incremental import reference_of
from solver.reference.law_residuals import law_residuals
from solver.reference.other_positions import other_positions
from solver.reference.solution import Reference
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of

THICK = {"voussoirs": 7, "thickness": 0.4, "displacement": -4e-4}
RINGS: list[dict[str, Any]] = [
    THICK,
    {"voussoirs": 11, "friction": 0.4, "thickness": 0.3, "displacement": 3e-3},
]
"""Arches whose hinges turn freely at the last instant."""
HELD: list[tuple[str, dict[str, Any]]] = [
    ("arch", {"voussoirs": 9, "displacement": 2e-5}),
    ("wall", {"bricks": 3, "courses": 3, "instants": 13}),
    ("block", {"elements": 12, "instants": 13}),
    ("bar", {"elements": 12, "instants": 13}),
]


def solved(scene: str, changes: dict[str, Any]) -> tuple[Problem, Reference]:
    problem = discretise(CATALOGUE[scene].checked(changes))
    return problem, reference_of(problem)


@pytest.mark.parametrize("changes", RINGS)
def test_another_position_obeys_all_laws_and_one_beyond_its_room_does_not(
    changes: dict[str, Any],
) -> None:
    problem, found = solved("arch", changes)
    last = problem.n_instants - 1
    others = other_positions(problem, found.displacement, found.contact_force)
    way = others[last] - found.displacement[:, last]
    largest = np.abs(found.displacement).max()
    assert np.abs(way).max() > 1e-4 * largest
    residuals = []
    # A body is moved by half of the room that it has.
    for share in (0.0, 1.0, 3.0):
        displacement = found.displacement.copy()
        displacement[:, last] += share * way
        moved = replace(found, displacement=displacement)
        residuals.append(law_residuals(moved, problem).largest)
    assert residuals[1] <= 2.0 * residuals[0] + 1e-12
    assert residuals[2] > 1e3 * residuals[1]


@pytest.mark.parametrize(("scene", "changes"), HELD)
def test_where_contacts_hold_all_bodies_there_is_no_other_position(
    scene: str, changes: dict[str, Any]
) -> None:
    problem, found = solved(scene, changes)
    assert other_positions(problem, found.displacement, found.contact_force) == {}


def test_where_two_answers_differ_another_position_exists() -> None:
    settings = CATALOGUE["arch"].checked(THICK | {"displacement": -3.655543e-4})
    problem = discretise(settings)
    answer = solve(problem, method_of(settings), watch=False)
    found = reference_of(problem)
    assert answer.is_certified
    assert answer.iterate.contact_force == pytest.approx(
        found.contact_force, abs=1e-8 * np.abs(found.contact_force).max()
    )
    apart = np.abs(answer.iterate.displacement - found.displacement).max(axis=0)
    parts = int(np.argmax(apart > 1e-3 * np.abs(found.displacement).max()))
    assert parts > 0
    for fields in (answer.iterate, found):
        others = other_positions(problem, fields.displacement, fields.contact_force)
        assert parts in others
