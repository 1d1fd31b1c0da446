"""Estimated costs of a status step, of the iterations that it saves, and of a run.

All estimates come from counts and never from a clock, so that a run ends alike on every
machine. `python tests/benchmarks/whole_cost.py` sets the estimates of runs beside
measurements.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from solver.discrete.problem import Problem
from solver.latin.anderson import MEMORY, MOST_VALUES
from solver.latin.direction.directions import sliding_share
from solver.latin.stages.pgd import PGD
from solver.reference.contact import MOST_JUMPS, jumps_in
from solver.reference.incremental import rubs_on_supports
from solver.reference.rules import HELD, States

WAIT = 2.0
"""Seconds that a status step may take before a run is called converged, however long
the iterations took."""
SYSTEMS = 3
"""Linear systems per instant that a status step may solve in any case."""
ENDS_FOR_SURE = 40
"""Linear systems per instant in any case for a step that ends for sure: with rods on
supports of their own, and with friction that softens (it takes 2 to 35)."""
AT_REST = 0.02
"""Share of moving jumps up to which nothing counts as slipping."""
SAVED = 10
"""Iterations that a status step saves where nothing slips."""
TRIED = 2.0
"""Largest cost of a status step, over that of the iterations so far, at which it is
tried however much the force changes."""
WORTH = 0.5
"""Largest cost of a proof, as a share of the cost of the iterations so far."""
AFFORDABLE = 40
"""Iterations that a status step may cost in any case: about as many as it saves."""
DENSE = 1e10
"""Operations of dense products a second (measured)."""
FACTOR = 2e10
"""Operations of dense factors a second (measured)."""
SPARSE = 6e9
"""Operations with sparse matrices a second (measured)."""
SQUARE = 5e-8
"""Seconds per number of the condensed stiffness, everything included (measured)."""
GATHER = 8e-9
"""Seconds per number that a system gathers from the condensed stiffness (measured)."""
READ = 1.5e-9
"""Seconds per number of the condensed stiffness that a system only reads (measured)."""
MOVING = 1.0 / 3.0
"""Share of the jumps that move at an instant where contacts open or bodies bend
(measured)."""
NEXT = 2.0
"""Number of interfaces that slide where a load passes from body to body."""
PASSES = 30
"""Passes of an iteration over a boundary field."""
PASS = 1e-9
"""Seconds per number of a pass (measured)."""
CALLS = 2e-4
"""Seconds of a dense system, whatever its size (measured)."""
OF_ITERATION = 5e-4
"""Seconds of an iteration, whatever its size (measured)."""
BAND = 6e-8
"""Seconds per number of a system with a band matrix (measured)."""
BAND_CALLS = 3e-5
"""Seconds of a system with a band matrix, whatever its size (measured)."""
ITERATIONS = 30
"""Iterations of a run, accelerated, without contact between cut bodies."""
MORE = 2.5
"""Further iterations for every contact between bodies that are cut, but the first."""
PLAIN = 5.0
"""Factor on the iterations without acceleration (measured on the bar)."""
WATCHED = 2.0
"""Time of an iteration with its indicators, estimate and errors, over that of its
stages."""
BEGINNING = 0.05
"""Seconds before the first iteration, whatever the size (measured)."""
FIELDS = 25
"""Boundary fields that a run holds at a time, besides those that the acceleration
remembers."""
NUMBER = 8
"""Bytes of a number."""
LONG = 20.0
"""Seconds from which a run says before it begins how long it takes."""
LARGE = 1e9
"""Bytes from which a run says before it begins how much memory it takes."""


class PricedMethod(Protocol):
    """Parts of a method that its cost depends on: a `solver.latin.Latin`."""

    @property
    def linear(self) -> object:
        """Form in which the linear stage holds its fields."""

    @property
    def acceleration(self) -> object | None:
        """Acceleration of the iteration."""

    @property
    def finish(self) -> object | None:
        """Status step that may end the run with a certified solution."""


@dataclass(frozen=True)
class Costs:
    """Estimated times of the parts of a run, and the size of a status step.

    Attributes
    ----------
    condensing
        Time of condensing the structure once, s.
    system
        Time of a linear system of the status step, s.
    iteration
        Time of an iteration, s.
    n_instants
        Number of instants; a status step solves at least one system for each.
    is_at_rest
        Whether nothing slips, so that one system per instant is enough.
    in_any_case
        Systems per instant that a status step may solve in any case.
    """

    condensing: float
    system: float
    iteration: float
    n_instants: int
    is_at_rest: bool = False
    in_any_case: int = SYSTEMS

    @property
    def step(self) -> float:
        """Time of a status step whose statuses are right, s."""
        return self.condensing + self.n_instants * self.system

    def afford(self, iterations: float, allowed: float = 0.0) -> bool:
        """Check whether a status step is worth its cost after a number of iterations.

        It may cost half of them, or those that it saves, or `allowed` seconds.
        """
        affordable = max(WORTH * iterations, AFFORDABLE)
        return self.step <= max(affordable * self.iteration, allowed)

    @cached_property
    def small_from(self) -> float:
        """Iteration from which a step is worth a trial, even with wrong statuses."""
        step = self.condensing + SYSTEMS * self.n_instants * self.system
        number = step / (TRIED * self.iteration)
        if self.is_at_rest:
            return min(number, self.step / self.iteration - SAVED)
        return number

    def systems(self, iterations: float) -> int:
        """Number of linear systems that a status step may solve after some iterations.

        They may take the time of the iterations. The step is tried again at twice as
        many iterations, so that all trials together take twice as long as these.
        """
        affordable = int(iterations * self.iteration / self.system)
        return max(self.in_any_case * self.n_instants, affordable)


def costs_of(problem: Problem, states: States | None = None) -> Costs:
    """Estimate the times of a problem, by the states of its jumps if they are known.

    Parameters
    ----------
    problem
        The problem to be solved.
    states
        States of an iterate as by `states_of`, shape (n_forces, n_instants); None
        before the first iterate.
    """
    n_jumps = jumps_in(problem)
    iteration = _iteration_cost(problem)
    in_any_case = _systems_in_any_case(problem)
    if rubs_on_supports(problem):
        return Costs(
            condensing=0.0,
            system=BAND_CALLS + BAND * n_jumps,
            iteration=iteration,
            n_instants=problem.n_instants,
            in_any_case=in_any_case,
        )
    if states is None:
        moving = _expected_share(problem)
    else:
        moving = float(np.mean(states != HELD))
    return Costs(
        condensing=_condensing_cost(problem, n_jumps),
        system=_system_cost(n_jumps, moving * n_jumps),
        iteration=iteration,
        n_instants=problem.n_instants,
        is_at_rest=states is not None and moving <= AT_REST,
        in_any_case=in_any_case,
    )


def _iteration_cost(problem: Problem) -> float:
    """Time of an iteration, s."""
    products = sum(2.0 * len(part.rows) ** 2 for part in problem.substructures)
    products = min(products, 200.0 * problem.n_rows)
    passes = products / DENSE + PASSES * PASS * problem.n_rows
    return OF_ITERATION + problem.n_instants * passes


def _systems_in_any_case(problem: Problem) -> int:
    """Linear systems per instant that a status step may solve in any case."""
    softens = any(law.tangential.softens for law in problem.rubbing.laws.values())
    has_several_rods = rubs_on_supports(problem) and len(problem.rubbing) > 1
    if softens or has_several_rods:
        return ENDS_FOR_SURE
    return SYSTEMS


def _condensing_cost(problem: Problem, n_jumps: int) -> float:
    """Time of condensing a structure to its jumps, s."""
    entries = 0.0
    for part in problem.substructures:
        stiffness = part.elasticity.stiffness
        if isinstance(stiffness, np.ndarray):
            entries += stiffness.size
        else:
            entries += stiffness.nnz
    return 4.0 * entries * n_jumps / SPARSE + SQUARE * n_jumps**2


def _system_cost(n_jumps: int, n_moving: float) -> float:
    """Time of a dense linear system for the jumps that move, of all jumps, s."""
    system = CALLS + 2.0 / 3.0 * n_moving**3 / FACTOR
    return system + (GATHER * n_moving + READ * n_jumps) * n_moving


def _expected_share(problem: Problem) -> float:
    """Share of the jumps that may move at an instant, before any iterate shows it."""
    if problem.opens:
        return MOVING
    if not problem.rubbing:
        return 0.0
    return min(MOVING, NEXT * sliding_share(problem) / len(problem.rubbing))


@dataclass(frozen=True)
class RunCost:
    """Estimated cost of a run, right within a factor of three.

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
        """Check whether a run is so long or large that it should say so before."""
        return self.seconds > LONG or self.memory > LARGE

    def __str__(self) -> str:
        return f"{_duration(self.seconds)} and {self.memory / 1e9:.1g} GB"


