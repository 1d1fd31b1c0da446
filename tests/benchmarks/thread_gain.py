"""Gain by threads: iterations of a block by one thread and by several, in turn."""

from __future__ import annotations

import statistics
import sys
from itertools import pairwise

from solver.latin import Iterate, iterations
from solver.scenes import discretise
from solver.scenes.block import BlockSettings
from solver.scenes.method import method_of

SIZES = (96, 192, 384, 768)
WARM = 10
"""Iterations before the first that is timed: until then the memory of the acceleration
fills."""
INSTANTS = 51


def thread_gain(elements: int, threads: int, repeats: int) -> tuple[float, float]:
    """Measure median seconds of an iteration by one thread and by several, in turns.

    Parameters
    ----------
    elements
        Along the block, half as many up; substructures of 24 x 24 elements.
    threads
        How many against one.
    repeats
        Iterations that are timed.
    """
    parts = elements // 24
    chosen = BlockSettings.checked(
        {
            "elements": elements,
            "elements_up": elements // 2,
            "substructures": parts,
            "substructures_up": parts // 2,
            "instants": INSTANTS,
        }
    )
    problem = discretise(chosen)
    runs = [
        iterations(problem, method_of(chosen.replace(threads=number)))
        for number in (1, threads)
    ]
    seconds: list[list[float]] = [[], []]
    for _ in range(WARM + repeats):
        for run, own in zip(runs, seconds, strict=True):
            iterate: Iterate = next(run)
            own.append(iterate.seconds)
    one, several = (
        statistics.median(later - sooner for sooner, later in pairwise(own[WARM - 1 :]))
        for own in seconds
    )
    return one, several


def print_thread_gain(threads: int, repeats: int) -> None:
    """Print the table of all sizes."""
    print(f"one iteration of a block, {INSTANTS} instants, ms: medians of {repeats}")
    print(f"{'elements':>10} {'1 thread':>10} {f'{threads} threads':>10} {'ratio':>6}")
    for elements in SIZES:
        one, several = thread_gain(elements, threads, repeats)
        size = f"{elements} x {elements // 2}"
        print(
            f"{size:>10} {1e3 * one:10.2f} {1e3 * several:10.2f} {one / several:6.2f}"
        )


if __name__ == "__main__":
    print_thread_gain(int(sys.argv[1]) if len(sys.argv) > 1 else 2, 7)
