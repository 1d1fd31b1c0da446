"""What a status step costs, beside the iterations that it saves, and what a whole run takes.

All of it is estimated from counts, never measured by a clock, so that a run ends alike
on every machine; `python tests/benchmarks/whole_cost.py` sets estimates of runs beside
what is measured.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from solver.discrete.problem import Problem
from solver.latin.anderson import MEMORY, MOST_VALUES
from solver.latin.direction.directions import sliding_share
from solver.latin.stages.pgd import PGD
from solver.reference.contact import MOST_JUMPS, jumps_in
from solver.reference.incremental import rubs_on_supports
from solver.reference.rules import HELD, States

if TYPE_CHECKING:
    from solver.latin.method import Latin

WAIT = 2.0
"""Seconds that a step may take before a run is called converged, whatever the
iterations took."""
SYSTEMS = 3
"""Linear systems for every instant that a step may solve in any case."""
ENDS_FOR_SURE = 40
"""The same where a step ends for sure: rods on supports of their own, and softening (2
to 35)."""
AT_REST = 0.02
SAVED = 10
"""Share of the jumps that move up to which nothing slips; iterations that a step then
saves."""
TRIED = 2.0
"""Times the iterations so far that a step may cost, whatever the force does."""
WORTH = 0.5
"""Share of the time of the iterations so far that a proof is worth."""
AFFORDABLE = 40
"""Iterations that a status step may cost in any case: about as many as it saves."""
DENSE = 1e10
FACTOR = 2e10
SPARSE = 6e9
"""Operations a second of dense products, of dense factors, and of sparse ones
(measured)."""
SQUARE = 5e-8
"""Seconds a number of the condensed stiffness takes, all in all (measured)."""
GATHER = 8e-9
READ = 1.5e-9
"""Seconds a number takes that a system gathers from it, and that it only reads
(measured)."""
MOVING = 1.0 / 3.0
"""Share of the jumps that move at an instant where contacts open or bodies bend
(measured)."""
NEXT = 2.0
"""Interfaces that slide where a load passes from body to body: those beside what
carries none."""
PASSES = 30
PASS = 1e-9
"""How often an iteration passes over a boundary field, and seconds a number
(measured)."""
CALLS = 2e-4
OF_ITERATION = 5e-4
"""Seconds of a dense system, and of an iteration, that no size makes less
(measured)."""
BAND = 6e-8
BAND_CALLS = 3e-5
"""Seconds a number of a system with a band matrix, and those that no size makes less
(measured)."""
ITERATIONS = 30
MORE = 2.5
"""That a run takes; and more with every contact between bodies that are cut, but the
first."""
PLAIN = 5.0
"""Times as many without acceleration (measured on the bar)."""
WATCHED = 2.0
"""Time of an iteration with its indicators, estimate and errors, over that of its
stages."""
BEGINNING = 0.05
"""Seconds for what comes before the first iteration, that no size makes less
(measured)."""
FIELDS = 25
"""Boundary fields that a run holds at a time, besides those that the acceleration
remembers."""
NUMBER = 8
"""Bytes."""
LONG = 20.0
LARGE = 1e9
"""Seconds and bytes from which a run says before it begins what it will take."""


@dataclass(frozen=True)
class Costs:
    """Estimated times of condensing once, of a linear system of the step, of an iteration, s.

    Where nothing slips, so that it `is_at_rest`, one system an instant is enough; so
    many for every instant it may solve `in_any_case`.
    """

    condensing: float
    system: float
    iteration: float
    n_instants: int
    is_at_rest: bool = False
    in_any_case: int = SYSTEMS

    @property
    def step(self) -> float:
        """Of a status step whose statuses are right."""
        return self.condensing + self.n_instants * self.system

    def afford(self, iterations: float, least: float = 0.0) -> bool:
        """Whether a step costs no more than half of the iterations so far, or that it saves.

        `least` is what it may cost in any case, s.
        """
        return self.step <= max(
            max(WORTH * iterations, AFFORDABLE) * self.iteration, least
        )

    @cached_property
    def small_from(self) -> float:
        """The iteration from which a step, also one with some wrong statuses, is worth a trial."""
        step = self.condensing + SYSTEMS * self.n_instants * self.system
        number = step / (TRIED * self.iteration)
        if self.is_at_rest:
            return min(number, self.step / self.iteration - SAVED)
        return number

    def systems(self, iterations: float) -> int:
        """The number of linear systems that a step may solve after so many iterations.

        As many as take the time of these. It is tried again at twice as many
        iterations, so that all trials together take twice as long as the iterations.
        """
        affordable = int(iterations * self.iteration / self.system)
        return max(self.in_any_case * self.n_instants, affordable)


def costs_of(problem: Problem, states: States | None = None) -> Costs:
    """Estimate the times of a problem, by the states of jumps, (n_forces, n_instants), if known."""
    n_jumps = jumps_in(problem)
    entries = 0.0
    products = sum(2.0 * len(part.rows) ** 2 for part in problem.substructures)
    products = min(products, 200.0 * problem.n_rows)
    passes = products / DENSE + PASSES * PASS * problem.n_rows
    iteration = OF_ITERATION + problem.n_instants * passes
    softens = any(law.tangential.softens for law in problem.rubbing.values())
    if softens:
        room = ENDS_FOR_SURE
    else:
        room = SYSTEMS
    if rubs_on_supports(problem):
        system = BAND_CALLS + BAND * n_jumps
        if len(problem.rubbing) > 1:
            room = ENDS_FOR_SURE
        else:
            room = room
        return Costs(0.0, system, iteration, problem.n_instants, in_any_case=room)
    for part in problem.substructures:
        stiffness = part.elasticity.stiffness
        entries += (
            stiffness.size if isinstance(stiffness, np.ndarray) else stiffness.nnz
        )
    condensing = 4.0 * entries * n_jumps / SPARSE + SQUARE * n_jumps**2
    if states is None:
        moving = _expected_share(problem)
    else:
        moving = float(np.mean(states != HELD))
    n_moving = moving * n_jumps
    system = CALLS + 2.0 / 3.0 * n_moving**3 / FACTOR
    system += (GATHER * n_moving + READ * n_jumps) * n_moving
    is_at_rest = states is not None and moving <= AT_REST
    return Costs(condensing, system, iteration, problem.n_instants, is_at_rest, room)


def _expected_share(problem: Problem) -> float:
    """The share of jumps that may move at an instant before any iterate tells it."""
    if problem.opens:
        return MOVING
    if not problem.rubbing:
        return 0.0
    return min(MOVING, NEXT * sliding_share(problem) / len(problem.rubbing))


@dataclass(frozen=True)
class RunCost:
    """Seconds and bytes of a run, right by a factor of three; seconds of these for a reference."""

    seconds: float
    memory: float
    reference: float

    @property
    def is_large(self) -> bool:
        """Whether one would like to know before."""
        return self.seconds > LONG or self.memory > LARGE

    def __str__(self) -> str:
        return f"{_duration(self.seconds)} and {self.memory / 1e9:.1g} GB"


def run_cost(
    problem: Problem, latin: Latin, most: int, *, with_reference: bool
) -> RunCost:
    """Estimate what a run of at most so many iterations takes from a problem to its end.

    `with_reference` says whether the incremental reference is solved before, where
    there is one.
    """
    costs = costs_of(problem)
    n_jumps = jumps_in(problem)
    is_small = rubs_on_supports(problem) or n_jumps <= MOST_JUMPS
    has_solver = is_small and not problem.no_reference
    incremental = costs.condensing + SYSTEMS * costs.n_instants * costs.system
    # Without cuts the coarse problem carries loads through all bodies, however many
    # there are.
    if problem.cuts and not rubs_on_supports(problem):
        coupled = len(problem.rubbing) - 1
    else:
        coupled = 0
    expected = (ITERATIONS + MORE * coupled) * (1.0 if latin.acceleration else PLAIN)
    iterations = min(expected, most)
    is_worth_it = latin.finish is not None and costs.afford(iterations, WAIT)
    steps = has_solver and (isinstance(latin.linear, PGD) or is_worth_it)
    seconds = BEGINNING + WATCHED * iterations * costs.iteration + steps * incremental
    reference = incremental if with_reference and has_solver else 0.0
    field = problem.n_rows * problem.n_instants
    remembered = min(MEMORY, max(1, MOST_VALUES // field - 1)) + 1
    # A condensation holds a matrix between all jumps, and one of all degrees of freedom
    # and jumps.
    if rubs_on_supports(problem):
        dense = 0.0
    else:
        dense = n_jumps * (float(n_jumps) + problem.n_dofs)
    memory = max(
        (FIELDS + remembered) * field + steps * dense, dense if reference else 0.0
    )
    return RunCost(seconds + reference, NUMBER * memory, reference)


def _duration(seconds: float) -> str:
    """Write seconds with one digit, as the estimate has no more."""
    for size, unit in ((3600.0, "h"), (60.0, "min")):
        if seconds >= 1.5 * size:
            return f"{float(f'{seconds / size:.1g}'):g} {unit}"
    return f"{float(f'{seconds:.1g}'):g} s"
