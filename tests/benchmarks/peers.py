"""Public QP solvers beside a study (the extra `peers`).

`python tests/benchmarks/peers.py bar --set elements=100`

How they are given the problem: `tests/benchmarks/public_solvers.py`.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Iterator

from public_solvers import PUBLIC, PeerError, solve_by

from solver.commands.console import print_tables
from solver.files.saved import settings_from_command
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of, rubs_on_supports
from solver.scenes import discretise
from solver.settings.scene import Settings
from solver.study.measured_times import error_against_time, seconds_of
from solver.study.page import aligned
from solver.study.study_report import conditions, table


def rows(settings: Settings, repeats: int) -> Iterator[list[str]]:
    """Time and errors of every solver that is installed, at each of its tolerances."""
    problem = discretise(settings)
    distance = distance_to(reference_of(problem), problem)
    for public in PUBLIC:
        for tolerance in public.tolerances if public.installed else ():
            name = f"{public.name} {public.version}"

            def solve(public=public, tolerance=tolerance):
                return solve_by(public, discretise(settings), tolerance)

            try:
                fields = solve()
                times = [seconds_of(solve, time.perf_counter) for _ in range(repeats)]
            except PeerError as trouble:
                yield [name, f"{tolerance:g}", str(trouble), "", ""]
                continue
            seconds = statistics.median(times)
            yield [
                name,
                f"{tolerance:g}",
                f"{1e3 * seconds:.3g}",
                f"{distance.of_friction_force(fields):.1e}",
                f"{distance.of_displacement(fields):.1e}",
            ]


def main() -> int:
    """Print a study, and below it their times and errors."""
    asked = argparse.ArgumentParser(description="A study with public QP solvers.")
    asked.add_argument("scene", help="one of a known bound on a rigid support")
    asked.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", dest="changes"
    )
    asked.add_argument(
        "--repeats", type=int, default=5, help="passes whose median is taken"
    )
    chosen = asked.parse_args()
    settings, tables = settings_from_command(chosen.scene, chosen.changes)
    print_tables(tables)
    if not rubs_on_supports(discretise(settings)):
        print(
            "Unilateral contact with friction is no quadratic programme.",
            file=sys.stderr,
        )
        return 2
    curves = error_against_time(settings, chosen.repeats)
    print(
        *conditions(settings, chosen.repeats), "", aligned(table(curves)), "", sep="\n"
    )
    head = [
        "solver",
        "tolerance",
        "ms",
        "error of the friction force",
        "of the displacement",
    ]
    print(aligned([head, *rows(settings, chosen.repeats)]))
    absent = [one.name for one in PUBLIC if not one.installed]
    print(f"Not installed: {', '.join(absent) or 'none'}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
