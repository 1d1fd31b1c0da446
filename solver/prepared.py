"""What commands that run a scene without a reference say of it before they begin."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence

from solver.discrete.problem import Problem
from solver.files import remarks
from solver.latin.run_cost import run_cost
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.settings import Settings


def print_tables(tables: Mapping[str, str]) -> None:
    """Print to stderr what was understood of tables, by what they were given for."""
    for name, message in tables.items():
        print(f"slipfront: {name}: {message}", file=sys.stderr)


def prepared(settings: Settings, changes: Sequence[str], tables: Mapping[str, str]) -> Problem:
    """Make the problem; say which settings do nothing, and what a long or large run will take.

    Parameters
    ----------
    settings, changes
        Those of the run, and `NAME=VALUE` texts of what was set.
    tables
        What was understood of tables, by what they were given for.
    """
    problem, most = discretise(settings), settings.max_iterations
    cost = run_cost(problem, method_of(settings), most, with_reference=False)
    print_tables(tables)
    said = remarks(settings, changes)
    if cost.is_large:
        said.append(f"this will take about {cost}")
    for line in said:
        print(f"slipfront: {line}", file=sys.stderr, flush=True)
    return problem
