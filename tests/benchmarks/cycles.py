"""Cost of many cycles of a load: LATIN and LATIN-PGD, at once and in slabs.

`python tests/benchmarks/cycles.py`, of one problem `cycles.py strand`; `--large` up to
100 cycles. Iterations to 1 % of the contact force are counted without the clock, then
each way runs for so many, from the discrete problem on, in turns.
"""

from __future__ import annotations

import argparse
import math
import os
import statistics
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from itertools import islice
from multiprocessing import get_context
from typing import Any

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin import Iterate, iterations
from solver.latin.iteration import Iteration
from solver.latin.slabs import Slab, first_slab, next_slab
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.reference.solution import Reference
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.scene import Settings
from solver.study.measured_times import seconds_of
from solver.study.sweep.executors import ONE_THREAD, machine

GOAL = 0.01
FIRST = 0.5
"""Error of the contact force, and the share of it in the first slab: that goes on into
the next."""
MOST = 300
LONGEST = 60.0
"""Iterations of a slab, and seconds of the processor, after which a way is given up."""
REPEATS = 3
SHORT = 2.0
"""Times that each is measured, and seconds of all from which on once is enough."""
MODES = 40, 10
"""Of LATIN-PGD, and a brick of a wall: with 20 the block of 192 x 96 elements stalls at
4 to 6 %; with 6 a wall under ten cycles at 1.2 % (measured)."""
INSTANTS = 40
"""Of a cycle."""
FEW = (1, 2, 5, 10)
MANY = (1, 2, 5, 10, 20, 50, 100)
PGD = {"linear_stage": "pgd"}
WAYS: dict[str, tuple[dict[str, Any], bool]] = {
    "LATIN": ({}, False),
    "LATIN-PGD": (PGD, False),
    "LATIN in slabs": ({}, True),
    "LATIN-PGD in slabs": (PGD, True),
}
"""Settings of the method, and whether it goes slab after slab of a cycle."""
BLOCK = {"elements": 96, "elements_up": 48, "substructures": 2, "substructures_up": 1}
WALL = {"bricks": 8, "courses": 8, "elements": 6, "elements_up": 3}
PROBLEMS: dict[str, tuple[str, dict[str, Any], int]] = {
    "block": ("block", BLOCK, MANY[-1]),
    "finer": ("block", {**BLOCK, "elements": 192, "elements_up": 96}, 20),
    "strand": ("strand", {"wires": 20, "elements": 100}, MANY[-1]),
    "wall": ("wall", WALL, 50),
}
"""Scene, settings but for the load, and most cycles that the limits on settings
allow."""
NOTES = (
    f"Cycles of {INSTANTS} instants. Iterations and seconds of the processor until the "
    f"contact force is within {GOAL:.0%} of the incremental solver's over all "
    "instants; share of the local stage in them, most modes of a substructure, and MB "
    "that the state holds (of a slab, if in slabs). S: time of the incremental solver "
    "over it, and of LATIN at once over it.",
    f"- is not there after {MOST} iterations or {LONGEST:.0f} s, and not tried with "
    "more cycles.",
)


@dataclass(frozen=True)
class AtInstants:
    """A reference at some instants."""

    displacement: Array
    contact_force: Array


def settings_of(name: str, cycles: int) -> Settings:
    """Settings of a problem with a number of cycles of a second each."""
    scene, changes, _ = PROBLEMS[name]
    path = [[0.0, 0.0]]
    for cycle in range(cycles):
        if scene == "block":
            path += [[cycle + 0.25, 2e-5], [cycle + 0.75, -2e-5], [cycle + 1.0, 0.0]]
        elif scene == "wall":
            path += [[cycle + 0.25, 5e-5], [cycle + 0.75, -5e-5], [cycle + 1.0, 0.0]]
        else:
            path += [[cycle + 0.5, 600.0], [cycle + 1.0, 0.0]]
    load: dict[str, Any] = {"load": path}
    if scene == "block":
        pressed = [[0.0, 0.0], [0.25, -4e-5], [1.0, -4e-5]]
        load = {"top_normal_load": pressed, "top_tangential_load": path}
    if scene == "wall":
        pressed = [[0.0, 0.0], [0.1, 1e6]]
        load = {
            "pressure_load": pressed,
            "top_load": [[0.0, 0.0], [0.1, 0.0], *path[1:]],
        }
    modes = {"pgd_modes": MODES[scene == "wall"], **changes}
    times = {"instants": INSTANTS * cycles + 1, "duration": float(cycles)}
    return CATALOGUE[scene].checked(modes | times | load)


