"""Public QP solvers set beside a study (the extra `peers`).

`python tests/benchmarks/peers.py bar --set elements=100`

How they are given the problem: `tests/benchmarks/public_solvers.py`.
"""

from __future__ import annotations

import argparse
import sys

from public_solvers import PUBLIC, peers

from solver.files import settings_from_command
from solver.prepared import print_tables
from solver.reference.supports import rubs_on_supports
from solver.scenes import discretise
from solver.study.page import aligned
from solver.study.speed.error_against_time import error_against_time
from solver.study.speed.study_report import conditions, table, winners


def main() -> int:
    """Print a study with them."""
    asked = argparse.ArgumentParser(description="A study with public QP solvers.")
    asked.add_argument("scene", help="one of a known bound on a rigid support")
    asked.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="changes")
    asked.add_argument("--repeats", type=int, default=5, help="passes whose median is taken")
    chosen = asked.parse_args()
    settings, tables = settings_from_command(chosen.scene, chosen.changes)
    print_tables(tables)
    if not rubs_on_supports(discretise(settings)):
        print("Unilateral contact with friction is no quadratic programme.", file=sys.stderr)
        return 2
    found = error_against_time(settings, chosen.repeats, peers=peers())
    absent = [one.name for one in PUBLIC if not one.installed]
    print("\n".join(conditions(found)))
    for one in peers():
        print(f"{one.name} at tolerances {', '.join(f'{step:g}' for step in one.tolerances)}.")
    print(f"Not installed: {', '.join(absent) or 'none'}.", end="\n\n")
    print(aligned(table(found)), end="\n\n")
    print(aligned(winners(found)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
