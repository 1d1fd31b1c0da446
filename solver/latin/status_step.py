"""The status step: from the stick, slip and opening of an iterate to the solution itself.

Statuses that an iterate shows make the problem linear, instant after instant. Those that the linear
solution itself shows to be wrong are mended where they stand, a Newton method that begins where
LATIN ends. If statuses and solution agree at every instant, all laws and equilibrium hold: then it
is the solution of the discrete problem up to rounding, whatever k and the method were, and it is
called certified (theory.md, 7). LATIN finds the fronts, the step finishes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.discrete.contact_fields import OPEN, jumps_of
from solver.discrete.problem import Problem
from solver.latin.iterate import Iterate
from solver.laws import Contact
from solver.reference.choice import Incremental, incremental_solver, is_alone
from solver.reference.contact import jumps_in
from solver.reference.distance import Distance, distance_to
from solver.reference.solution import Reference, States

STILL = 1e-3
"""Share of the largest slip of an interface below which a point counts as stuck, at most. A point
that comes to rest goes on creeping in the local stage for a hundred iterations: with 1e-9 a fifth
of all statuses is wrong on the bar while the force is within 1 %, with 1e-3 one in a thousand."""
FRONT = 2.0
"""The same over the square of a point's share of the length, as slip grows behind a front. To call
a point stuck that slips is the dearer mistake: mending frees one point at a time, and stops many
at once. On 800 elements and 101 instants a step takes 480 systems with `STILL` alone, 180 with
this, and 190 with 1e-9 (measured)."""
SYSTEMS = 3
"""Linear systems for every instant that a step may solve in any case."""
SHARE = 1.0 / 3.0
"""Share of the time of all iterations that a step may take: it is tried again at half as many
iterations more, so that all trials together take as long as the iterations. Under loads far beyond
friction an instant takes ten systems from any statuses, and from the exact force (measured)."""
CERTIFIED = 1e-7
"""KKT residual of a certified solution at most, relative to the contact force. Its statuses agree
with it exactly; on four wires of 320 elements the linear systems leave 1e-8 (measured)."""
BLURRED = 1e-5
"""The same where it is all rounding: the forces in elements of slender bodies are 1e7 times those
of contact."""
DENSE, SPARSE = 1e10, 2e9
"""Operations a second of dense factors and products, and of sparse factors (measured)."""
PASSES, PASS = 30, 1e-9
"""How often an iteration passes over a boundary field, and seconds a number (measured)."""
CALLS, OF_ITERATION = 1e-4, 5e-4
"""Seconds of a dense system, and of an iteration, that no size makes less (measured)."""
BAND, BAND_CALLS = 6e-8, 3e-5
"""Seconds a number of a system with a band matrix, and those that no size makes less (measured)."""
AFFORDABLE = 40
"""Iterations that a status step may cost in any case: about as many as it saves."""


@dataclass(frozen=True, eq=False)
class Certificate:
    """A solution of the discrete problem, proven by its own residual.

    Attributes
    ----------
    reference
        Its fields.
    distance
        To it.
    residual
        Its KKT residual, relative to the contact force: the largest of all points and instants as
        if it were that of each.
    """

    reference: Reference
    distance: Distance
    residual: float


class StatusStep:
    """The status step of one problem; what it condenses is kept for the next."""

    def __init__(self, problem: Problem) -> None:
        self._problem = problem

    def __call__(self, iterate: Iterate, patience: float = 1.0) -> Certificate | None:
        """Try to certify what an iterate shows; None where its statuses are too far from right.

        Parameters
        ----------
        iterate
            Whose statuses to begin with.
        patience
            Times as many linear systems that it may take as its iterations are worth.

        Raises
        ------
        NoReferenceError
            If the problem has no incremental solver, or none that is worth its size.
        """
        most = systems_allowed(self._problem, patience * iterate.number)
        found = self._solver.march(guess=states_of(iterate), most=most)
        if not found.converged.all():
            return None
        distance = distance_to(found, self._problem)
        residual = found.unbalanced * np.sqrt(len(found.contact_force)) / distance.force_size
        if residual > (BLURRED if found.unbalanced <= found.rounding else CERTIFIED):
            return None
        return Certificate(found, distance, float(residual))

    @cached_property
    def _solver(self) -> Incremental:
        return incremental_solver(self._problem)


def states_of(iterate: Iterate) -> States:
    """Read the states of an iterate, as the incremental solvers take them for a guess.

    Returns
    -------
    Stacked as `Problem.sum_of_contact` says, shape (n_forces, n_instants): -1, 0, +1 of tangential
    components; of normal ones 0 where they are closed; `OPEN` of both where they are not.
    """
    force = iterate.boundary_local_force
    found: list[States] = []
    for law in iterate.problem.rubbing.values():
        position = law.by_point(jumps_of(law, iterate.local_displacement)[-1])
        slip = np.diff(position, axis=1, prepend=0.0)
        still = min(STILL, FRONT / len(slip) ** 2) * np.abs(slip).max(initial=0.0)
        way = np.sign(slip) * (np.abs(slip) > still)
        if isinstance(law, Contact):
            is_open = law.by_point(force[law.normal]) <= 0.0
            found.append(np.where(is_open, OPEN, 0).astype(np.int8))
            way[is_open] = OPEN
        found.append(way.astype(np.int8))
    return np.concatenate(found)


def systems_allowed(problem: Problem, iterations: float) -> int:
    """Give the number of linear systems that a step may solve after so many iterations."""
    worth = SHARE * iterations * iteration_seconds(problem)
    return max(SYSTEMS * problem.n_instants, int(worth / system_seconds(problem)))


def is_affordable(problem: Problem, iterations: float, least: float = 0.0) -> bool:
    """Tell whether a status step costs no more than the iterations done so far, or that it saves.

    Or than `least`, s.

    So a run never costs more than twice what the better of both ways would have. It is a matter of
    counts, not of clocks, so that a run ends alike on every machine. On one rigid support of known
    bound a step costs a band matrix an instant; elsewhere the structure is condensed onto its
    contacts first, and then an instant costs a dense matrix of those that move.
    """
    allowed = max(max(iterations, AFFORDABLE) * iteration_seconds(problem), least)
    return is_alone(problem) or step_seconds(problem) <= allowed


def step_seconds(problem: Problem) -> float:
    """Estimate the time of a status step where the structure is condensed first, s."""
    n_jumps, entries = jumps_in(problem), 0.0
    for part in problem.substructures:
        stiffness = part.elasticity.stiffness
        entries += stiffness.size if isinstance(stiffness, np.ndarray) else stiffness.nnz
    condensing = 4.0 * entries * n_jumps / SPARSE + 2.0 * n_jumps**3 / DENSE
    return condensing + problem.n_instants * system_seconds(problem)


def system_seconds(problem: Problem) -> float:
    """Estimate the time of one linear system of the step, s."""
    n_jumps = jumps_in(problem)
    if is_alone(problem):
        return BAND_CALLS + BAND * n_jumps
    # A third of the jumps moves at an instant, in the scenes at hand.
    return CALLS + (6.0 * n_jumps**2 + 2.0 / 3.0 * (n_jumps / 3.0) ** 3) / DENSE


def iteration_seconds(problem: Problem) -> float:
    """Estimate the time of one iteration, s."""
    products = sum(2.0 * len(part.rows) ** 2 for part in problem.substructures)
    products = min(products, 200.0 * problem.n_rows)
    return OF_ITERATION + problem.n_instants * (products / DENSE + PASSES * PASS * problem.n_rows)
