"""A finished run, from which quantities are read; key figures of the loop."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.cache import CACHE
from solver.discrete.elements import von_mises
from solver.discrete.problem import Problem
from solver.discrete.structure import Loop
from solver.latin import Answer, Decision, Iterate, Solution, record, solve
from solver.latin.end.certified import certified_answer
from solver.latin.end.cost import costs_of
from solver.latin.end.status import certified, jump_of, limit_of
from solver.latin.end.status_step import status_step
from solver.laws import OPEN
from solver.reference.assembly import Interrupted, NoReferenceError
from solver.reference.distance import distance_to
from solver.reference.incremental import incremental_solver, reference_of
from solver.reference.rules import States
from solver.reference.solution import Reference
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.scenes.plane import poisson_in
from solver.settings.scene import Settings
from solver.study.quantities.cycles import LoadCycles, cycles_of, slips_of

REFUSED = "refused"
BROKEN = "broken"
"""Endings of a run without a result: refused settings, or a fault of the engine."""
TINY: dict[str, dict[str, object]] = {
    "bar": {"elements": 4, "substructures": 2, "instants": 3},
    "block": {"elements": 4, "elements_up": 2, "substructures": 2, "instants": 3},
}
"""Tiny runs that precede timed ones: importing code is no part of a run's time."""
ALONE = 60
"""Iterations, with everything beside them, that take as long as a usual run.

A status step from a neighbour may take a third of that: 4 systems an instant on 50
elements and 13 on 1600. It takes 1 to 3 and 3 to 9 (measured)."""
ZERO = 1e-9
"""Share of the largest value in a run below which a key figure is zero."""
EQUAL = 1e-6
"""Relative difference up to which two values count as equally large."""
OF_UNITS = {
    "m": "displacement",
    "N": "force",
    "N·m": "moment",
    "rad": "rotation",
    "°": "slope",
    "1/m": "curvature",
}
"""Names of the key figures of a loop by their units."""
DRIVES = {
    "Strain without force": "strain",
    "Settlement": "settlement",
    "Body force": "body_force",
}
"""Names of drives of a loop other than displacements, by their titles."""


@dataclass(frozen=True, eq=False)
class FinishedRun:
    """A finished run: settings, solution and times.

    Attributes
    ----------
    settings, solution
        Settings of the run, and its solution.
    was_warm
        Whether the run started from the states of another run.
    made_loop
        Loop of the run where it is at hand: in the plane it takes a while to make one.
    known_loss
        First instant that a reference knows to have no solution.
    """

    settings: Settings
    solution: Solution
    was_warm: bool = False
    made_loop: Loop | None = None
    known_loss: int | None = None

    @property
    def lost_from(self) -> int | None:
        """First instant without a solution, as far as known; None without any.

        A run with such an instant has no quantities: all instants are iterated
        together, and those without a solution keep the others from converging. A
        certified run has a solution at all instants.
        """
        if self.solution.is_certified:
            return None
        losses = self.known_loss, self.solution.status.lost_from
        return min((loss for loss in losses if loss is not None), default=None)

    @property
    def iterate(self) -> Iterate:
        """Last good iterate of the run."""
        return self.solution.iterate

    @property
    def problem(self) -> Problem:
        """Discrete problem that the run solves."""
        return self.iterate.problem

    @cached_property
    def loop(self) -> Loop:
        """Loop that the scene shows."""
        return self.made_loop or self.settings.structure().loop(self.problem)

    @cached_property
    def _along_loop(self) -> tuple[Array, Array]:
        """Displacement and force of the loop, shape (n_instants,) each, m and N."""
        return self.loop.along(self.iterate)

    @property
    def displacement(self) -> Array:
        """Abscissa of the loop, mostly a displacement, m, shape (n_instants,)."""
        return self._along_loop[0]

    @property
    def force(self) -> Array:
        """Force of the loop, shape (n_instants,), N."""
        return self._along_loop[1]

    @cached_property
    def dissipated(self) -> Array:
        """Energy dissipated since the instant before, shape (n_instants,), J."""
        energy = np.zeros((len(self.problem.contacts), self.problem.n_instants))
        for stacked, _, work in slips_of(self.iterate):
            law = stacked.law
            energy[stacked.numbers] = law.copies * law.sums(work)
        return np.asarray(energy.sum(axis=0))

    @cached_property
    def cycles(self) -> LoadCycles:
        """Slip and friction work of the run, cycle by cycle of its load."""
        return cycles_of(self.settings, self.iterate)

    @cached_property
    def peak_stress(self) -> tuple[float, float, float]:
        """Largest von Mises stress in the plane, Pa, and x and y of its element, m."""
        inside = self.problem.inside
        assert inside is not None
        state = self.settings.values()["plane"]
        poisson = poisson_in(self.settings, inside)
        largest = 0.0
        centre = np.full(2, np.nan)
        for instant in range(self.problem.n_instants):
            vectors = inside.displacement(self.iterate.displacement, [instant])[:, :, 0]
            components = inside.stress(vectors)
            stress = von_mises(components, poisson, state)
            element = first_largest(stress)
            # Rounding must not move the largest stress to a later instant.
            if stress[element] > (1.0 + EQUAL) * largest:
                largest = float(stress[element])
                # A triangle has its last corner twice, and a beam both of its ends.
                corners = np.unique(inside.elements[element])
                centre = inside.nodes[corners].mean(axis=0)
        return largest, float(centre[0]), float(centre[1])


