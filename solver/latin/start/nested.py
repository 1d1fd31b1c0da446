"""A start from a coarser mesh: what is global is found where a solution is cheap."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.finish.certified import known_forces
from solver.latin.iterate import Checkpoint
from solver.latin.start.prolong import prolong
from solver.reference.choice import incremental_solver
from solver.reference.condensation import NoReferenceError
from solver.reference.solution import Interrupted, Reference


@dataclass(frozen=True)
class Nested:
    """A start from the solution of the same structure on a coarser mesh.

    The incremental solver finds it. LATIN's own iterate on that mesh serves less: on 400 elements
    and instants of the bar 1 % of the friction force takes 16 iterations instead of 70, on 1600
    elements 11 instead of never, and on strands of 10 and 20 wires 51 and 148 instead of 71 and
    more than 400, at a third to two thirds of the time (measured). From a mesh four times as coarse
    strands take twice as many.

    Attributes
    ----------
    coarser
        Such problems, uncut, the finest first; or what makes them, when a run begins.
    """

    coarser: Iterable[Problem] | Callable[[], Iterable[Problem]]

    def problems(self) -> Iterable[Problem]:
        """Give the coarser problems."""
        return self.coarser() if callable(self.coarser) else self.coarser

    def at_work(self, problem: Problem, k: Array, seconds: float = math.inf) -> Checkpoint | None:
        """Give where a problem starts with a search direction.

        From the finest of the meshes that has a solution. None if there is no such mesh, or it
        takes more than so many seconds.
        """
        deadline = time.perf_counter() + seconds
        for coarse in self.problems():
            try:
                solver = incremental_solver(coarse)
                found = solver.march(stop=lambda: time.perf_counter() > deadline)
            except NoReferenceError:
                continue
            except Interrupted:
                return None
            if found.converged.all():
                return Checkpoint(0, 0.0, _carried(found, problem, k))
        return None


def _carried(found: Reference, problem: Problem, k: Array) -> Array:
    """Carry the solution of a coarser mesh to a problem; give W + F/k, (n_rows, n_instants)."""
    coarse = found.problem
    displacement = found.displacement / coarse.scales.displacement
    force, _ = known_forces(coarse, found.contact_force / coarse.scales.force)
    return prolong(coarse, displacement[coarse.row_dofs], force, problem, k)
