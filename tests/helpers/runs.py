"""Runs of scenes that several tests make."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin import Iterate, Solution, iterations, solve
from solver.reference.distance import Distance, distance_to
from solver.reference.incremental import reference_of
from solver.reference.solution import Reference, fingerprint
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.scene import Settings

MOST = 50
"""Largest number of references that are kept."""
_KEPT: dict[bytes, Reference] = {}


def settings_of(scene: str, **values: Any) -> Any:
    return CATALOGUE[scene].checked(values)


def distance_of(problem: Problem) -> Distance:
    """Distance to the incremental solution, which is found once by several tests."""
    key = fingerprint(problem)
    if key not in _KEPT:
        if len(_KEPT) == MOST:
            _KEPT.clear()
        _KEPT[key] = reference_of(problem)
    return distance_to(replace(_KEPT[key], problem=problem), problem)


def solved(settings: Settings, *, watch: bool = False, **rest: Any) -> Solution:
    """Solution with its errors; with `watch` with all indicators, too."""
    problem = discretise(settings)
    distance = distance_of(problem)
    return solve(problem, method_of(settings), distance=distance, watch=watch, **rest)


def iterates(settings: Settings, number: int) -> list[Iterate]:
    """First iterates of a run."""
    return list(islice(iterations(discretise(settings), method_of(settings)), number))


def sample(settings: Settings, number: int) -> Iterate:
    """Iterate of some number."""
    return next(
        islice(iterations(discretise(settings), method_of(settings)), number - 1, None)
    )


def errors(settings: Settings, number: int) -> Array:
    """Error of the contact force after each of the first iterations, (number,)."""
    problem = discretise(settings)
    distance = distance_of(problem)
    found = islice(iterations(problem, method_of(settings)), number)
    return np.array([distance.of_friction_force(one) for one in found])


def assert_goes_on(settings: Settings, number: int, place: int) -> None:
    """A run that is resumed at one of its iterates has the others again, to the bit."""
    problem = discretise(settings)
    method = method_of(settings)
    straight = list(islice(iterations(problem, method), number))
    again = islice(
        iterations(problem, method, straight[place].checkpoint), number - place - 1
    )
    for one, other in zip(again, straight[place + 1 :], strict=True):
        assert one.number == other.number
        for name in (
            "k",
            "outgoing",
            "incoming",
            "local_displacement",
            "local_incoming",
        ):
            assert np.array_equal(getattr(one, name), getattr(other, name)), name
        assert [basis.n_modes for basis in one.bases] == [
            basis.n_modes for basis in other.bases
        ]