def first_largest(values: Array) -> int:
    """First instant at which values, (n_instants,), are largest up to rounding."""
    size = np.abs(values)
    return int(np.argmax(size >= (1.0 - EQUAL) * size.max()))


def largest_load(run: FinishedRun) -> int:
    """Instant of the largest load: of the largest force of the loop.

    While the load is held, the displacement may continue growing, as where friction
    falls. So of all instants of that force, the first with the largest displacement
    counts.
    """
    force = run.force
    largest = force[first_largest(force)]
    is_held = np.abs(force - largest) <= EQUAL * np.abs(largest)
    # Of the instants at which the load is held, the displacement decides.
    held = np.flatnonzero(is_held)
    return int(held[first_largest(run.displacement[held])])


@dataclass(frozen=True, eq=False)
class KeyFigure:
    """A number of a run at every instant, (n_instants,), SI; a share has no unit."""

    name: str
    title: str
    unit: str
    values: Array

    @cached_property
    def instant(self) -> int:
        """First instant at which the number is largest in size."""
        return first_largest(self.values)

    @property
    def largest(self) -> float:
        """Value that is largest in size."""
        # No force is written as -0.
        return float(self.values[self.instant]) + 0.0

    @property
    def last(self) -> float:
        """Value at the last instant."""
        return self.at(-1)

    def at(self, instant: int) -> float:
        """Value at an instant, with zero in place of rounding errors."""
        value = float(self.values[instant])
        if abs(value) > ZERO * abs(self.largest):
            return value
        return 0.0


def figures_of(run: FinishedRun) -> list[KeyFigure]:
    """Key figures of the loop of a run: of its displacement and of its force.

    A displacement has the name `displacement`, a force `force`; other numbers have
    names by their units or titles.
    """
    figures = []
    loop = run.displacement, run.force
    for (title, unit), values in zip(run.loop.axes, loop, strict=True):
        name = DRIVES.get(title) or OF_UNITS[unit]
        figures.append(KeyFigure(name, title, unit, values))
    return figures


def slipping_shares(status: NDArray[np.int8]) -> Array:
    """Share of the points that slip at each instant, shape (n_instants,).

    The status is that of all contact points, shape (n_points, n_instants).
    """
    if not len(status):
        return np.zeros(status.shape[1])
    slips = (status != 0) & (status != OPEN)
    return np.asarray(slips.mean(axis=0))


@cache
def warm_up() -> None:
    """Make tiny runs, once in a process, so that later times include no imports."""
    for scene, tiny in TINY.items():
        finished_run(CATALOGUE[scene].checked(tiny))


def finished_run(
    settings: Settings,
    *,
    errors: bool = True,
    indicators: bool = True,
    cancelled: Callable[[], bool] = lambda: False,
    before: States | None = None,
) -> FinishedRun:
    """Run a scene to its stop rule.

    Parameters
    ----------
    settings
        Settings of the scene.
    errors
        Whether to compute the errors of every iteration, where there is a reference.
    indicators
        Whether to compute the indicators of every iteration.
    cancelled
        Asked again and again whether to give up.
    before
        States (stick, slip, open) of a run of similar settings, which the run starts
        from if the solution of these settings is found from there.
    """
    # The time of a run includes its discretisation.
    began = time.perf_counter()
    problem = discretise(settings)
    spent = time.perf_counter() - began
    if errors:
        known = known_reference(problem, cancelled)
    else:
        known = KnownReference()
    distance = None
    if known.reference is not None:
        distance = distance_to(known.reference, problem)
    # From a neighbour one status step may find the solution, without any iteration.
    if before is not None:
        near = neighbour(problem, settings, before, cancelled, spent)
        if near is not None:
            answer, decision = near
            assert decision.status is not None
            last = record(answer, decision, distance, watch=indicators)
            found = Solution(answer, [last], decision.status)
            return FinishedRun(settings, found, was_warm=True)
    solution = solve(
        problem,
        method_of(settings),
        distance=distance,
        watch=indicators,
        spent=spent,
        cancelled=cancelled,
    )
    return FinishedRun(settings, solution, known_loss=known.lost_from)


