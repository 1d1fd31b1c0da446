"""Condensation of a structure to its contacts: stiffness and load of all jumps.

With J the jumps of the displacement (above minus below), the displacement u under
contact forces f is that of K u = F + J' f. It is u = T j + Z a
(`solver.reference.glued`): with jumps j, and a of the structure glued at its contacts.
So S jump = f + q (MATHEMATICS.md, 6), if only the structure, glued at its contacts,
is held. Jumps and forces are stacked as `Problem.sum_of_contact` says. S is made by
`solver.reference.glued_structure`, and q here.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from solver.arrays import ROUNDING, Array, Indices, separated
from solver.cache import CACHE, content_of
from solver.discrete.problem import Problem
from solver.reference.assembly import assembled_stiffness, external_force, jumps, never
from solver.reference.glued_structure import GluedStructure, free_dofs
from solver.reference.rules import rules_of

LEFT_INSIDE = 4.0 * ROUNDING
"""Share of the forces inside elements that rounding of the displacements leaves."""

BLURRED = 1e-5
"""Share of the forces up to which forces out of balance may be rounding: forces in
elements of slender bodies are 1e7 times those of contact."""


class Condensation:
    """The structure between its contacts, condensed to the jumps that are unknown.

    Jumps that prescribed displacements alone make are known.

    Attributes
    ----------
    moving
        Places of the unknown jumps in the stack, shape (n_moving,).
    base, ties
        Places among these of the jumps from which all follow, shape (n_base,); and the
        matrix by which they follow, shape (n_moving, n_base).
    stiffness
        S between the base, shape (n_base, n_base), symmetric, scaled.
    load
        q of the base, shape (n_base, n_instants), scaled.
    springs
        Stiffness of each pair by the elements beside it, shape (n_base,), scaled.
    motions, gauge
        Rigid motions that no support holds, shape (n_dofs, n_motions), and the jumps Q
        of the base that they make, shape (n_base, n_motions).
    stresses, tie
        Forces that move nothing, where jumps of the base depend on each other, shape
        (n_base, n_stresses); and the stiffness in S that keeps the jumps from coming
        apart along them, scaled.
    all_rules, rules
        Rules of all jumps, and of the unknown ones.
    given
        Jumps that prescribed displacements make, shape (n_forces, n_instants), scaled;
        final where a jump is not unknown.
    """

    def __init__(self, problem: Problem, stop: Callable[[], bool] = never) -> None:
        """Condense a problem.

        Raises
        ------
        Interrupted
            As soon as `stop` returns True; it is asked now and then.
        NoReferenceError
            If the structure can move with all contacts closed and stuck.
        """
        self._fixed, self._prescribed = problem.prescribed
        self._free = free_dofs(problem)
        self._whole = assembled_stiffness(problem)
        self._force = external_force(problem)
        self._jumps = jumps(problem)
        self.all_rules = rules_of(problem)
        self.given: Array = self._jumps[:, self._fixed] @ self._prescribed
        free_jumps = self._jumps[:, self._free]
        self.moving: Indices = np.flatnonzero(np.diff(free_jumps.indptr))
        self.rules = self.all_rules.kept(self.moving)
        self._glued = self._glued_structure(problem, stop)
        self.base = self._glued.base
        self.ties = self._glued.ties
        self.stiffness = self._glued.stiffness
        self.springs = self._glued.springs
        self.motions = self._glued.motions
        self.gauge = self._glued.gauge
        self.stresses = self._glued.stresses
        self.tie = self._glued.tie
        self._condense_load()

    def _glued_structure(
        self, problem: Problem, stop: Callable[[], bool]
    ) -> GluedStructure:
        """Structure glued at its contacts, from an earlier run if nothing changed."""
        moving = self._jumps[self.moving]
        rigid = self.rules.compliance == 0.0
        given = self.given[self.moving]
        key = (
            "glued",
            problem.content_of_bodies,
            problem.content_of_stiffness,
            content_of(self._fixed, moving, rigid, given),
        )
        return CACHE.get(
            key,
            lambda: GluedStructure(problem, self._whole, moving, rigid, given, stop),
        )

    def _condense_load(self) -> None:
        """Condense the load of the free degrees of freedom to the base."""
        glued = self._glued
        pushed = self._whole[self._free][:, self._fixed] @ self._prescribed
        load = self._force[self._free] - pushed
        # The few patterns of the load are solved for, not its many instants.
        patterns, courses = separated(load)
        self._alone = glued.solved(glued.glued.T @ patterns) @ courses
        load = glued.jumped.T @ load - glued.pulled.T @ self._alone
        self.load: Array = glued.balanced(load) + glued.given_force
        if self.gauge.size:
            # The resultant of the loads is known exactly, without condensation.
            resultant = self.motions.T @ self._force
            self.load += self.gauge @ (resultant - self.gauge.T @ self.load)

    @cached_property
    def shift(self) -> Array:
        """Jumps by prescribed displacements that do not follow from the base.

        Shape (n_moving, n_instants), scaled.
        """
        return np.asarray(self.given[self.moving] - self.ties @ self._glued.given)

    def deformation(self, strained: Array) -> Array:
        """Displacements without rigid motions by jumps y of the base.

        Shape (n_dofs, n_instants) by y of shape (n_base, n_instants), scaled.
        """
        displacement = np.empty_like(self._force)
        displacement[self._fixed] = self._prescribed
        jumped = self._glued.balanced(strained - self._glued.given)
        glued = self._alone - self._glued.solved(self._glued.pulled @ jumped)
        displacement[self._free] = (
            self._glued.jumped @ jumped + self._glued.glued @ glued
        )
        return displacement

    def jump(self, displacement: Array) -> Array:
        """Jumps (n_forces, n_instants) of a displacement (n_dofs, n_instants)."""
        return np.asarray(self._jumps @ displacement)

    def unbalanced(self, deformation: Array, force: Array) -> Array:
        """Forces out of balance, (n_free, n_instants), without those of supports.

        Parameters
        ----------
        deformation
            Displacements without rigid motions, shape (n_dofs, n_instants), scaled.
        force
            Forces of all contacts, shape (n_forces, n_instants), scaled.
        """
        outer = self._force + self._jumps.T @ force
        return np.asarray((self._whole @ deformation - outer)[self._free])

    def inside(self, deformation: Array) -> float:
        """Largest sum of the sizes of forces inside elements at a node, scaled.

        By displacements without rigid motions, shape (n_dofs, n_instants), scaled.
        """
        # Sizes without signs: forces cancel at a degree of freedom, their rounding does
        # not.
        forces = abs(self._whole) @ np.abs(deformation)
        return float(forces.max(initial=0.0))

    def rounding(self, deformation: Array, motion: Array, size: float) -> float:
        """Largest unbalanced force by rounding alone, scaled.

        The forces inside a slender body are far larger than those that act on it.
        Springs and closing contacts depend on how far a body has moved, too: there
        rounding of the rigid motion deforms the body, by no more than a small share of
        the largest force.

        Parameters
        ----------
        deformation, motion
            Displacements without rigid motions, and these, shape (n_dofs, n_instants),
            scaled.
        size
            Largest force, scaled.
        """
        inside = self.inside(deformation)
        moved = self.unit[:, None] * np.abs(self.jump(motion))
        sprung = moved[self.all_rules.compliance > 0.0]
        left = LEFT_INSIDE * max(inside, sprung.max(initial=0.0))
        blurred = min(LEFT_INSIDE * moved.max(initial=0.0), BLURRED * size)
        return float(max(left, blurred))

    @cached_property
    def unit(self) -> Array:
        """Stiffness of every jump with its spring in series, (n_forces,), scaled."""
        unit = np.ones(len(self.all_rules.gap))
        springs = abs(self.ties) @ self.springs
        unit[self.moving] = springs / (1.0 + springs * self.rules.compliance)
        return unit

    @cached_property
    def largest_force(self) -> float:
        """Largest force of loads and prescribed displacements on a degree of freedom.

        Where there are none, the largest force that closes bodies which overlap from
        the start, scaled.
        """
        pushed = self._whole[:, self._fixed] @ self._prescribed
        largest = max(
            np.abs(self._force).max(initial=0.0), np.abs(pushed).max(initial=0.0)
        )
        overlap = np.maximum(-self.all_rules.gap, 0.0)
        return float(largest or (self.unit * overlap).max(initial=0.0))
