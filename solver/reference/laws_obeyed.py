"""Residuals of all laws: how far fields are from balance and the laws of contact.

Nothing here depends on how the fields were found, nor on what incremental solvers make
of a problem: forces inside are those of each substructure, and every contact point is
asked for its law in full, from the first instant to the last.

Laws that say "one of two is zero" are measured by the smaller of both, each as a share
of its own size: no stiffness has to make a force of a length.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import astuple, dataclass, fields
from typing import Any

import numpy as np

from solver.arrays import Array, Flags, Indices
from solver.discrete.problem import Problem
from solver.laws import Contact, Dirichlet, Neumann, Perfect
from solver.laws.interface import Component
from solver.reference.distance import HIDDEN, Fields, force_size

ROUNDED = 1e-4
"""Share of the displacement that counts as a size of jumps: it leaves rounding, and may
be much larger."""
OPENED = 1e-9
"""Opening, as a share of the largest, from which on a bond is broken."""
KNOWN = Contact, Dirichlet, Neumann, Perfect


@dataclass(frozen=True)
class LawResiduals:
    """The largest violation of every kind of law over all places and instants.

    Forces are a share of `force_size`; lengths a share of the largest jump, or of
    `ROUNDED` of the displacement where that is more.

    Attributes
    ----------
    balance
        Of all forces at each degree of freedom that is free.
    held
        Displacements that are prescribed.
    glued
        Both sides of the cuts: displacements that are equal, forces that are opposite.
    pressing
        Signorini's law: no tension, no overlap, no force at a distance.
    friction
        Coulomb's law: no force above its bound, no slip below it, none along the force.
    """

    balance: float
    held: float
    glued: float
    pressing: float
    friction: float

    @property
    def largest(self) -> float:
        """The largest of all; NaN where one is."""
        return float(np.max(astuple(self)))

    @property
    def worst(self) -> str:
        """The kind of law whose violation is the largest."""
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
    """Measure how far fields are from all laws of a problem.

    Parameters
    ----------
    answer
        Displacements and contact forces of the whole structure, SI.
    problem
        What they are to solve.
    rows
        Fields of both sides of every interface, of an answer that has them: with these
        the balance is also that of each substructure, and cuts are asked.

    Raises
    ------
    TypeError
        For an interface whose law is not one of the engine's.
    """
    _check_known(problem)
    displacement = answer.displacement / problem.scales.displacement
    force = answer.contact_force / problem.scales.force
    outer = _outer_force(problem)
    inner, elastic = _inner_force(problem, displacement)
    held, prescribed = _prescribed(problem)
    missing = inner - outer - _contact_force(problem, force)
    size = force_size(force, outer, elastic, missing[held], HIDDEN)
    points = list(_points(problem, displacement, force))
    jumps = [jump for point in points for jump in point.jumps]
    length_size = _largest(*jumps, ROUNDED * displacement)

    balance = [np.delete(missing, held, axis=0)]
    glued = 0.0
    if rows is not None:
        balance += _balance_of_parts(problem, displacement, rows.force)
        glued = _glued(problem, rows, length_size, size)
    return LawResiduals(
        balance=_share(_largest(*balance), size),
        held=_share(_largest(displacement[held] - prescribed), length_size),
        glued=glued,
        pressing=_largest(*(point.across(length_size, size) for point in points)),
        friction=_largest(*(point.along(length_size, size) for point in points)),
    )


def _check_known(problem: Problem) -> None:
    """Refuse interfaces whose law is none of the engine's: they would count as obeyed."""
    for name, law in problem.interfaces.items():
        if name in problem.own_laws or not isinstance(law, KNOWN):
            kind = type(law).__name__
            raise TypeError(f"the law of {name}, {kind}, is not known here")


@dataclass(frozen=True)
class _Points:
    """Points of an interface: jumps and forces, shape (n_points, n_instants), scaled.

    Attributes
    ----------
    law
        Law of the interface.
    slider, friction
        Position of the slider, and the friction force on the body above.
    opening, pressing
        Distance of the sides with the compression between them, and the pressing force;
        None where the pressure is known.
    jumps
        Jumps of the displacement, of all components.
    is_given
        Whether the normal jump is prescribed, so that nothing says how much a point
        carries, shape (n_points,).
    """

    law: Contact
    slider: Array
    friction: Array
    opening: Array | None
    pressing: Array | None
    jumps: tuple[Array, ...]
    is_given: Flags

    def across(self, length_size: float, force_size: float) -> Array:
        """Violation of Signorini's law at points whose jump is not prescribed."""
        if self.opening is None or self.pressing is None:
            return np.zeros(0)
        pressing = _share(self.pressing, force_size)
        opening = _share(self.opening, length_size)
        # One of both is zero, and none is negative: so the smaller one is zero.
        broken = np.abs(np.minimum(pressing, opening))
        return np.asarray(broken[~self.is_given])

    def along(self, length_size: float, force_size: float) -> Array:
        """Violation of Coulomb's law at points whose pressing force is known."""
        slip = self._slip
        bound = self._bound(slip)
        excess = _share(np.maximum(np.abs(self.friction) - bound, 0.0), force_size)
        # What slips has all of its bound against its way; so either is zero.
        slipped = _share(np.abs(slip), length_size)
        missing = _share(np.abs(self.friction + np.sign(slip) * bound), force_size)
        broken = np.maximum(excess, np.minimum(slipped, missing))
        return np.asarray(broken[~self.is_given])

    @property
    def _slip(self) -> Array:
        """Way of the slider from the instant before, shape (n_points, n_instants)."""
        start = self.law.tangential.start
        before: Array | float = 0.0
        if start is not None:
            before = self.law.mean_by_point(start)[:, None]
        return np.diff(self.slider, axis=1, prepend=before)

    def _bound(self, slip: Array) -> Array:
        """Largest friction force g(s) min(r + mu N, cap), (n_points, n_instants)."""
        law = self.law
        along = self.law.tangential
        bound = law.by_point(along.bound) * np.ones_like(slip)
        if self.opening is not None and self.pressing is not None:
            far = OPENED * _largest(self.opening)
            is_open = (self.opening > far) & (self.pressing <= 0.0)
            # A bond that has opened once is gone for good.
            bound[np.logical_or.accumulate(is_open, axis=1)] = 0.0
            friction = law.mean_by_point(along.friction)[:, None]
            bound += friction * np.maximum(self.pressing, 0.0)
            if along.cap is not None:
                bound = np.minimum(bound, law.by_point(along.cap)[:, None])
        if along.strength is not None:
            accumulated_slip = np.cumsum(np.abs(slip), axis=1)
            bound *= np.interp(
                accumulated_slip, along.strength.slips, along.strength.factors
            )
        return np.asarray(bound)


