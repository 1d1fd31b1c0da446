"""Estimated cost of a run before it begins.

`python tests/benchmarks/whole_cost.py` sets the estimates of runs beside measurements.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.discrete.problem import Problem
from solver.latin.anderson import MEMORY, MOST_VALUES
from solver.latin.end.cost import Costs, costs_of
from solver.latin.method import Latin
from solver.latin.stages.pgd import PGD
from solver.reference.contact import MOST_JUMPS, jumps_in
from solver.reference.incremental import rubs_on_supports

ITERATIONS = 30
"""Iterations of a run, accelerated, without contact between cut bodies."""
SHIFTED = 15.0
"""Iterations of a run, accelerated, that shifts rigid bodies: 8 to 19 to 1 % of the
contact force (measured)."""
MORE = 2.5
"""Further iterations for every contact between bodies that are cut, but the first."""
PLAIN = 5.0
"""Factor on the iterations without acceleration (measured on the bar)."""
WATCHED = 2.0
"""Time of an iteration with its indicators, estimate and errors, over that of its
stages."""
FIELDS = 25
"""Boundary fields that a run holds at a time, besides those that the acceleration
remembers."""
LONG = 20.0
"""Seconds from which a run says before it begins how long it takes."""
LARGE = 1e9
"""Bytes from which a run says before it begins how much memory it takes."""


@dataclass(frozen=True)
class RunCost:
    """Estimated cost of a run, accurate within a factor of three.

    Attributes
    ----------
    seconds
        Time of the run, s.
    memory
        Memory of the run, bytes.
    reference
        Part of the time that a reference takes, s.
    """

    seconds: float
    memory: float
    reference: float

    @property
    def is_large(self) -> bool:
        """Check whether a run is long or large enough for a warning."""
        return self.seconds > LONG or self.memory > LARGE

    def __str__(self) -> str:
        return f"{_duration(self.seconds)} and {self.memory / 1e9:.1g} GB"


def run_cost(problem: Problem, latin: Latin, *, with_reference: bool) -> RunCost:
    """Estimate the cost of a run from a problem to its end.

    Parameters
    ----------
    problem, latin
        The problem, and the method.
    with_reference
        Whether the incremental reference is solved before, if the problem has one.
    """
    costs = costs_of(problem, may_shift=latin.may_shift)
    has_solver = _has_solver(problem)
    iterations = _expected_iterations(problem, costs)
    if not latin.acceleration:
        iterations *= PLAIN
    iterations = min(iterations, latin.stop.iterations)
    is_worth_it = latin.finish is not None and costs.afford(iterations)
    # Bases need the certificate of a status step, at any cost.
    takes_step = has_solver and (isinstance(latin.linear, PGD) or is_worth_it)
    seconds = WATCHED * iterations * costs.whole_iteration
    if takes_step:
        seconds += costs.incremental
    reference = 0.0
    if with_reference and has_solver:
        reference = costs.incremental
    memory = _memory(problem, takes_step=takes_step, has_reference=reference > 0.0)
    return RunCost(seconds + reference, memory, reference)


def _has_solver(problem: Problem) -> bool:
    """Check whether an incremental solver may solve a problem, by its kind and size."""
    is_small = rubs_on_supports(problem) or jumps_in(problem) <= MOST_JUMPS
    return is_small and not problem.no_reference


def _expected_iterations(problem: Problem, costs: Costs) -> float:
    """Number of accelerated iterations that a run takes."""
    if costs.shifts > 0.0:
        return SHIFTED
    # Without cuts the coarse problem carries loads through all bodies, however many
    # there are.
    coupled = 0
    if problem.cuts and not rubs_on_supports(problem):
        coupled = len(problem.contacts) - 1
    return ITERATIONS + MORE * coupled


def _memory(problem: Problem, *, takes_step: bool, has_reference: bool) -> float:
    """Memory of a run, bytes, with a status step, or a reference before."""
    field = problem.n_rows * problem.n_instants
    remembered = min(MEMORY, max(1, MOST_VALUES // field - 1)) + 1
    # A condensation holds a matrix between all jumps, and one of all degrees of freedom
    # and jumps.
    condensation = 0.0
    if not rubs_on_supports(problem):
        n_jumps = jumps_in(problem)
        condensation = n_jumps * (float(n_jumps) + problem.n_dofs)
    # The reference is solved before the run, so its memory is free again by then.
    numbers = float((FIELDS + remembered) * field)
    if takes_step:
        numbers += condensation
    if has_reference:
        numbers = max(numbers, condensation)
    return np.dtype(float).itemsize * numbers


def _duration(seconds: float) -> str:
    """Text of a duration in seconds with one significant digit."""
    units = ((3600.0, "h"), (60.0, "min"))
    for size, unit in units:
        if seconds >= 1.5 * size:
            return f"{float(f'{seconds / size:.1g}'):g} {unit}"
    return f"{float(f'{seconds:.1g}'):g} s"