def measure(name: str, cycles: int, ways: Sequence[str]) -> tuple[list[str], list[str]]:
    """Lines of a number of cycles, and the ways that came there."""
    settings = settings_of(name, cycles)
    problem = discretise(settings)
    reference = reference_of(problem)
    counts = {}
    for way in ways:
        course = _course(problem, settings, way, reference)
        if course:
            counts[way] = course
    seconds: dict[str, list[float]] = {"": [], **{way: [] for way in counts}}
    words = {}
    while len(seconds[""]) < REPEATS and sum(map(sum, seconds.values())) <= SHORT:
        # Each way has a problem of which nothing is known but its matrices and laws.
        seconds[""].append(seconds_of(lambda: reference_of(replace(problem))))
        for way, course in counts.items():
            took, words[way] = _run(replace(problem), settings, way, course)
            seconds[way].append(took)
    medians = {way: statistics.median(own) for way, own in seconds.items()}
    lines = [f"{cycles:>6}  {'incremental solver':<18}  {medians['']:.2g} s"]
    for way in counts:
        others = (medians[""], medians.get("LATIN", math.nan))
        ups = ", ".join(f"{other / medians[way]:.2g}" for other in others)
        lines.append(
            f"{cycles:>6}  {way:<18}  {medians[way]:.2g} s, {words[way]}; S {ups}"
        )
    lines += [f"{cycles:>6}  {way:<18}  -" for way in ways if way not in counts]
    return lines, list(counts)


def _first(problem: Problem, settings: Settings, way: str) -> tuple[Slab, int]:
    changes, in_slabs = WAYS[way]
    if in_slabs:
        length = INSTANTS
    else:
        length = problem.n_instants
    method = method_of(settings.replace(**changes, finish="none"))
    return first_slab(problem, method, length), length


def _course(
    problem: Problem, settings: Settings, way: str, reference: Reference
) -> list[int] | None:
    """Iterations to the goal, slab by slab; None where they do not come there."""
    began = time.process_time()
    slab: Slab | None
    slab, length = _first(problem, settings, way)
    if WAYS[way][1]:
        goal = FIRST * GOAL
    else:
        goal = GOAL
    counts = []
    while slab is not None:
        fields = (reference.displacement, reference.contact_force)
        inside = [field[:, slab.instants] for field in fields]
        part = AtInstants(*inside)
        distance = distance_to(part, slab.problem)
        way_there = iterations(slab.problem, slab.latin, slab.start)
        for iterate in islice(way_there, MOST):
            if distance.of_friction_force(iterate) <= goal:
                break
            if time.process_time() - began > LONGEST:
                return None
        else:
            return None
        counts.append(iterate.number)
        goal = GOAL
        slab = next_slab(problem, slab, iterate, length)
    return counts


def _run(
    problem: Problem, settings: Settings, way: str, counts: Sequence[int]
) -> tuple[float, str]:
    """Seconds of a number of iterations of every slab, and their parts."""
    local = 0.0
    iterate = None

    def work() -> None:
        nonlocal local, iterate
        slab: Slab | None
        slab, length = _first(problem, settings, way)
        for count in counts:
            assert slab is not None
            iteration = Iteration(slab.problem, slab.latin, slab.start)
            for number in range(1, count + 1):
                began = time.process_time()
                iteration.local_stage()
                local += time.process_time() - began
                iteration.linear_stage()
                iteration.choose_direction()
                iterate = iteration.snapshot(number)
                if iteration.has_new_k:
                    iteration = Iteration(slab.problem, slab.latin, iterate.checkpoint)
            assert iterate is not None
            slab = next_slab(problem, slab, iterate, length)

    seconds = seconds_of(work)
    assert iterate is not None
    modes, megabytes = _state(iterate)
    share = f"local {local / seconds:.0%}"
    return (
        seconds,
        f"{sum(counts)} iterations, {share}, {modes} modes, {megabytes:.2g} MB",
    )


def _state(iterate: Iterate) -> tuple[int, float]:
    """Most modes of a substructure, 0 of full fields; and MB of the state."""
    if not iterate.bases:
        return 0, iterate.outgoing.nbytes / 1e6
    held = sum(
        2 * own.incoming.nbytes + own.basis.time_functions.nbytes
        for own in set(iterate.bases)
    )
    return max(own.n_modes for own in iterate.bases), held / 1e6


def main() -> None:
    """Print each number of cycles as soon as it is there."""
    parser = argparse.ArgumentParser(description="What many cycles cost.")
    parser.add_argument("problem", nargs="?", choices=PROBLEMS, help="this alone")
    parser.add_argument(
        "--large", action="store_true", help="up to 100 cycles, some minutes"
    )
    chosen = parser.parse_args()
    os.environ.update(ONE_THREAD)
    print(machine())
    for name in [chosen.problem] if chosen.problem else PROBLEMS:
        scene, changes, most = PROBLEMS[name]
        assignments = [f"{key}={value}" for key, value in changes.items()]
        print("", scene, *assignments)
        ways = list(WAYS)
        for cycles in MANY if chosen.large else FEW:
            if cycles <= most:
                with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
                    lines, ways = pool.submit(measure, name, cycles, ways).result()
                print(*lines, sep="\n", flush=True)
    print("", *NOTES, sep="\n")


if __name__ == "__main__":
    main()
