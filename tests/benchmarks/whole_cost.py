"""Cost of whole runs, beside the estimate of `solver.latin.run_cost`.

`python tests/benchmarks/whole_cost.py`
"""

from __future__ import annotations

import os
import re
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from solver.cache import CACHE
from solver.latin.run_cost import run_cost
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.scene import Settings
from solver.study.scene_run import finished_run, warm_up
from solver.study.sweep.executors import ONE_THREAD, machine

BY_DEFAULT: list[tuple[str, dict[str, Any]]] = [(scene, {}) for scene in CATALOGUE]
SIZES = (
    *BY_DEFAULT,
    ("bar", {"elements": 3200, "instants": 401}),
    ("strand", {"wires": 20}),
    ("block", {"elements": 192, "elements_up": 96}),
    ("layers", {"layers": 12}),
)


def print_whole_cost() -> None:
    """Print CPU seconds and memory of runs without a reference, and its seconds."""
    warm_up()
    print(machine())
    print("expected beside measured; the reference apart")
    print(f"{'run':<40} {'s':>13} {'MB':>13} {'reference, s':>13}")
    for scene, changes in SIZES:
        settings = CATALOGUE[scene].checked(changes)
        assignments = [f"{name}={value}" for name, value in changes.items()]
        label = " ".join([scene, *assignments])
        pairs = zip(expected(settings), measured(settings), strict=True)
        cells = [f"{estimate:>6.2g} {size:>6.2g}" for estimate, size in pairs]
        print(f"{label:<40}", *cells)


def expected(settings: Settings) -> tuple[float, float, float]:
    """Estimate seconds and MB of a run, and seconds of its reference."""
    problem = discretise(settings)
    method = method_of(settings)
    alone = run_cost(problem, method, with_reference=False)
    beside = run_cost(problem, method, with_reference=True)
    return alone.seconds, alone.memory / 1e6, beside.reference


def measured(settings: Settings) -> tuple[float, float, float]:
    """Measure the same."""
    CACHE.clear()
    began = time.process_time()
    finished_run(settings, errors=False)
    whole = time.process_time()
    CACHE.clear()
    reference_of(discretise(settings))
    return whole - began, memory_of(settings) / 1e6, time.process_time() - whole


def memory_of(settings: Settings) -> float:
    """By how much a process of its own grows at most in a run more, B (Linux).

    What Python counts would leave out what sparse factorisations take.
    """
    os.environ.update(ONE_THREAD)
    with ProcessPoolExecutor(1, get_context("spawn")) as process:
        return process.submit(growth, settings).result()


def growth(settings: Settings) -> float:
    """By how much this process grows at most in a run, B."""
    warm_up()
    before = resident("VmRSS")
    finished_run(settings, errors=False, indicators=False)
    return resident("VmHWM") - before


def resident(name: str) -> float:
    """A line of what the operating system says of this process, B."""
    status = Path("/proc/self/status").read_text(encoding="ascii")
    (size,) = re.findall(rf"^{name}:\s+(\d+) kB$", status, re.MULTILINE)
    return 1024.0 * int(size)


if __name__ == "__main__":
    print_whole_cost()