class KnownReference(NamedTuple):
    """Reference of a problem, with doubts on existence and uniqueness.

    Attributes
    ----------
    reference
        Reference solution, if there is one.
    doubt
        Reason why there is no reference, or why it is not the only solution.
    lost_from
        First instant that is known to have no solution.
    """

    reference: Reference | None = None
    doubt: str = ""
    lost_from: int | None = None


def known_reference(
    problem: Problem, stop: Callable[[], bool] | None = None
) -> KnownReference:
    """Find the reference; `stop` is called repeatedly, and ends the search.

    Nothing that it prepares is kept: a run afterwards prepares its own in its time.
    """
    try:
        reference = reference_of(problem, stop)
    except Interrupted:
        return KnownReference(doubt="the reference takes longer")
    except NoReferenceError as refusal:
        return KnownReference(doubt=str(refusal))
    finally:
        CACHE.clear()
    if not reference.converged.all():
        return _without_solution(problem, reference)
    # A reference past a jump is one of several equilibria.
    if reference.jumps_at is not None:
        where = jump_of(problem, reference.jumps_at)
        return KnownReference(reference, f"at {where} it jumps to another equilibrium")
    several = np.count_nonzero(reference.ambiguous)
    if several:
        return KnownReference(
            reference, f"there are several solutions at {several} instants"
        )
    return KnownReference(reference)


def _without_solution(problem: Problem, reference: Reference) -> KnownReference:
    """Sentence on a problem whose reference has no solution at some instants."""
    lost = np.count_nonzero(~reference.converged)
    lost_from = None
    message = (
        f"the reference finds no solution at {lost} of {problem.n_instants} instants"
    )
    if reference.collapse is not None:
        lost_from = reference.collapse.instant
        message += f": there is no equilibrium {limit_of(problem, reference.collapse)}"
    elif reference.jumps_at is not None:
        # A jump of the reference is no proof: a run may converge at that instant.
        message += ": friction softens until the structure jumps"
    return KnownReference(None, message, lost_from)


def neighbour(
    problem: Problem,
    settings: Settings,
    states: States,
    stop: Callable[[], bool] | None = None,
    spent: float = 0.0,
) -> tuple[Answer, Decision] | None:
    """Solve by a status step from the states of a run with similar settings.

    The answer counts only if it is certified for the discrete problem, and no other
    solution shows, so that it does not depend on the start. None where it is not found
    soon, or where `stop` returns True before. A run on separated bases never starts
    from another one, since its bases are part of its result.

    Parameters
    ----------
    problem, settings
        Problem to be solved, and the settings that it was made from.
    states
        States as of `states_of`, shape (n_forces, n_instants).
    stop
        Asked again and again whether to give up.
    spent
        Time that the run took before, s.
    """
    began = time.perf_counter()
    # States of another mesh, or of other instants, are no start.
    fits = states.shape == (problem.sum_of_contact.shape[0], problem.n_instants)
    if settings.finish != "at-once" or settings.linear_stage == "pgd" or not fits:
        return None
    costs = costs_of(problem, states)
    if not costs.afford(ALONE) or _may_have_others(problem):
        return None
    try:
        solver = incremental_solver(problem, stop)
        limit = costs.systems(ALONE)
        _, certificate = status_step(solver, problem, states, limit, stop)
    except (NoReferenceError, Interrupted):
        return None
    if certificate is None or certificate.residual > settings.accuracy:
        return None
    if certificate.solution.ambiguous.any():
        return None
    # The solution has fields of a run, too, with the k of its method.
    k = method_of(settings).direction.of(problem)
    answer = certified_answer(problem, k, certificate)
    status = certified(answer, certificate)
    seconds = spent + time.perf_counter() - began
    return answer, Decision(seconds, certificate.residual, status, certificate)


def _may_have_others(problem: Problem) -> bool:
    """Check whether several solutions may exist: friction softens, or bonds break.

    Which of them a run finds depends on its start.
    """
    for law in problem.contacts.laws.values():
        friction = law.tangential
        has_bonds = law.opens and bool(friction.bound.any())
        if friction.softens or has_bonds:
            return True
    return False
