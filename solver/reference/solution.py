"""The solution of a problem on its own mesh and instants, and how far fields are from one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.discrete.contact_fields import ContactFields, contact_fields
from solver.discrete.problem import Problem
from solver.reference.condensation import Condensation
from solver.reference.limit_analysis import Collapse
from solver.reference.rules import Rules

States = NDArray[np.int8]


class Interrupted(Exception):  # noqa: N818  # asked for by the caller, so no error
    """The caller asked the solver to stop before the last instant."""


@dataclass(frozen=True, eq=False)
class Reference:
    """The solution of a problem on its own mesh and instants, exact up to rounding.

    Attributes
    ----------
    problem
        What it solves.
    displacement
        Shape (n_dofs, n_instants), m.
    contact_force
        Nodal forces on the bodies above, stacked as `Problem.sum_of_contact` says, shape
        (n_forces, n_instants), N.
    status
        Shape (n_points, n_instants), the points stacked interface by interface: -1 slip backward,
        0 stick, +1 slip forward, 2 open. The increment of a sticking point is zero.
    residual
        Relative KKT residual, the maximum over the instants. Of `incremental`: distance of 0 from
        the subdifferential K v - g + r d|v| of phi, in the maximum norm, divided by the sum of |g|;
        storing v in doubles costs as much.
    unbalanced
        The same before it is divided, N.
    converged
        Whether the instants are solved, shape (n_instants,).
    ambiguous
        Instants whose solution is certainly one of several, same shape; others may be, too, where
        friction is large.
    steps
        Newton steps, which are linear systems of full size, in all.
    seconds
        Time taken.
    rounding
        What rounding alone may leave of `unbalanced`, N.
    deformation
        Displacement but for rigid motions of bodies that contact alone holds, which would hide it;
        shape (n_dofs, n_instants), m. None where nothing moves so.
    jumps_at
        First instant that has no solution that goes on from the instant before, as friction falls
        with slip faster than the structure unloads: what follows, if anything is solved, is another
        equilibrium. None where there is no such instant.
    is_lost
        Whether an instant that was tried is not solved.
    collapse
        From when on no contact forces balance the loads, where it is known that they do not.
    """

    problem: Problem
    displacement: Array
    contact_force: Array
    status: NDArray[np.int8]
    residual: float
    unbalanced: float
    converged: NDArray[np.bool_]
    ambiguous: NDArray[np.bool_]
    steps: int
    seconds: float
    rounding: float = 0.0
    deformation: Array | None = None
    jumps_at: int | None = None
    is_lost: bool = False
    collapse: Collapse | None = None

    @property
    def friction_force(self) -> Array:
        """Nodal friction force on the body, (n_points, n_instants), N, where its bound is known."""
        return self.contact_force

    def contact(self, name: str) -> ContactFields:
        """Forces, status and motion of an interface with friction."""
        problem = self.problem
        sizes = [len(law.positions) for law in problem.rubbing.values()]
        first = sum(sizes[: list(problem.rubbing).index(name)])
        status = self.status[first : first + len(problem.rubbing[name].positions)]
        rows = self.displacement[problem.row_dofs] / problem.scales.displacement
        return contact_fields(problem, name, self.contact_force, rows, status)


class Shown(NamedTuple):
    """Fields of a structure, scaled.

    Attributes
    ----------
    deformation
        Displacement but for rigid motions, shape (n_dofs, n_instants).
    forces, opening, slip
        Of all jumps, with what is in series, shape (n_forces, n_instants).
    """

    deformation: Array
    forces: Array
    opening: Array
    slip: Array


def unbalanced_of(condensed: Condensation, rules: Rules, shown: Shown) -> NDArray[np.float64]:
    """KKT residual of every instant, a force, scaled.

    The largest of: forces out of balance; distance of the normal force from (f - r g)+ with the
    opening g, and of the friction force from f - r v cut to its bound, with the slip v. A stiffness
    r of the pair makes a force of a length; the conditions hold if and only if both distances
    vanish.
    """
    forces, unit = shown.forces, condensed.unit[:, None]
    bound = rules.bounds(forces, shown.slip, shown.opening)
    pressed = np.maximum(forces - unit * shown.opening, 0.0)
    rubbed = np.clip(forces - unit * shown.slip, -bound, bound)
    wrong = np.abs(forces - np.where(rules.normal[:, None], pressed, rubbed))
    # The force of a normal jump that is prescribed is not determinate, so it has no law to obey.
    moving = np.isin(np.arange(len(forces)), condensed.moving)
    wrong[rules.normal & ~moving] = 0.0
    unbalanced = np.abs(condensed.unbalanced(shown.deformation, forces)).max(axis=0, initial=0.0)
    return np.asarray(np.maximum(unbalanced, wrong.max(axis=0, initial=0.0)))
