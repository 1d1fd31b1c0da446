"""Walls of more and more bricks: LATIN beside two incremental solvers on the same mesh.

`python tests/benchmarks/wall_race.py`, of walls of so many courses `wall_race.py 3 5
8`. Each has as many bricks a course, and halves. Every way has a process of its own,
and is measured from the discrete problem on: what prepares it (operators, condensation,
factors) is billed on all sides.
"""

from __future__ import annotations

import argparse
import math
import os
import statistics
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from itertools import islice
from multiprocessing import get_context
from typing import Any

import numpy as np
from sparse_newton import SparseNewton
from whole_cost import resident

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin import Ending, iterations, judged
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.scene import Settings
from solver.study.measured_times import seconds_of
from solver.study.quantities.finished import settle
from solver.study.sweep.executors import ONE_THREAD, machine

COURSES = (3, 5, 8, 12, 16, 32)
"""10, 27, 68, 150, 264, 1040 bricks."""
ALONE = 20
"""Courses from which on LATIN runs alone, beside one run of the sparse solver for its
errors."""
GOAL = 0.01
MOST = 400
SAME = 1e-8
"""Error of the contact force; iterations at most; difference up to which answers are
the same."""
REPEATS = 3
LONG = 20.0
"""Times that each is measured, and seconds from which on once is enough."""
WALL = {
    "displacement": 5e-5,
    "elements": 6,
    "elements_up": 3,
    "instants": 41,
    "finish": "none",
}
"""A tenth of the contact slips, 2 % of it are open."""
PAPER = {"method": "paper", "finish": "none"}
LATIN: dict[str, dict[str, Any]] = {
    "LATIN": {},
    "LATIN, two threads": {"threads": 2},
    "LATIN, monoscale": {"multiscale": False},
    "LATIN-PGD, 10 modes": {"linear_stage": "pgd", "pgd_modes": 10},
    "paper's method": PAPER,
    "paper's, monoscale": {**PAPER, "multiscale": False},
}
KNOWN = "LATIN, until known"
INCREMENTAL = "incremental"
SPARSE = "sparse incremental"
NOTES = (
    f"Until the contact force is within {GOAL:.0%} of the incremental solvers'; - is "
    f"not after {MOST} iterations. Medians of {REPEATS} (of one from {LONG:.0f} s on), "
    "s: of the processor, and by the clock on the wall, by which two threads are to "
    "be judged; MB that the process grows by, the problem apart. Ratio: to the faster "
    "incremental solver.",
    "Until known: until the run says itself that it is within 1 %, by an estimate or "
    "certified.",
    "Sparse incremental: tests/benchmarks/sparse_newton.py; its answer differs from "
    f"the other's by less than {SAME:g}, or there is no row.",
)


def settings_of(courses: int, changes: dict[str, Any]) -> Settings:
    """Settings of a wall of as many bricks a course."""
    size = {"bricks": courses, "courses": courses}
    return CATALOGUE["wall"].checked(WALL | size | changes)


def counts_of(courses: int) -> tuple[int, dict[str, int]]:
    """Bricks, and iterations of each way; 0 where it does not come there."""
    settings = settings_of(courses, {})
    problem = discretise(settings)
    truth = SparseNewton(problem).march()
    assert truth.solved.all()
    if courses < ALONE:
        other = reference_of(problem)
        pairs: list[tuple[Array, Array]] = [
            (truth.displacement, other.displacement),
            (truth.contact_force, other.contact_force),
        ]
        for mine, theirs in pairs:
            assert np.abs(mine - theirs).max() < SAME * np.abs(theirs).max()
    distance = distance_to(truth, problem)
    counts = {KNOWN: 0}
    for way, changes in LATIN.items():
        if courses >= ALONE and way not in ("LATIN", "LATIN, two threads"):
            continue
        method = method_of(settings_of(courses, changes))
        counts[way] = 0
        for iterate in islice(iterations(replace(problem), method), MOST):
            if distance.of_friction_force(iterate) <= GOAL:
                counts[way] = iterate.number
                break
    for iterate, decision in islice(
        judged(replace(problem), method_of(settings)), MOST
    ):
        if decision.status and decision.status.ending is Ending.CONVERGED:
            counts[KNOWN] = iterate.number
            assert distance.of_friction_force(iterate) <= GOAL
            break
    return settings.n_substructures, counts


def measured(courses: int, way: str, count: int) -> tuple[float, float, float]:
    """Seconds of the processor and of the clock on the wall, and MB."""
    settle()
    settings = settings_of(courses, LATIN.get(way, {}))
    problem = discretise(settings)
    before = resident("VmRSS")
    samples = list[tuple[float, float]]()
    while len(samples) < REPEATS and sum(own for own, _ in samples) < LONG:
        fresh = replace(problem)
        clocks = [time.perf_counter()]
        seconds = seconds_of(lambda: run(fresh, settings, way, count))  # noqa: B023
        samples.append((seconds, time.perf_counter() - clocks[0]))
        if len(samples) == 1:
            memory = resident("VmHWM") - before
    own, wall = map(statistics.median, zip(*samples, strict=True))
    return own, wall, memory / 1e6


def run(problem: Problem, settings: Settings, way: str, count: int) -> None:
    """Solve one way."""
    if way == INCREMENTAL:
        reference_of(problem)
    elif way == SPARSE:
        SparseNewton(problem).march()
    else:
        steps: Iterator[object] = iterations(problem, method_of(settings))
        if way == KNOWN:
            steps = judged(problem, method_of(settings))
        for _ in islice(steps, count):
            pass


def lines_of(pool: ProcessPoolExecutor, courses: int) -> Iterator[str]:
    """Rows of one wall."""
    bricks, counts = pool.submit(counts_of, courses).result()
    ways = {way: counts.get(way, 0) for way in (SPARSE, INCREMENTAL, *counts)}
    if courses >= ALONE:
        del ways[INCREMENTAL]
    rows = {}
    for way, count in ways.items():
        if count or way in (SPARSE, INCREMENTAL):
            rows[way] = pool.submit(measured, courses, way, count).result()
    best = min(rows[way][0] for way in (SPARSE, INCREMENTAL) if way in rows)
    yield f"{bricks} bricks; first: {min(rows, key=lambda way: rows[way][0])}"
    for way, count in ways.items():
        own, wall, memory = rows.get(way, (math.nan,) * 3)
        if way in rows:
            cells = f"{own:8.2g} {wall:8.2g} {memory:8.0f} {own / best:8.2g}"
        else:
            cells = "-"
        yield f"  {way:<20} {count or '':>5} {cells}"


def main() -> None:
    """Print the rows of each wall as soon as they are there."""
    parser = argparse.ArgumentParser(description="Walls of more and more bricks.")
    parser.add_argument("courses", nargs="*", type=int, default=COURSES)
    chosen = parser.parse_args()
    os.environ.update(ONE_THREAD)
    print(machine())
    print(f"  {'':<20} {'iter.':>5} {'s':>8} {'s, wall':>8} {'MB':>8} {'ratio':>8}")
    options: dict[str, Any] = {
        "max_tasks_per_child": 1,
        "mp_context": get_context("spawn"),
    }
    with ProcessPoolExecutor(1, **options) as pool:
        for courses in chosen.courses:
            print(*lines_of(pool, courses), sep="\n", flush=True)
    print(*NOTES, sep="\n")


if __name__ == "__main__":
    main()
