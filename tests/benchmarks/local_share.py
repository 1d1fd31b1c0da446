"""Which share of an iteration the local stage has, and what fitting clips in its place would take.

A local stage that worked on a reduced field could save its own share at most: all of an iteration
over what is left of it (Amdahl). It would have to find its clips first. Times are those of the
processor, the least of some, so that whoever else works on the machine hardly shows.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from solver.arrays import space_time
from solver.files import scene_settings
from solver.latin import Iterate, iterations
from solver.latin.linear_stage import LinearStage
from solver.latin.local_stage import LocalStage
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.study.quantities.reduction_measures import can_be_clipped, clips_in

CASES: tuple[tuple[str, dict[str, Any]], ...] = (
    ("bar", {"elements": 50, "instants": 101}),
    ("bar", {"elements": 200, "instants": 101}),
    ("bar", {"elements": 1000, "instants": 101}),
    ("bar", {"elements": 1000, "instants": 1001}),
    ("block", {}),
    ("block", {"elements": 96, "elements_up": 48}),
    ("block", {"elements": 192, "elements_up": 96}),
    ("layers", {}),
)
VALUES = 2e6


def measure(settings: Settings, repeats: int) -> list[float]:
    """Give the seconds of a local stage, and of a linear stage with its coarse problem.

    On rods also those of finding clips, and of rebuilding the friction from clips that are known.
    """
    problem = discretise(settings)
    k = method_of(settings).direction.of(problem)
    local, linear = LocalStage(problem, k), LinearStage(problem, k, multiscale=True)
    state, incoming = linear.start(None), space_time(problem.n_rows, problem.n_instants)
    iterate: Iterate = next(iterations(problem, method_of(settings)))
    incoming[:] = iterate.incoming
    target = local(incoming)

    def step() -> None:
        linear.read(target)
        linear.advance(state, settings.relaxation)
        linear.incoming(state)

    parts: list[Callable[[], object]] = [lambda: local(incoming), step]
    if can_be_clipped(settings):
        clips = clips_in(settings, iterate)
        parts += [lambda: clips_in(settings, iterate), lambda: replace(clips).field]
    calls = max(1, int(VALUES / (problem.n_rows * problem.n_instants)) // 8)
    return [min(seconds_of(part, calls) for _ in range(repeats)) for part in parts]


def seconds_of(part: Callable[[], object], calls: int) -> float:
    """Give the seconds of the processor that a call takes."""
    began = time.process_time()
    for _ in range(calls):
        part()
    return (time.process_time() - began) / calls


if __name__ == "__main__":
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 7
    for scene, changes in CASES:
        local, linear, *clips = measure(scene_settings(scene).checked(changes), repeats)
        share = local / (local + linear)
        told = f"local {1e3 * local:.2f} ms of {1e3 * (local + linear):.2f} ({share:.0%})"
        print(f"{scene} {changes}: {told}, at most {1.0 / (1.0 - share):.2f} times faster", end="")
        ways = zip(("to find", "to rebuild"), clips, strict=False)
        print(*(f"; {way} clips {spent / local:.1f} local stages" for way, spent in ways), sep="")
