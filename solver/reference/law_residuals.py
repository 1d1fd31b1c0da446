"""Residuals of all laws: violations of equilibrium and of the laws of contact.

Nothing here depends on how the fields were found, nor on the data that incremental
solvers make of a problem: forces inside are those of each substructure, and the law of
every contact point is checked in full, from the first instant to the last.

Laws that say "one of two is zero" are measured by the smaller of both, each as a share
of its own size: no stiffness has to make a force of a length.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import astuple, dataclass, fields
from typing import Any

import numpy as np

from solver.arrays import Array, Flags, Indices, largest_size
from solver.discrete.problem import Problem
from solver.laws import Contact, Dirichlet, Neumann, Perfect
from solver.laws.interface import Component
from solver.reference.distance import HIDDEN, Fields, force_size

ROUNDED = 1e-4
"""Share of the displacement, and of the length of a spring under the largest force,
that counts as a size of jumps: both leave rounding, and may be much larger."""
OPENED = 1e-9
"""Opening, as a share of the size of jumps, from which on a bond is broken for sure. Of
sides that just touch rounding leaves 1e-15; a belt that nothing presses yet had 3e-12,
where the engine took the bond as broken (both measured)."""
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
    interfaces = _interface_fields(problem, displacement, force, held)
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
        balance=_share(largest_size(*balance), size),
        held=_share(largest_size(displacement[held] - prescribed), length),
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


@dataclass(frozen=True)
class _InterfaceFields:
    """Fields at the points of an interface, shape (n_points, n_instants), scaled.

    Attributes
    ----------
    law
        Law of the interface.
    slider, friction
        Position of the slider, and the friction force on the body above.
    largest_jump
        Largest jump of the displacement, of all components.
    opening, pressing
        Distance of the sides with the compression between them, and the pressing force;
        None where the pressure is known.
    is_prescribed
        Whether the normal jump is prescribed, so that the pressing force is not
        determinate, shape (n_points,).
    """

    law: Contact
    slider: Array
    friction: Array
    largest_jump: float
    opening: Array | None
    pressing: Array | None
    is_prescribed: Flags

    def across(self, length_size: float, force_size: float) -> Array:
        """Violation of Signorini's law at points of unknown jump, (n, n_instants)."""
        if self.opening is None or self.pressing is None:
            return np.zeros(0)
        pressing = _share(self.pressing, force_size)
        opening = _share(self.opening, length_size)
        # One of both is zero, and none is negative: so the smaller one is zero.
        violation = np.abs(np.minimum(pressing, opening))
        return np.asarray(violation[~self.is_prescribed])

    def along(self, length_size: float, force_size: float) -> Array:
        """Violation of Coulomb's law at points of known pressure, (n, n_instants)."""
        if_kept = self._violation(OPENED * length_size, length_size, force_size)
        if_broken = self._violation(0.0, length_size, force_size)
        # An opening within rounding may break a bond or not: at each point the better
        # case counts, for all instants.
        is_less = np.max(if_broken, axis=1) < np.max(if_kept, axis=1)
        violation = np.where(is_less[:, None], if_broken, if_kept)
        return np.asarray(violation[~self.is_prescribed])

    def _violation(self, far: float, length_size: float, force_size: float) -> Array:
        """Violation of Coulomb's law, (n, n_instants); `far` as for `_bound`."""
        slip = self._slip
        bound = self._bound(slip, far)
        excess = _share(np.maximum(np.abs(self.friction) - bound, 0.0), force_size)
        # A point that slips has all of its bound against its motion: either the slip or
        # what lacks to that force is zero.
        slipped = _share(np.abs(slip), length_size)
        lacking = _share(np.abs(self.friction + np.sign(slip) * bound), force_size)
        return np.asarray(np.maximum(excess, np.minimum(slipped, lacking)))

    @property
    def _slip(self) -> Array:
        """Motion of the slider since the instant before, (n_points, n_instants)."""
        start = self.law.tangential.start
        before: Array | float = 0.0
        if start is not None:
            before = self.law.mean_by_point(start)[:, None]
        return np.diff(self.slider, axis=1, prepend=before)

    def _bound(self, slip: Array, far: float) -> Array:
        """Largest friction force g(s) min(r + mu N, cap), (n_points, n_instants).

        Sides are open that are farther apart than `far`, scaled.
        """
        law = self.law
        along = self.law.tangential
        bound = law.by_point(along.bound) * np.ones_like(slip)
        if self.opening is not None and self.pressing is not None:
            is_open = (self.opening > far) & (self.pressing <= 0.0)
            # A bond that has opened once is gone for good.
            bound[np.logical_or.accumulate(is_open, axis=1)] = 0.0
            friction = law.mean_by_point(along.friction)[:, None]
            bound += friction * np.maximum(self.pressing, 0.0)
            if along.cap is not None:
                bound = np.minimum(bound, law.by_point(along.cap)[:, None])
        if along.slip_factor is not None:
            accumulated = np.cumsum(np.abs(slip), axis=1)
            bound *= along.slip_factor(accumulated)
        return np.asarray(bound)


