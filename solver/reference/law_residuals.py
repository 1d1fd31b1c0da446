"""Residuals of all laws: violations of equilibrium and of the laws of contact.

Nothing here depends on how the fields were found, nor on the data that incremental
solvers make of a problem: forces inside are those of each substructure, and the law of
every contact point is checked in full (`solver.reference.contact_residuals`), from the
first instant to the last.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import astuple, dataclass, fields

import numpy as np

from solver.arrays import Array, Indices, largest_size
from solver.discrete.problem import Problem
from solver.laws import Contact, Dirichlet, Neumann, Perfect
from solver.reference.contact_residuals import interface_fields, share_of
from solver.reference.distance import HIDDEN, Fields, force_size

ROUNDED = 1e-4
"""Share of the displacement, and of the length of a spring under the largest force,
that counts as a size of jumps: both leave rounding, and may be much larger."""
KNOWN = Contact, Dirichlet, Neumann, Perfect
"""Laws that are checked."""


@dataclass(frozen=True)
class LawResiduals:
    """Largest violation of every kind of law over all points and instants.

    Forces are a share of `force_size`; lengths a share of the largest jump, or of
    `ROUNDED` of the displacement or of the softest spring's length where that is more,
    or of what the largest force does to the stiffest body: to mend a length that is
    shorter takes a force of a smaller share.

    Attributes
    ----------
    balance
        Violation of the balance of all forces at each free degree of freedom.
    held
        Violation of prescribed displacements.
    glued
        Violation at cuts: both sides have equal displacements and opposite forces.
    pressing
        Violation of Signorini's law: no tension, no overlap, no force at a distance.
    friction
        Violation of Coulomb's law: no force above its bound, no slip below it, none
        along the force.
    """

    balance: float
    held: float
    glued: float
    pressing: float
    friction: float

    @property
    def largest(self) -> float:
        """Largest of all violations; NaN if any is NaN."""
        return float(np.max(astuple(self)))

    @property
    def worst(self) -> str:
        """Kind of the law whose violation is the largest."""
        names = [field.name for field in fields(self)]
        return names[int(np.argmax(astuple(self)))]


@dataclass(frozen=True)
class RowFields:
    """Fields of both sides of every interface, shape (n_rows, n_instants), scaled."""

    displacement: Array
    force: Array


def law_residuals(
    answer: Fields,
    problem: Problem,
    rows: RowFields | None = None,
) -> LawResiduals:
    """Measure the violation of all laws of a problem by fields.

    Parameters
    ----------
    answer
        Displacements and contact forces of the whole structure, SI.
    problem
        Problem that the fields should solve.
    rows
        Fields of both sides of every interface, of an answer that has them: with these
        the balance of each substructure and the cuts are checked, too.

    Raises
    ------
    TypeError
        For an interface whose law is not one of the engine's.
    """
    _check_known(problem)
    displacement = answer.displacement / problem.scales.displacement
    force = answer.contact_force / problem.scales.force
    held, prescribed = _prescribed(problem)
    deformation = _deformation(problem, displacement)
    missing, size = _missing_force(problem, displacement, deformation, force, held)
    interfaces = interface_fields(problem, displacement, force, held)
    length = ROUNDED * max(largest_size(displacement), size * _softest(problem))
    length = max(length, size / _stiffest(problem))
    length = max([length] + [each.largest_jump for each in interfaces])

    balance = [np.delete(missing, held, axis=0)]
    glued = 0.0
    if rows is not None:
        balance += _balance_of_parts(problem, deformation, rows.force)
        glued = _glued(problem, rows, length, size)
    across = [each.across(length, size) for each in interfaces]
    along = [each.along(length, size) for each in interfaces]
    return LawResiduals(
        balance=share_of(largest_size(*balance), size),
        held=share_of(largest_size(displacement[held] - prescribed), length),
        glued=glued,
        pressing=largest_size(*across),
        friction=largest_size(*along),
    )


def _missing_force(
    problem: Problem,
    displacement: Array,
    deformation: Array,
    force: Array,
    held: Indices,
) -> tuple[Array, float]:
    """Unbalanced force, (n_dofs, n_instants), and size of the forces; scaled.

    `displacement` and `deformation` have shape (n_dofs, n_instants), `force`
    (n_forces, n_instants); at the degrees of freedom `held`, (n_held,), the support
    gives what is lacking.
    """
    outer = _outer_force(problem)
    inner, elastic = _inner_force(problem, displacement, deformation)
    missing = inner - outer - _contact_force(problem, force)
    return missing, force_size(force, outer, elastic, missing[held], HIDDEN)


def _softest(problem: Problem) -> float:
    """Largest compliance of springs in series with contacts, scaled; 0 without any."""
    springs = []
    for law in problem.contacts.values():
        springs.append(law.in_parallel(law.tangential.compliance))
        if law.normal is not None:
            springs.append(law.in_parallel(law.normal.compliance))
    return largest_size(*springs)


def _stiffest(problem: Problem) -> float:
    """Largest stiffness of bodies at a degree of freedom, scaled."""
    parts = {id(part.elasticity): part.elasticity for part in problem.substructures}
    diagonals = [elasticity.stiffness.diagonal() for elasticity in parts.values()]
    return largest_size(*diagonals)


def _check_known(problem: Problem) -> None:
    """Refuse interfaces of unknown laws, whose violation cannot be measured."""
    for name, law in problem.interfaces.items():
        if name in problem.user_laws or not isinstance(law, KNOWN):
            kind = type(law).__name__
            raise TypeError(f"the law of {name}, {kind}, is not known here")


def _contact_force(problem: Problem, force: Array) -> Array:
    """Forces of contacts on all degrees of freedom, shape (n_dofs, n_instants)."""
    total = np.zeros((problem.n_dofs, problem.n_instants))
    for name, law in problem.contacts.items():
        pairs = np.bincount(law.points)[law.points]
        slices = problem.contacts.forces[name]
        for stacked, component in zip(slices, law.components, strict=True):
            # The pairs of a point share its force, which acts on both sides oppositely.
            carried = force[stacked][law.points] / pairs[:, None]
            for side, sign in zip(component.sides, (1.0, -1.0), strict=False):
                np.add.at(total, problem.row_dofs[side], sign * carried)
    return total


def _outer_force(problem: Problem) -> Array:
    """Body forces and given forces on all degrees of freedom, (n_dofs, n_instants)."""
    total = np.zeros((problem.n_dofs, problem.n_instants))
    for part in problem.substructures:
        if part.body_force is not None:
            np.add.at(total, part.dofs, part.body_force)
    for law in problem.interfaces.values():
        if isinstance(law, Neumann):
            np.add.at(total, problem.row_dofs[law.rows], law.values)
    return total


def _inner_force(
    problem: Problem, displacement: Array, deformation: Array
) -> tuple[Array, Array]:
    """Elastic forces of all substructures, and sums of the sizes of their terms.

    Both have the shape (n_dofs, n_instants).
    """
    total = np.zeros((problem.n_dofs, problem.n_instants))
    sizes = np.zeros_like(total)
    for part in problem.substructures:
        stiffness = part.elasticity.stiffness
        np.add.at(total, part.dofs, stiffness @ deformation[part.dofs])
        moved = np.abs(displacement[part.dofs])
        np.add.at(sizes, part.dofs, abs(stiffness) @ moved)
    return total, sizes


def _deformation(problem: Problem, displacement: Array) -> Array:
    """Displacement without rigid motions of bodies, (n_dofs, n_instants), scaled.

    These strain nothing, but the stiffness of a slender body makes forces of their
    rounding: of bricks 228 times as long as high 3e-8 of what acted (measured).
    """
    motions = problem.rigid_motions
    if motions is None:
        return displacement
    shares = np.linalg.lstsq(motions, displacement)[0]
    return np.asarray(displacement - motions @ shares)


def _prescribed(problem: Problem) -> tuple[Indices, Array]:
    """Held degrees of freedom, (n,), and their displacements, (n, n_instants), scaled.

    A degree of freedom that several rows hold is there several times.
    """
    dofs = [np.zeros(0, dtype=np.intp)]
    values = [np.zeros((0, problem.n_instants))]
    for law in problem.interfaces.values():
        if isinstance(law, Dirichlet):
            dofs.append(problem.row_dofs[law.rows])
            values.append(law.values)
    return np.concatenate(dofs), np.concatenate(values)


def _balance_of_parts(
    problem: Problem, deformation: Array, force: Array
) -> Iterator[Array]:
    """Yield unbalanced forces of every substructure, (n_dofs, n_instants), scaled.

    By deformations (n_dofs, n_instants) of the structure, and forces of all rows
    (n_rows, n_instants).
    """
    for part in problem.substructures:
        missing = np.asarray(part.elasticity.stiffness @ deformation[part.dofs])
        if part.body_force is not None:
            missing = missing - part.body_force
        np.subtract.at(missing, part.elasticity.trace, force[part.rows])
        yield missing


def _glued(
    problem: Problem, rows: RowFields, length_size: float, force_size: float
) -> float:
    """Largest gap, or largest sum of the forces on both sides, of cuts, as a share."""
    largest = 0.0
    for law in problem.interfaces.values():
        if isinstance(law, Perfect):
            apart = rows.displacement[law.first] - rows.displacement[law.second]
            unbalanced = rows.force[law.first] + rows.force[law.second]
            shares = share_of(apart, length_size), share_of(unbalanced, force_size)
            largest = float(np.maximum(largest, largest_size(*shares)))
    return largest
