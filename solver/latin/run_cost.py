"""What a whole run takes, estimated before it begins.

`python tests/benchmarks/whole_cost.py` sets estimates of runs beside what is measured.
"""

from __future__ import annotations

from dataclasses import dataclass

from solver.discrete.problem import Problem
from solver.latin.anderson import MEMORY, MOST_VALUES
from solver.latin.cost import SYSTEMS, WAIT, costs_of
from solver.latin.method import Latin
from solver.latin.pgd import PGD
from solver.reference.contact import MOST_JUMPS, jumps_in
from solver.reference.incremental import rubs_on_supports

ITERATIONS, MORE = 30, 2.5
"""That a run takes; and more with every contact between bodies that are cut, but the first."""
PLAIN = 5.0
"""Times as many without acceleration (measured on the bar)."""
WATCHED = 2.0
"""Time of an iteration with its indicators, estimate and errors, over that of its stages."""
BEGINNING = 0.05
"""Seconds for what comes before the first iteration, that no size makes less (measured)."""
FIELDS = 25
"""Boundary fields that a run holds at a time, besides those that the acceleration remembers."""
NUMBER = 8
"""Bytes."""
LONG, LARGE = 20.0, 1e9
"""Seconds and bytes from which a run says before it begins what it will take."""
VERY_LONG, VERY_LARGE = 60.0, 2e9
"""Those from which a page asks before."""


@dataclass(frozen=True)
class RunCost:
    """Estimated, by a factor of three.

    Attributes
    ----------
    seconds, memory
        Of the whole, s and B.
    reference
        Seconds of these for the reference; 0 without one.
    """

    seconds: float
    memory: float
    reference: float

    @property
    def is_large(self) -> bool:
        """Whether one would like to know before."""
        return self.seconds > LONG or self.memory > LARGE

    @property
    def is_to_be_agreed(self) -> bool:
        """Whether one would like to be asked before."""
        return self.seconds > VERY_LONG or self.memory > VERY_LARGE

    def __str__(self) -> str:
        return f"{_duration(self.seconds)} and {self.memory / 1e9:.1g} GB"


def run_cost(problem: Problem, latin: Latin, most: int, *, with_reference: bool) -> RunCost:
    """Estimate what a run of at most so many iterations takes from a problem to its end.

    `with_reference` says whether the incremental reference is solved before, where there is one.
    """
    costs, n_jumps = costs_of(problem), jumps_in(problem)
    has_solver = rubs_on_supports(problem) or n_jumps <= MOST_JUMPS
    incremental = costs.condensing + SYSTEMS * costs.n_instants * costs.system
    # Without cuts the coarse problem carries loads through all bodies, however many there are.
    coupled = len(problem.rubbing) - 1 if problem.cuts and not rubs_on_supports(problem) else 0
    expected = (ITERATIONS + MORE * coupled) * (1.0 if latin.acceleration else PLAIN)
    iterations = min(expected, most)
    is_worth_it = latin.finish is not None and costs.afford(iterations, WAIT)
    steps = has_solver and (isinstance(latin.linear, PGD) or is_worth_it)
    seconds = BEGINNING + WATCHED * iterations * costs.iteration + steps * incremental
    reference = incremental if with_reference and has_solver else 0.0
    field = problem.n_rows * problem.n_instants
    remembered = min(MEMORY, max(1, MOST_VALUES // field - 1)) + 1
    # A condensation holds a matrix between all jumps, and one of all degrees of freedom and jumps.
    dense = 0.0 if rubs_on_supports(problem) else n_jumps * (float(n_jumps) + problem.n_dofs)
    memory = max((FIELDS + remembered) * field + steps * dense, dense if reference else 0.0)
    return RunCost(seconds + reference, NUMBER * memory, reference)


def _duration(seconds: float) -> str:
    """Write seconds with one digit, as the estimate has no more."""
    for size, unit in ((3600.0, "h"), (60.0, "min")):
        if seconds >= 1.5 * size:
            return f"{float(f'{seconds / size:.1g}'):g} {unit}"
    return f"{float(f'{seconds:.1g}'):g} s"
