"""A run that has ended: what its quantities are taken from, and its key figures."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.discrete.plane import von_mises
from solver.discrete.problem import Problem
from solver.discrete.structure import Loop
from solver.latin import Decision, Iterate, Solution, record, solve
from solver.latin.certified import finished
from solver.latin.cost import costs_of
from solver.latin.status import certified
from solver.latin.status_step import status_step
from solver.laws import OPEN
from solver.reference.condensation import Interrupted, NoReferenceError
from solver.reference.distance import distance_to
from solver.reference.incremental import incremental_solver, reference_of
from solver.reference.rules import States
from solver.reference.solution import Reference
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.study.quantities.cycles import LoadCycles, cycles_of, slips_of

REFUSED, BROKEN = "refused", "broken"
"""How a run ends that never was one: by refused settings, by a fault of the engine."""
TINY: dict[str, dict[str, object]] = {
    "bar": {"elements": 4, "substructures": 2, "instants": 3},
    "block": {"elements": 4, "elements_up": 2, "substructures": 2, "instants": 3},
}
"""Runs that go before others: to bring in code is no part of a run's time."""
ALONE = 60
"""Iterations that take as long as a run of its own, with all beside them. A status step from a
neighbour may take a third of that, which is 4 systems an instant on 50 elements and 13 on 1600; it
takes 1 to 3 and 3 to 9 (measured)."""
ZERO = 1e-9
"""Share of the largest value in a run below which a key figure is zero."""
EQUAL = 1e-6
"""Relative difference up to which two loads count as equally large."""


@dataclass(frozen=True, eq=False)
class FinishedRun:
    """A run from its settings to its end, from another run if it was warm.

    `made_loop` is its loop, where that is at hand: in the plane it takes a while to make one.
    """

    settings: Settings
    solution: Solution
    was_warm: bool = False
    made_loop: Loop | None = None

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
        works = (work.sum(axis=0) for _, _, work in slips_of(self.iterate))
        return np.asarray(sum(works, np.zeros(self.problem.n_instants)))

    @cached_property
    def cycles(self) -> LoadCycles:
        """The run, cycle by cycle of its load."""
        return cycles_of(self.settings, self.iterate)

    @cached_property
    def peak_stress(self) -> tuple[float, float, float]:
        """Largest von Mises stress in the plane, Pa, and x and y of the element that has it, m."""
        inside, values = self.problem.inside, self.settings.values()
        assert inside is not None
        largest, place = 0.0, np.full(2, np.nan)
        for instant in range(self.problem.n_instants):
            moved = inside.displacement(self.iterate.displacement, [instant])[:, :, 0]
            stress = von_mises(inside.stress(moved), values["poisson"], values["plane"])
            element = int(stress.argmax())
            if stress[element] > largest:
                largest = float(stress[element])
                place = inside.nodes[inside.elements[element]].mean(axis=0)
        return largest, float(place[0]), float(place[1])


def largest_load(run: FinishedRun) -> int:
    """Instant at which the loop's force first is largest."""
    size = np.abs(run.force)
    return int(np.argmax(size >= (1.0 - EQUAL) * size.max()))


@dataclass(frozen=True)
class KeyFigure:
    """A number of a run at an instant, and the largest in the run, in SI; a share has no unit."""

    name: str
    title: str
    value: float
    unit: str
    largest: float


def key_figures(
    axes: tuple[tuple[str, str], tuple[str, str]],
    loop: Iterable[NDArray[Any]],
    status: NDArray[np.int8],
    energy: float,
    instant: int,
) -> list[KeyFigure]:
    """Key figures at an instant.

    Of the axes of the loop and both of its sides, shape (2, n_instants), the status of all contact
    points, shape (n_points, n_instants), and the energy that friction takes in the whole run, J.
    """
    figures = []
    for name, (title, unit), values in zip(("displacement", "force"), axes, loop, strict=True):
        largest, value = float(np.abs(values).max()), float(values[instant])
        value = value if abs(value) > ZERO * largest else 0.0
        figures.append(KeyFigure(name, title, value, unit, largest))
    now = status[:, instant]
    slipping = float(np.mean((now != 0) & (now != OPEN))) if len(now) else 0.0
    figures.append(KeyFigure("slipping", "Slips", slipping, "", 1.0))
    return [*figures, KeyFigure("energy", "Energy lost", energy, "J", abs(energy))]


def figures_of(run: FinishedRun) -> tuple[list[KeyFigure], float]:
    """Key figures of a run where its force first is largest, and when that is, s."""
    instant = largest_load(run)
    status, energy = run.iterate.status, float(run.dissipated.sum())
    figures = key_figures(run.loop.axes, (run.displacement, run.force), status, energy, instant)
    return figures, float(run.problem.instants[instant])


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

    Errors, where there is a reference, and indicators of every iteration take their time. `before`
    is what stuck, slipped and opened in a run of like settings, to start from where that holds.
    """
    began = time.perf_counter()
    problem = discretise(settings)
    spent = time.perf_counter() - began
    reference, _ = known_reference(problem, cancelled) if errors else (None, "")
    distance = None if reference is None else distance_to(reference, problem)
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
    return FinishedRun(settings, solution)


def known_reference(
    problem: Problem, stop: Callable[[], bool] | None = None
) -> tuple[Reference | None, str]:
    """The reference, if there is one, and why it is not the one solution, if it is not.

    `stop` is asked again and again whether to give it up.
    """
    try:
        reference = reference_of(problem, stop)
    except Interrupted:
        return None, "the reference takes longer"
    except NoReferenceError as refusal:
        return None, str(refusal)
    if lost := np.count_nonzero(~reference.converged):
        message = f"the reference finds no solution at {lost} of {problem.n_instants} instants"
        if reference.collapse is not None:
            message += f": there is no equilibrium from {reference.collapse.time:.4g} s on"
        elif reference.jumps_at is not None:
            message += ": friction softens until the structure jumps"
        return None, message
    if reference.jumps_at is not None:
        return reference, f"it jumps at instant {reference.jumps_at} to another equilibrium"
    several = np.count_nonzero(reference.ambiguous)
    return reference, f"there are several solutions at {several} instants" if several else ""


def neighbour(
    problem: Problem,
    settings: Settings,
    states: States,
    stop: Callable[[], bool] | None = None,
) -> Solution | None:
    """Solution by a status step from what stuck, slipped and opened in a run of like settings.

    It counts only if it is the one of the discrete problem, which does not depend on the start;
    None where it is not found soon, or `stop` returns True before. A run on separated bases is its
    own, as it has these too.
    """
    began = time.perf_counter()
    fits = states.shape == (problem.sum_of_contact.shape[0], problem.n_instants)
    if settings.finish != "at-once" or settings.linear_stage == "pgd" or not fits:
        return None
    costs = costs_of(problem, states)
    if not costs.afford(ALONE):
        return None
    try:
        solver, most = incremental_solver(problem, stop), costs.systems(ALONE)
        _, certificate = status_step(solver, problem, states, most, stop)
    except (NoReferenceError, Interrupted):
        return None
    if certificate is None or certificate.residual > settings.accuracy:
        return None
    k = method_of(settings).direction.of(problem)
    finish = finished(problem, k, certificate)
    status, residual = certified(finish, certificate), certificate.residual
    seconds = time.perf_counter() - began
    decision = Decision(seconds, residual, certificate=certificate)
    return Solution(finish, [record(finish, decision, None, watch=False)], status)
