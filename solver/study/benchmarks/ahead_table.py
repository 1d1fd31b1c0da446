"""The table of problems on which LATIN is set beside the incremental solver."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, fields
from pathlib import Path

from solver.disk import whole_file
from solver.running.machine import machine
from solver.study.benchmarks.ahead import GOAL, MOST, NEAR, Ahead, ahead_of
from solver.study.benchmarks.ahead_problems import AheadProblem

WIDTHS = (30, 8, 8, 6, 11, 9, 15, 20)
HEAD = (
    *("problem", "LATIN, s", "incr., s", "ratio", "iterations", "found at"),
    *("own way to 1 %", "and known there"),
)
NOTES = (
    "LATIN: `solve` with the scene's defaults. incr.: the incremental solver on the same mesh. "
    "Both from settings to result, in seconds of the processor, in turns; ratio: LATIN over incr.",
    "found at: error of the iterate from which a status step found the solution; with * above "
    f"{100 * NEAR:.0f} %, so the incremental solver answered, from LATIN's statuses.",
    f"own way: iterations and seconds until the contact force is within {100 * GOAL:.0f} %, "
    f"without a status step at the end and without what judges iterates; - is more than {MOST}.",
    "known: when such a run says itself that it has converged, all billed, and whether a status "
    "step certifies that or it is an estimate.",
)


def print_ahead(problems: Iterable[AheadProblem], repeats: int) -> list[tuple[str, Ahead]]:
    """Measure problems and print a row of each as soon as it is there; give what was found."""
    print(machine())
    print(f"medians of {repeats}; every problem in a process of its own, with one BLAS thread")
    print(_aligned(HEAD))
    found = []
    for problem in problems:
        row = ahead_of(problem, repeats)
        found.append((problem.label, row))
        print(_aligned(_cells(problem.label, row)), flush=True)
    print(*NOTES, sep="\n")
    return found


def write_ahead(found: Sequence[tuple[str, Ahead]], file: Path) -> None:
    """Write what was found as CSV: seconds, and errors as fractions; empty where there is none.

    Raises
    ------
    OSError
        When the file cannot be written.
    """
    with whole_file(file) as open_file:
        writer = csv.writer(open_file)
        writer.writerow(["problem", *(field.name for field in fields(Ahead))])
        for label, row in found:
            values = asdict(row).values()
            plain = ("" if isinstance(one, float) and math.isnan(one) else one for one in values)
            writer.writerow([label, *plain])


def _cells(label: str, row: Ahead) -> list[str]:
    found_at = "-" if math.isnan(row.found_at) else f"{100.0 * row.found_at:.2g} %"
    return [
        label,
        _seconds(row.latin),
        _seconds(row.incremental),
        _seconds(row.ratio),
        str(row.iterations),
        found_at if row.is_latins else f"{found_at} *",
        _reached(row.own_iterations, row.own),
        f"{_reached(row.known_iterations, row.known)} {row.known_by}".strip(),
    ]


def _reached(iterations: float, seconds: float) -> str:
    return "-" if math.isnan(iterations) else f"{iterations:.0f} in {_seconds(seconds)}"


def _seconds(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.2g}"


def _aligned(cells: Sequence[str]) -> str:
    return "  ".join(cell.ljust(width) for cell, width in zip(cells, WIDTHS, strict=True)).rstrip()
