"""A run that has ended: what its quantities are taken from, and its key figures."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.discrete.elements import von_mises
from solver.discrete.problem import Problem
from solver.discrete.structure import Loop
from solver.latin import Decision, Iterate, Solution, record, solve
from solver.latin.end.certified import finished
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
from solver.settings.scene import Settings
from solver.study.quantities.cycles import LoadCycles, cycles_of, slips_of

REFUSED = "refused"
BROKEN = "broken"
"""How a run ends that never was one: by refused settings, by a fault of the engine."""
TINY: dict[str, dict[str, object]] = {
    "bar": {"elements": 4, "substructures": 2, "instants": 3},
    "block": {"elements": 4, "elements_up": 2, "substructures": 2, "instants": 3},
}
"""Runs that go before others: to bring in code is no part of a run's time."""
ALONE = 60
"""Iterations that take as long as a run of its own, with all beside them. A status step
from a neighbour may take a third of that, which is 4 systems an instant on 50 elements
and 13 on 1600; it takes 1 to 3 and 3 to 9 (measured)."""
ZERO = 1e-9
"""Share of the largest value in a run below which a key figure is zero."""
EQUAL = 1e-6
"""Relative difference up to which two values count as equally large."""
Axes = tuple[tuple[str, str], tuple[str, str]]
"""Titles and units of the two axes of a loop."""
OF_UNITS = {
    "m": "displacement",
    "N": "force",
    "N·m": "moment",
    "rad": "rotation",
    "°": "slope",
    "1/m": "curvature",
}
"""Names of the key figures of a loop, by unit."""
DRIVES = {
    "Strain without force": "strain",
    "Settlement": "settlement",
    "Body force": "body_force",
}
"""Names by title of what drives a loop without being its displacement."""


@dataclass(frozen=True, eq=False)
class FinishedRun:
    """A run from its settings to its end, from another run if it was warm.

    `made_loop` is its loop, where that is at hand: in the plane it takes a while to
    make one. `known_loss` is the first instant that a reference knows to have no
    solution.
    """

    settings: Settings
    solution: Solution
    was_warm: bool = False
    made_loop: Loop | None = None
    known_loss: int | None = None

    @property
    def lost_from(self) -> int | None:
        """First instant that is known to have no solution; None where there is none such.

        With it the run has no quantities: all instants are iterated together, and those
        that have no solution keep the others from theirs. A certified run has a
        solution at all of them.
        """
        if self.solution.is_certified:
            return None
        losses = self.known_loss, self.solution.status.lost_from
        return min((loss for loss in losses if loss is not None), default=None)

    @property
    def iterate(self) -> Iterate:
        """Its last good iterate."""
        return self.solution.iterate

    @property
    def problem(self) -> Problem:
        """What it solves."""
        return self.iterate.problem

    @cached_property
    def loop(self) -> Loop:
        """Loop that the scene shows."""
        return self.made_loop or self.settings.structure().loop(self.problem)

    @cached_property
    def _along_loop(self) -> tuple[Array, Array]:
        return self.loop.along(self.iterate)

    @property
    def displacement(self) -> Array:
        """Displacement of the loop that the scene shows, m, or what it goes over; (n_instants,)."""
        return self._along_loop[0]

    @property
    def force(self) -> Array:
        """Force of that loop, shape (n_instants,), N."""
        return self._along_loop[1]

    @cached_property
    def dissipated(self) -> Array:
        """Energy that friction takes between each instant and the one before, (n_instants,), J."""
        works = (
            law.copies * work.sum(axis=0) for law, _, work in slips_of(self.iterate)
        )
        return np.asarray(sum(works, np.zeros(self.problem.n_instants)))

    @cached_property
    def cycles(self) -> LoadCycles:
        """The run, cycle by cycle of its load."""
        return cycles_of(self.settings, self.iterate)

    @cached_property
    def peak_stress(self) -> tuple[float, float, float]:
        """Largest von Mises stress in the plane, Pa, and x and y of the element that has it, m."""
        inside = self.problem.inside
        values = self.settings.values()
        assert inside is not None
        largest = 0.0
        place = np.full(2, np.nan)
        for instant in range(self.problem.n_instants):
            moved = inside.displacement(self.iterate.displacement, [instant])[:, :, 0]
            stress = von_mises(inside.stress(moved), values["poisson"], values["plane"])
            element = first_largest(stress)
            if stress[element] > (1.0 + EQUAL) * largest:
                largest = float(stress[element])
                place = inside.nodes[inside.elements[element]].mean(axis=0)
        return largest, float(place[0]), float(place[1])


def first_largest(values: Array) -> int:
    """Instant at which values, shape (n_instants,), first are largest in size, up to rounding."""
    size = np.abs(values)
    return int(np.argmax(size >= (1.0 - EQUAL) * size.max()))


def largest_load(run: FinishedRun) -> int:
    """Instant of the largest load: where the loop's force is largest in size.

    While the same load stands, displacement may go on to grow, as where friction falls.
    So of all instants of that force, that counts at which the displacement first is
    largest in size.
    """
    force = run.force
    first = first_largest(force)
    stands = np.flatnonzero(
        np.abs(force - force[first]) <= EQUAL * np.abs(force[first])
    )
    return int(stands[first_largest(run.displacement[stands])])