def run_cost(
    problem: Problem, latin: PricedMethod, max_iterations: int, *, with_reference: bool
) -> RunCost:
    """Estimate the cost of a run from a problem to its end.

    Parameters
    ----------
    problem, latin
        The problem, and the method.
    max_iterations
        Largest number of iterations.
    with_reference
        Whether the incremental reference is solved before, if the problem has one.
    """
    costs = costs_of(problem)
    has_solver = _has_solver(problem)
    iterations = _expected_iterations(problem)
    if not latin.acceleration:
        iterations *= PLAIN
    iterations = min(iterations, max_iterations)
    is_worth_it = latin.finish is not None and costs.afford(iterations, WAIT)
    # Bases need the proof of a status step whatever it costs.
    takes_step = has_solver and (isinstance(latin.linear, PGD) or is_worth_it)
    incremental = costs.condensing + SYSTEMS * costs.n_instants * costs.system
    seconds = BEGINNING + WATCHED * iterations * costs.iteration
    if takes_step:
        seconds += incremental
    reference = 0.0
    if with_reference and has_solver:
        reference = incremental
    memory = _memory(problem, takes_step=takes_step, has_reference=reference > 0.0)
    return RunCost(seconds + reference, memory, reference)


def _has_solver(problem: Problem) -> bool:
    """Check whether an incremental solver may solve a problem, by its kind and size."""
    is_small = rubs_on_supports(problem) or jumps_in(problem) <= MOST_JUMPS
    return is_small and not problem.no_reference


def _expected_iterations(problem: Problem) -> float:
    """Number of accelerated iterations that a run takes."""
    # Without cuts the coarse problem carries loads through all bodies, however many
    # there are.
    coupled = 0
    if problem.cuts and not rubs_on_supports(problem):
        coupled = len(problem.rubbing) - 1
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
    return NUMBER * numbers


def _duration(seconds: float) -> str:
    """Write seconds with one digit, as the estimate has no more."""
    units = ((3600.0, "h"), (60.0, "min"))
    for size, unit in units:
        if seconds >= 1.5 * size:
            return f"{float(f'{seconds / size:.1g}'):g} {unit}"
    return f"{float(f'{seconds:.1g}'):g} s"
