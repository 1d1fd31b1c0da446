"""Residuals of the laws of contact: violations of Signorini's and Coulomb's laws.

Laws that say "one of two is zero" are measured by the smaller of both, each as a share
of its own size: no stiffness has to make a force of a length.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from solver.arrays import Array, Flags, Indices, largest_size
from solver.discrete.problem import Problem
from solver.laws import Contact
from solver.laws.interface import Component

OPENED = 1e-9
"""Opening, as a share of the size of jumps, from which on a bond is broken for sure. Of
sides that just touch rounding leaves 1e-15; a belt that nothing presses yet had 3e-12,
where the engine took the bond as broken (both measured)."""


@dataclass(frozen=True)
class JudgedFields:
    """Fields at the points of an interface that its laws judge, scaled.

    Shape (n_points, n_instants).

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
        pressing = share_of(self.pressing, force_size)
        opening = share_of(self.opening, length_size)
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
        excess = share_of(np.maximum(np.abs(self.friction) - bound, 0.0), force_size)
        # A point that slips has all of its bound against its motion: either the slip or
        # what lacks to that force is zero.
        slipped = share_of(np.abs(slip), length_size)
        lacking = share_of(np.abs(self.friction + np.sign(slip) * bound), force_size)
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


def interface_fields(
    problem: Problem, displacement: Array, force: Array, held: Indices
) -> list[JudgedFields]:
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
        fields = JudgedFields(
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


def share_of(value: Array | float, size: float) -> Any:
    """A value over a size; the value itself where the size is zero."""
    if size > 0.0:
        return value / size
    return value