def _points(problem: Problem, displacement: Array, force: Array) -> Iterator[_Points]:
    """Yield the points of every interface with contact."""
    held, _ = _prescribed(problem)
    for name, law in problem.rubbing.items():
        places = problem.rubbing.forces[name]
        friction = force[places[-1]]
        slider = jump = _jump(problem, law, law.tangent, displacement)
        if law.tangential.compliance is not None:
            slider = (
                jump + law.in_parallel(law.tangential.compliance)[:, None] * friction
            )
        opening = pressing = None
        is_given = np.zeros(len(law.positions), dtype=bool)
        jumps = [jump]
        if law.normal is not None:
            pressing = force[places[0]]
            across = _jump(problem, law, law.normal.component, displacement)
            jumps.append(across)
            opening = across + law.mean_by_point(law.normal.gap)[:, None]
            if law.normal.compliance is not None:
                opening += law.in_parallel(law.normal.compliance)[:, None] * pressing
            is_given[law.points] = _is_held(problem, law.normal.component, held)
        yield _Points(law, slider, friction, opening, pressing, tuple(jumps), is_given)


def _jump(
    problem: Problem, law: Contact, component: Component, displacement: Array
) -> Array:
    """Displacement above minus that below at points, shape (n_points, n_instants)."""
    jump = displacement[problem.row_dofs[component.above]]
    if component.below is not None:
        jump = jump - displacement[problem.row_dofs[component.below]]
    return law.mean_by_point(jump)


def _is_held(problem: Problem, component: Component, held: Indices) -> Flags:
    """Whether the jump of every pair is prescribed, shape (n_pairs,)."""
    given = [np.isin(problem.row_dofs[side], held) for side in component.sides]
    return np.asarray(np.logical_and.reduce(given))


def _contact_force(problem: Problem, force: Array) -> Array:
    """Forces of contacts on all degrees of freedom, shape (n_dofs, n_instants)."""
    total = np.zeros((problem.n_dofs, problem.n_instants))
    for name, law in problem.rubbing.items():
        pairs = np.bincount(law.points)[law.points]
        for place, component in zip(
            problem.rubbing.forces[name], law.components, strict=True
        ):
            carried = force[place][law.points] / pairs[:, None]
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


def _inner_force(problem: Problem, displacement: Array) -> tuple[Array, Array]:
    """Forces that strain all substructures, and sums of their parts without signs.

    Both have the shape (n_dofs, n_instants).
    """
    total = np.zeros((problem.n_dofs, problem.n_instants))
    sizes = np.zeros_like(total)
    for part in problem.substructures:
        own = displacement[part.dofs]
        stiffness = part.elasticity.stiffness
        np.add.at(total, part.dofs, stiffness @ own)
        np.add.at(sizes, part.dofs, abs(stiffness) @ np.abs(own))
    return total, sizes


def _prescribed(problem: Problem) -> tuple[Indices, Array]:
    """Degrees of freedom that are held, (n,), and where, (n, n_instants); some twice."""
    given = [law for law in problem.interfaces.values() if isinstance(law, Dirichlet)]
    dofs = [problem.row_dofs[law.rows] for law in given]
    values = [law.values for law in given]
    return (
        np.concatenate([np.zeros(0, dtype=np.intp), *dofs]),
        np.concatenate([np.zeros((0, problem.n_instants)), *values]),
    )


def _balance_of_parts(
    problem: Problem, displacement: Array, force: Array
) -> Iterator[Array]:
    """Yield what every substructure lacks to balance, with the forces of its rows."""
    for part in problem.substructures:
        missing = np.asarray(part.elasticity.stiffness @ displacement[part.dofs])
        if part.body_force is not None:
            missing = missing - part.body_force
        np.subtract.at(missing, part.elasticity.trace, force[part.rows])
        yield missing


def _glued(
    problem: Problem, rows: RowFields, length_size: float, force_size: float
) -> float:
    """Difference of the two sides of all cuts, and the sum of their forces, as shares."""
    largest = 0.0
    for law in problem.interfaces.values():
        if isinstance(law, Perfect):
            apart = rows.displacement[law.first] - rows.displacement[law.second]
            both = rows.force[law.first] + rows.force[law.second]
            largest = _largest(
                np.array(largest), _share(apart, length_size), _share(both, force_size)
            )
    return largest


def _largest(*parts: Array) -> float:
    """The largest absolute value in all arrays; NaN where one is in them, 0 of none."""
    sizes = [float(np.abs(part).max(initial=0.0)) for part in parts]
    return float(np.max(sizes, initial=0.0))


def _share(value: Array | float, size: float) -> Any:
    """A value as a share of a size; as it is where that is zero."""
    if size > 0.0:
        return value / size
    return value
