"""What many cycles of a load cost: LATIN and LATIN-PGD, at once and in slabs of a cycle.

As in `solver.study.benchmarks.ahead`: iterations to 1 % of the contact force are counted without
the clock, then each way runs for so many, from the discrete problem on, in turns.
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin import Iterate, Latin, iterations
from solver.latin.iteration import Iteration
from solver.latin.slabs import Slab, first_slab, next_slab
from solver.reference.choice import reference_of
from solver.reference.distance import distance_to
from solver.reference.solution import Reference
from solver.running.alone import alone
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.study.benchmarks.ahead import GOAL, MOST
from solver.study.benchmarks.cycles_problems import INSTANTS, CyclesProblem
from solver.study.speed.timed import seconds_of

LONGEST = 60.0
"""Seconds of the processor after which a way is given up."""
SHORT = 2.0
"""Seconds of all ways up to which each is measured as often as asked; once otherwise."""
FIRST = 0.5
"""Share of the goal in the first slab: its error goes on into the next."""
MODES = 40
"""Of LATIN-PGD: with 20 the block of 192 x 96 elements stalls at 4 to 6 % (measured)."""
NUMBER = 8
"""Bytes."""


@dataclass(frozen=True)
class Way:
    """A way to many cycles.

    Attributes
    ----------
    name
        What it is called.
    changes
        Settings of the method.
    in_slabs
        Whether slab after slab of a cycle.
    """

    name: str
    changes: dict[str, Any]
    in_slabs: bool


WAYS = (
    Way("LATIN", {}, in_slabs=False),
    Way("LATIN-PGD", {"linear_stage": "pgd", "pgd_modes": MODES}, in_slabs=False),
    Way("LATIN in slabs", {}, in_slabs=True),
    Way("LATIN-PGD in slabs", {"linear_stage": "pgd", "pgd_modes": MODES}, in_slabs=True),
)


@dataclass(frozen=True)
class Taken:
    """What a way takes to 1 % of the contact force; NaN where it does not come there.

    Attributes
    ----------
    seconds
        Of the processor, median, from the discrete problem to the last iterate.
    iterations
        Of all slabs.
    local
        Share of the local stage in that time.
    modes
        Most of a substructure; 0 of full fields.
    megabytes
        That the state holds, of all instants or of a slab.
    """

    seconds: float
    iterations: float
    local: float
    modes: int
    megabytes: float


NOT_THERE = Taken(math.nan, math.nan, math.nan, 0, math.nan)


@dataclass(frozen=True)
class Cycles:
    """What a number of cycles takes.

    Attributes
    ----------
    number
        Of cycles.
    incremental
        Seconds of the processor of the incremental solver, median, from the discrete problem on.
    taken
        By name of the way.
    """

    number: int
    incremental: float
    taken: dict[str, Taken]

    def over(self, other: str, way: str) -> float:
        """Give the speed-up of a way over another, or over the incremental solver ("")."""
        seconds = self.taken[other].seconds if other else self.incremental
        return seconds / self.taken[way].seconds


def cycles_of(
    problem: CyclesProblem, number: int, repeats: int, ways: Sequence[str] | None = None
) -> Cycles:
    """Measure some ways, or all, in a process of its own."""
    names = [way.name for way in WAYS] if ways is None else list(ways)
    asked = {
        "scene": problem.scene,
        "changes": problem.settings(number),
        "repeats": repeats,
        "ways": names,
    }
    found = alone(__name__, asked)
    taken = {way.name: NOT_THERE for way in WAYS}
    taken.update({name: Taken(**own) for name, own in found["taken"].items()})
    return Cycles(number, found["incremental"], taken)


def answer(asked: dict[str, Any]) -> dict[str, Any]:
    """Measure in this process: seconds of the incremental solver, and what each way takes."""
    settings = CATALOGUE[asked["scene"]].settings.checked(asked["changes"])
    problem = discretise(settings)
    reference = reference_of(problem)
    chosen = [way for way in WAYS if way.name in asked["ways"]]
    found = {way.name: _course(problem, settings, way, reference) for way in chosen}
    counts = {name: own for name, own in found.items() if own is not None}
    samples: dict[str, list[tuple[float, Taken]]] = {name: [] for name in ("", *counts)}
    spent = 0.0
    for turn in range(asked["repeats"]):
        if turn and spent > SHORT:
            break
        seconds = seconds_of(lambda: reference_of(_fresh(problem)))
        samples[""].append((seconds, NOT_THERE))
        for way in chosen:
            if way.name in counts:
                took = _taken(_fresh(problem), settings, way, counts[way.name])
                samples[way.name].append((took.seconds, took))
        spent += sum(own[-1][0] for own in samples.values())
    medians = {name: statistics.median(one for one, _ in own) for name, own in samples.items()}
    return {
        "incremental": medians[""],
        "taken": {
            name: vars(replace(samples[name][-1][1], seconds=medians[name])) for name in counts
        },
    }


def _fresh(problem: Problem) -> Problem:
    """Give a problem of which nothing is known but its matrices and laws."""
    return replace(problem)


def _length(problem: Problem, way: Way) -> int:
    return INSTANTS if way.in_slabs else problem.n_instants


def _method(settings: Settings, way: Way) -> Latin:
    return method_of(settings.replace(**way.changes, finish="none"))


@dataclass(frozen=True)
class _AtInstants:
    """A reference at some instants."""

    displacement: Array
    contact_force: Array


def _course(
    problem: Problem, settings: Settings, way: Way, reference: Reference
) -> list[int] | None:
    """Count the iterations to the goal, slab by slab; None where they do not come there."""
    length, began = _length(problem, way), time.process_time()
    goal = FIRST * GOAL if way.in_slabs else GOAL
    slab: Slab | None = first_slab(problem, _method(settings, way), length)
    counts = []
    while slab is not None:
        part = _AtInstants(
            reference.displacement[:, slab.some], reference.contact_force[:, slab.some]
        )
        distance = distance_to(part, slab.problem)
        for found in islice(_iterates(slab), MOST):
            if distance.of_friction_force(found) <= goal:
                break
            if time.process_time() - began > LONGEST:
                return None
        else:
            return None
        counts.append(found.number)
        goal = GOAL
        slab = next_slab(problem, slab, found, length)
    return counts


def _iterates(slab: Slab) -> Iterator[Iterate]:
    return iterations(slab.problem, slab.latin, slab.start, resumable=False)


def _taken(problem: Problem, settings: Settings, way: Way, counts: Sequence[int]) -> Taken:
    """Measure so many iterations of every slab, and how much of that is the local stage."""
    method, length = _method(settings, way), _length(problem, way)
    local, last = 0.0, None

    def work() -> None:
        nonlocal local, last
        slab: Slab | None = first_slab(problem, method, length)
        for count in counts:
            assert slab is not None
            iteration = Iteration(slab.problem, slab.latin, slab.start)
            for _ in range(count):
                iteration.choose_direction()
                began = time.process_time()
                iteration.local_stage()
                local += time.process_time() - began
                iteration.linear_stage()
            last = iteration.snapshot(count, 0.0, resumable=False)
            slab = next_slab(problem, slab, last, length)

    seconds = seconds_of(work)
    assert last is not None
    numbers, modes = _held(last)
    return Taken(seconds, float(sum(counts)), local / seconds, modes, numbers * NUMBER / 1e6)


def _held(iterate: Iterate) -> tuple[int, int]:
    """Count the numbers that a state holds, and the most modes of a substructure."""
    if iterate.reduction is None:
        return iterate.outgoing.size, 0
    shared = {own.stored: own for own in iterate.bases}
    numbers = sum(2 * own.outgoing.size for own in shared.values())
    numbers += sum(own.time_functions.size for own in iterate.bases)
    return numbers, max(own.n_modes for own in iterate.bases)