@dataclass(frozen=True, eq=False)
class KeyFigure:
    """A number of a run at every instant, (n_instants,), SI; a share has no unit."""

    name: str
    title: str
    unit: str
    values: Array

    @cached_property
    def instant(self) -> int:
        """Instant at which it first is largest in size."""
        return first_largest(self.values)

    @property
    def largest(self) -> float:
        """Value that is largest in size."""
        return float(self.values[self.instant])

    @property
    def last(self) -> float:
        """Value at the last instant."""
        return self.at(-1)

    def at(self, instant: int) -> float:
        """Value at an instant; zero where rounding alone leaves something."""
        value = float(self.values[instant])
        return value if abs(value) > ZERO * abs(self.largest) else 0.0


def key_figures(axes: Axes, loop: Iterable[NDArray[Any]]) -> list[KeyFigure]:
    """Key figures of a loop: of its axes, and of both its sides, shape (2, n_instants).

    A displacement has the name `displacement`, a force `force`; other numbers have
    others.
    """
    figures = []
    for (title, unit), values in zip(axes, loop, strict=True):
        name = DRIVES.get(title) or OF_UNITS[unit]
        figures.append(KeyFigure(name, title, unit, np.asarray(values)))
    return figures


def figures_of(run: FinishedRun) -> list[KeyFigure]:
    """Key figures of the loop of a run."""
    return key_figures(run.loop.axes, (run.displacement, run.force))


def slipping_shares(status: NDArray[np.int8]) -> Array:
    """Share of the points that slip at each instant, (n_instants,).

    Of the status of all contact points, shape (n_points, n_instants).
    """
    if not len(status):
        return np.zeros(status.shape[1])
    return np.asarray(((status != 0) & (status != OPEN)).mean(axis=0))


@cache
def settle() -> None:
    """Make tiny runs, once in a process, after which a run brings in no code any more."""
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
    """Run a scene to its stop rule, unless it is cancelled.

    Errors, where there is a reference, and indicators of every iteration take their
    time. `before` is what stuck, slipped and opened in a run of like settings, to start
    from where that holds.
    """
    began = time.perf_counter()
    problem = discretise(settings)
    spent = time.perf_counter() - began
    if errors:
        known = known_reference(problem, cancelled)
    else:
        known = Known()
    distance = None
    if known.reference is not None:
        distance = distance_to(known.reference, problem)
    if before is not None:
        near = neighbour(problem, settings, before, cancelled)
        if near is not None:
            return FinishedRun(settings, near, was_warm=True)
    solution = solve(
        problem,
        method_of(settings),
        distance=distance,
        watch=indicators,
        spent=spent,
        cancelled=cancelled,
    )
    return FinishedRun(settings, solution, known_loss=known.lost_from)


class Known(NamedTuple):
    """The reference, if there is one, and why it is not the one solution, if it is not.

    `lost_from` is the first instant that is known to have no solution.
    """

    reference: Reference | None = None
    doubt: str = ""
    lost_from: int | None = None


def known_reference(problem: Problem, stop: Callable[[], bool] | None = None) -> Known:
    """Find what is known without a run; `stop` is asked again and again whether to give up."""
    try:
        reference = reference_of(problem, stop)
    except Interrupted:
        return Known(doubt="the reference takes longer")
    except NoReferenceError as refusal:
        return Known(doubt=str(refusal))
    if lost := np.count_nonzero(~reference.converged):
        lost_from = None
        message = f"the reference finds no solution at {lost} of {problem.n_instants} instants"
        if reference.collapse is not None:
            lost_from = reference.collapse.instant
            message += (
                f": there is no equilibrium {limit_of(problem, reference.collapse)}"
            )
        elif reference.jumps_at is not None:
            # That none is found is no proof: a run may converge to one.
            message += ": friction softens until the structure jumps"
        return Known(None, message, lost_from)
    if reference.jumps_at is not None:
        where = jump_of(problem, reference.jumps_at)
        return Known(reference, f"at {where} it jumps to another equilibrium")
    several = np.count_nonzero(reference.ambiguous)
    if several:
        message = f"there are several solutions at {several} instants"
    else:
        message = ""
    return Known(reference, message)


def neighbour(
    problem: Problem,
    settings: Settings,
    states: States,
    stop: Callable[[], bool] | None = None,
) -> Solution | None:
    """Solution by a status step from what stuck, slipped and opened in a run of like settings.

    It counts only if it is the one of the discrete problem, which does not depend on
    the start; None where it is not found soon, or `stop` returns True before. A run on
    separated bases is its own, as it has these too.
    """
    began = time.perf_counter()
    fits = states.shape == (problem.sum_of_contact.shape[0], problem.n_instants)
    if settings.finish != "at-once" or settings.linear_stage == "pgd" or not fits:
        return None
    costs = costs_of(problem, states)
    if not costs.afford(ALONE):
        return None
    try:
        solver = incremental_solver(problem, stop)
        most = costs.systems(ALONE)
        _, certificate = status_step(solver, problem, states, most, stop)
    except (NoReferenceError, Interrupted):
        return None
    if certificate is None or certificate.residual > settings.accuracy:
        return None
    k = method_of(settings).direction.of(problem)
    finish = finished(problem, k, certificate)
    status = certified(finish, certificate)
    residual = certificate.residual
    seconds = time.perf_counter() - began
    decision = Decision(seconds, residual, certificate=certificate)
    return Solution(finish, [record(finish, decision, None, watch=False)], status)
