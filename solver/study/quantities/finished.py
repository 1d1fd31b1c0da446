"""A finished run, from which quantities are read; key figures of the loop."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array
from solver.discrete.elements import von_mises
from solver.discrete.problem import Problem
from solver.discrete.structure import Loop
from solver.latin import Iterate, Solution
from solver.scenes.plane import poisson_in
from solver.settings.scene import Settings
from solver.study.quantities.cycles import LoadCycles, cycles_of, slips_of

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
