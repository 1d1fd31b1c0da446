"""LATIN beside the incremental solver on the same mesh: times, and LATIN's way.

`python tests/benchmarks/ahead.py`, of one group `ahead.py strand`; `--large` for those
of minutes
"""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from itertools import islice
from multiprocessing import get_context
from typing import Any

import numpy as np

from solver.latin import Ending, Solution, iterations, judged
from solver.reference.assembly import NoReferenceError
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.scene import Settings
from solver.study.measured_times import incremental, latin, seconds_of
from solver.study.sweep.executors import ONE_THREAD, machine

GOAL = 0.01
"""Error of the contact force that LATIN's own way is to reach."""
NEAR = 0.1
"""Error of the iterate above which a solution that a status step finds is not
LATIN's."""
MOST = 300
"""Iterations of LATIN's own way."""
REPEATS = 3
CELL = 24
"""Elements along a substructure of a block, and up it."""
WIDTHS = (44, 9, 9, 6, 11, 9, 15, 20)
HEAD = (
    *("problem", "LATIN, s", "incr., s", "ratio", "iterations", "found at"),
    *("own way to 1 %", "and known there"),
)
NOTES = (
    "Medians, in seconds of the processor from settings to result, in turns; every "
    "problem in a process of its own. LATIN: `solve` with the scene's defaults. "
    "incr.: the incremental solver.",
    "found at: error of the iterate from which a status step found the solution; with "
    f"* above {NEAR:.0%}, so the incremental solver answered, from LATIN's statuses.",
    f"own way: iterations and seconds until the contact force is within {GOAL:.0%}, "
    "without a status step at the end and without what judges iterates; - is more "
    f"than {MOST}.",
    "known: when such a run says itself that it has converged, all billed, and "
    "whether a status step certifies that or it is an estimate.",
)
Problem = tuple[str, dict[str, Any]]
"""A scene, and what differs from its settings."""


def _block(elements: int) -> Problem:
    sizes = {"elements": elements, "elements_up": elements // 2, "instants": 51}
    cuts = {
        "substructures": elements // CELL,
        "substructures_up": elements // 2 // CELL,
    }
    return "block", sizes | cuts


def _strand(wires: int) -> Problem:
    return "strand", {"wires": wires, "elements": 100, "instants": 101}


PROBLEMS: dict[str, list[Problem]] = {
    "scenes": [(scene, {}) for scene in CATALOGUE],
    "strand": [_strand(wires) for wires in (3, 10, 20)],
    "block": [_block(elements) for elements in (48, 96, 192, 384)],
    "layers": [("layers", {"layers": layers}) for layers in (4, 10, 20)],
    "thin": [
        ("layers", {"length": 0.01 * n, "thickness": 0.01}) for n in (200, 500, 1000)
    ],
}
LARGE: dict[str, list[Problem]] = {
    "scenes": [("bar", {"elements": 1600, "instants": 1600})],
    "strand": [_strand(40)],
    "block": [_block(768)],
    "layers": [("layers", {"layers": 40}), ("layers", {"layers": 20, "elements": 96})],
}


def measure(scene: str, changes: dict[str, Any]) -> list[str]:
    """Cells of a row: LATIN's time and the other's, and LATIN's own way."""
    settings = CATALOGUE[scene].checked(changes)
    has_reference, own_at, known_at, known_by = _course(settings)
    solution = latin(settings)
    number = len(solution.records)
    found_at = _found_at(solution)
    del solution
    samples = []
    for _ in range(REPEATS):
        seconds = math.nan
        if has_reference:
            seconds = seconds_of(lambda: incremental(settings))
        samples.append(
            [
                seconds_of(lambda: latin(settings)),
                seconds,
                _seconds(settings, iterations, own_at),
                _seconds(settings, judged, known_at),
            ]
        )
    mine, other, own, known = np.median(samples, axis=0)
    return [
        _titled(scene, changes),
        *(f"{mine:.2g}", f"{other:.2g}", f"{mine / other:.2g}", str(number), found_at),
        f"{own_at} in {own:.2g}" if own_at else "-",
        f"{known_at} in {known:.2g} {known_by}" if known_at else "-",
    ]


def _titled(scene: str, changes: dict[str, Any]) -> str:
    """Scene and its changed settings."""
    assignments = [f"{name}={value:g}" for name, value in changes.items()]
    return " ".join([scene, *assignments])


def _found_at(solution: Solution) -> str:
    """Estimated error before a certified solution was found, with * if it was far."""
    if not solution.is_certified or len(solution.records) < 2:
        return "-"
    error = solution.records[-2].estimated_error
    return f"{100.0 * error:.2g} %{' *' if error > NEAR else ''}"


def _course(settings: Settings) -> tuple[bool, int, int, str]:
    """Iterations until LATIN's own way is at the goal, and until it is known, or 0."""
    problem = discretise(settings)
    try:
        distance = distance_to(reference_of(problem), problem)
    except NoReferenceError:
        distance = None
    own_at = 0
    known_at = 0
    known_by = ""
    method = method_of(settings.replace(finish="none"))
    for iterate, verdict in islice(judged(problem, method), MOST):
        if not own_at and distance and distance.of_friction_force(iterate) <= GOAL:
            own_at = iterate.number
        if (
            not known_at
            and verdict.status
            and verdict.status.ending is Ending.CONVERGED
        ):
            known_at = iterate.number
            known_by = "estimate" if verdict.certificate is None else "certified"
        if known_at and (own_at or distance is None):
            break
    return distance is not None, own_at, known_at, known_by


def _seconds(
    settings: Settings, way: Callable[..., Iterator[object]], number: int
) -> float:
    """Seconds of a number of iterations that no status step ends; NaN of none."""
    own = settings.replace(finish="none")

    def work() -> None:
        for _ in islice(way(discretise(own), method_of(own)), number):
            pass

    if number:
        return seconds_of(work)
    return math.nan


def main() -> None:
    """Print a row of each problem as soon as it is there."""
    parser = argparse.ArgumentParser(description="LATIN beside the incremental solver.")
    parser.add_argument(
        "group", nargs="?", choices=PROBLEMS, help="these problems alone"
    )
    parser.add_argument("--large", action="store_true", help="those of minutes too")
    chosen = parser.parse_args()
    if chosen.group:
        groups = [chosen.group]
    else:
        groups = list(PROBLEMS)
    problems = []
    for group in groups:
        problems += PROBLEMS[group]
        if chosen.large:
            problems += LARGE.get(group, [])
    os.environ.update(ONE_THREAD)
    print(machine())
    options: dict[str, Any] = {
        "max_tasks_per_child": 1,
        "mp_context": get_context("spawn"),
    }
    with ProcessPoolExecutor(1, **options) as pool:
        for row in (HEAD, *pool.map(measure, *zip(*problems, strict=True))):
            cells = zip(row, WIDTHS, strict=True)
            print(
                "  ".join(cell.ljust(width) for cell, width in cells).rstrip(),
                flush=True,
            )
    print(*NOTES, sep="\n")


if __name__ == "__main__":
    main()