def _interface_fields(
    problem: Problem, displacement: Array, force: Array, held: Indices
) -> list[_InterfaceFields]:
    """Fields of every interface with contact.

    By displacements (n_dofs, n_instants) and contact forces (n_forces, n_instants),
    scaled, and degrees of freedom of prescribed displacement, (n_held,).
    """
    found = []
    for name, law in problem.contacts.items():
        slices = problem.contacts.forces[name]
        friction = force[slices[-1]]
        jump = _jump(problem, law, law.tangent, displacement)
        largest = largest_size(jump)
        opening = None
        pressing = None
        is_prescribed = np.zeros(len(law.positions), dtype=bool)
        if law.normal is not None:
            pressing = force[slices[0]]
            across = _jump(problem, law, law.normal.component, displacement)
            largest = max(largest, largest_size(across))
            opening = across + law.mean_by_point(law.normal.gap)[:, None]
            opening = _with_spring(law, opening, pressing, law.normal.compliance)
            is_prescribed[law.points] = _is_held(problem, law.normal.component, held)
        fields = _InterfaceFields(
            law=law,
            slider=_with_spring(law, jump, friction, law.tangential.compliance),
            friction=friction,
            largest_jump=largest,
            opening=opening,
            pressing=pressing,
            is_prescribed=is_prescribed,
        )
        found.append(fields)
    return found


def _with_spring(
    law: Contact, jump: Array, force: Array, compliance: Array | None
) -> Array:
    """Jumps plus the elongation of springs in series, (n_points, n_instants), scaled.

    Jumps and forces have that shape; compliances, (n_pairs,), are None without springs.
    """
    if compliance is None:
        return jump
    return np.asarray(jump + law.in_parallel(compliance)[:, None] * force)


def _jump(
    problem: Problem, law: Contact, component: Component, displacement: Array
) -> Array:
    """Displacement above minus that below at points, shape (n_points, n_instants)."""
    jump = displacement[problem.row_dofs[component.above]]
    if component.below is not None:
        jump = jump - displacement[problem.row_dofs[component.below]]
    return law.mean_by_point(jump)


def _is_held(problem: Problem, component: Component, held: Indices) -> Flags:
    """Mask of pairs with prescribed jump, (n_pairs,), from held dofs, (n_held,)."""
    given = [np.isin(problem.row_dofs[side], held) for side in component.sides]
    return np.asarray(np.logical_and.reduce(given))


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
            shares = _share(apart, length_size), _share(unbalanced, force_size)
            largest = float(np.maximum(largest, largest_size(*shares)))
    return largest


def _share(value: Array | float, size: float) -> Any:
    """A value over a size; the value itself where the size is zero."""
    if size > 0.0:
        return value / size
    return value
