"""The solution of a problem on its own mesh and instants; a digest of a problem."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.cache import content_of
from solver.discrete.contacts import ContactFields
from solver.discrete.problem import Problem
from solver.reference.assembly import assembled_stiffness, external_force, jumps
from solver.reference.limit_analysis import Collapse
from solver.reference.rules import OF_JUMPS, States, rules_of


@dataclass(frozen=True, eq=False)
class Reference:
    """The solution of a problem on its own mesh and instants, exact up to rounding.

    Attributes
    ----------
    problem
        The problem that is solved.
    displacement
        Shape (n_dofs, n_instants), m.
    deformation
        Displacement without the rigid motions of bodies that contact alone holds, whose
        digits would hide it, same shape, m.
    contact_force
        Nodal forces on the bodies above, stacked as `Problem.sum_of_contact` says,
        shape (n_forces, n_instants), N.
    status
        Shape (n_points, n_instants), the points stacked interface by interface: -1 slip
        backward, 0 stick, +1 slip forward, 2 open. The increment of a sticking point is
        zero.
    unbalanced
        KKT residual, the maximum over the instants, N. Of rods: distance of 0 from the
        subdifferential K v - g + r d|v| of phi, in the maximum norm.
    converged
        Whether the instants are solved, shape (n_instants,).
    ambiguous
        Instants whose solution is certainly one of several, same shape; others may be,
        too, where friction is large.
    steps
        Newton steps, which are linear systems of full size, in all.
    rounding
        Largest part of `unbalanced` that rounding alone may leave, N.
    jumps_at
        First instant that has no solution that continues from the instant before, as
        friction falls with slip faster than the structure unloads: what follows is
        another equilibrium, if any.
    is_lost
        Whether an instant that was tried is not solved.
    collapse
        From when on no contact forces balance the loads, where it is known that they do
        not.
    seconds
        Time that `reference_of` took.
    """

    problem: Problem
    displacement: Array
    deformation: Array
    contact_force: Array
    status: States
    unbalanced: float
    converged: NDArray[np.bool_]
    ambiguous: NDArray[np.bool_]
    steps: int
    rounding: float
    jumps_at: int | None = None
    is_lost: bool = False
    collapse: Collapse | None = None
    seconds: float = 0.0

    def contact(self, name: str) -> ContactFields:
        """Forces, status and motion of an interface with friction."""
        return self.contacts[name]

    @cached_property
    def contacts(self) -> dict[str, ContactFields]:
        """Fields of all interfaces with friction, by name."""
        problem = self.problem
        scale = problem.scales.displacement
        rows = self.displacement[problem.row_dofs] / scale
        return problem.contacts.fields(self.contact_force, rows, self.status, scale)


def fingerprint(problem: Problem) -> bytes:
    """Digest of the data of a problem that the incremental solvers read.

    So cuts count where degrees of freedom depend on them, as in the plane, and do not
    along a rod; the method never does. Problems that differ by rounding count as two.

    Raises
    ------
    NoReferenceError
        If a problem holds anything that they do not read.
    """
    force = external_force(problem)
    scales = problem.scales
    rules = rules_of(problem)
    laws = problem.contacts.laws
    stiffness = assembled_stiffness(problem)
    all_jumps = jumps(problem)
    # Equal matrices may store their entries in another order.
    stiffness.sort_indices()
    all_jumps.sort_indices()
    kinds = [f"{key} {law.opens} {law.is_on_support}" for key, law in laws.items()]
    of_jumps = [getattr(rules, name) for name in OF_JUMPS]
    positions = [law.positions for law in laws.values()]
    fields = [
        np.array(kinds),
        np.array(list(problem.contacts)),
        np.array([scales.displacement, scales.force, scales.time]),
        problem.instants,
        problem.positions,
        force,
        *problem.prescribed,
        *of_jumps,
        np.array([rules.slip_factor.slips, rules.slip_factor.factors]),
        *positions,
    ]
    if problem.rest is not None:
        fields.append(problem.rest)
    return content_of(*fields, stiffness, all_jumps)
