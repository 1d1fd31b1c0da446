"""LATIN beside the incremental solver on the same mesh: who is first, and how LATIN gets there.

Each problem has a process of its own. A pass without the clock finds the iterations, and brings in
all code. Then each way starts from settings, in turns, with nothing kept of the one before.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Any

from solver.latin import Decision, Ending, Solution, iterations, judged
from solver.reference.choice import reference_of
from solver.reference.condensation import NoReferenceError
from solver.reference.distance import distance_to
from solver.running.alone import alone
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.study.benchmarks.ahead_problems import AheadProblem
from solver.study.speed.timed import by_increments, by_latin, latins, seconds_of

GOAL = 0.01
"""Error of the contact force that LATIN's own way is to reach."""
NEAR = 0.1
"""Error of the iterate above which a solution that a status step finds is not LATIN's."""
MOST = 300
"""Iterations of LATIN's own way."""


@dataclass(frozen=True)
class Ahead:
    """What a problem takes; medians, in seconds of the processor from settings to result.

    Attributes
    ----------
    latin, iterations
        Of `solve` with the settings as they are, s, and its iterations.
    incremental
        Of the incremental solver, s; NaN where the problem is too large for it.
    found_at
        Error of the iterate from which a status step found the solution; NaN where none did.
    own_iterations, own
        Until the contact force is within 1 % without a status step, s, neither estimate nor
        indicator billed; NaN where 300 iterations do not suffice, or there is no solver beside.
    known_iterations, known
        Until such a run says itself that it has converged, s, all billed; NaN likewise.
    known_by
        What it says that by: "certified" where a status step is its estimate, or "estimate".
    """

    latin: float
    iterations: int
    incremental: float
    found_at: float
    own_iterations: float
    own: float
    known_iterations: float
    known: float
    known_by: str

    @property
    def ratio(self) -> float:
        """Time of LATIN over that of the incremental solver."""
        return self.latin / self.incremental

    @property
    def is_latins(self) -> bool:
        """Whether its answer is LATIN's, and not found from statuses of a far iterate."""
        return not self.found_at > NEAR


def ahead_of(problem: AheadProblem, repeats: int) -> Ahead:
    """Measure a problem in a process of its own."""
    asked = {"scene": problem.scene, "changes": problem.changes, "repeats": repeats}
    return Ahead(**alone(__name__, asked))


def answer(asked: dict[str, Any]) -> dict[str, Any]:
    """Measure in this process, as fields of `Ahead`."""
    settings = CATALOGUE[asked["scene"]].settings.checked(asked["changes"])
    has_reference, own_at, known_at, known_by = _course(settings)
    solution = latins(settings)
    count, found_at = len(solution.records), _found_at(solution)
    del solution
    samples: list[tuple[float, ...]] = []
    for _ in range(asked["repeats"]):
        latin = by_latin(settings)
        incremental = by_increments(settings) if has_reference else math.nan
        own, known = _own_way(settings, own_at), _known_way(settings, known_at)
        samples.append((latin, incremental, own, known))
    latin, incremental, own, known = map(statistics.median, zip(*samples, strict=True))
    return {
        "latin": latin,
        "iterations": count,
        "incremental": incremental,
        "found_at": found_at,
        "own_iterations": own_at,
        "own": own,
        "known_iterations": known_at,
        "known": known,
        "known_by": known_by,
    }


def _course(settings: Settings) -> tuple[bool, float, float, str]:
    """Find when LATIN's own way is within the goal, and when and by what it knows."""
    problem = discretise(settings)
    try:
        distance = distance_to(reference_of(problem), problem)
    except NoReferenceError:
        distance = None
    own_at, known_at, known_by = math.nan, math.nan, ""
    own = settings.replace(finish="none")
    for iterate, verdict in islice(judged(problem, method_of(own), resumable=False), MOST):
        if math.isnan(own_at) and distance and distance.of_friction_force(iterate) <= GOAL:
            own_at = float(iterate.number)
        if math.isnan(known_at) and _is_known(verdict):
            known_at = float(iterate.number)
            known_by = "estimate" if verdict.certificate is None else "certified"
        if math.isfinite(known_at) and (distance is None or math.isfinite(own_at)):
            break
    return distance is not None, own_at, known_at, known_by


def _is_known(verdict: Decision) -> bool:
    return verdict.status is not None and verdict.status.ending is Ending.CONVERGED


def _own_way(settings: Settings, at: float) -> float:
    """Give the time of so many iterations that no status step ends and nothing judges, s."""
    return math.nan if math.isnan(at) else _seconds_of(settings, iterations, int(at))


def _known_way(settings: Settings, at: float) -> float:
    """Give the time of so many with all that judges them, s."""
    return math.nan if math.isnan(at) else _seconds_of(settings, judged, int(at))


def _seconds_of(settings: Settings, way: Callable[..., Iterator[object]], number: int) -> float:
    own = settings.replace(finish="none")

    def work() -> None:
        for _ in islice(way(discretise(own), method_of(own), resumable=False), number):
            pass

    return seconds_of(work)


def _found_at(solution: Solution) -> float:
    """Give the error of the last iterate before a certified solution; NaN without one."""
    if not solution.is_certified or len(solution.records) < 2:
        return math.nan
    return solution.records[-2].estimated_error
