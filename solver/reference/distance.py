"""Errors: how far fields are from a reference (MATHEMATICS.md, 4), and from their equations."""

from __future__ import annotations

from operator import truediv
from typing import Protocol

import numpy as np
from scipy import sparse

from solver.arrays import Array, Flags, Indices
from solver.discrete.problem import Problem
from solver.reference.assembly import assembled_stiffness, external_force, jumps
from solver.reference.glued import self_stresses
from solver.reference.rules import Rules, rules_of

VANISHING = 1e-8
"""Share of the load and of all that friction could carry below which contact forces
vanish."""
LEAST_SHARE = 0.01
"""Share of pressure and friction together that each of them counts as, at least:
friction that is next to nothing beside pressure has no digits that a run could find."""
ELASTIC = 1e-4
"""Share of the forces inside elements that counts like a contact force: they leave so
much more rounding. In slender bodies they are 1e5 times what acts on them."""
HIDDEN = 100.0
"""Largest size of forces over those that act, where displacements alone have to prove
an answer: a body that nothing holds may be far away, and leaves rounding that would
hide all that acts."""
NOTHING = 1e-12
"""Share of the forces inside elements up to which contact forces and reactions are but
rounding."""


class Fields(Protocol):
    """What is compared: an iterate, or a reference; SI."""

    @property
    def displacement(self) -> Array:
        """Displacement, shape (n_dofs, n_instants), m."""

    @property
    def contact_force(self) -> Array:
        """Nodal forces of all interfaces with friction, stacked, (n_forces, n_instants), N."""


class Distance:
    """Relative L2 distance over space and time to a reference on the same mesh and instants.

    Displacements are compared at interfaces. Where the reference field vanishes, the
    distance is relative to `load`, (n, n_instants), N, instead, and absolute if that
    vanishes too; contact forces vanish also if they are but rounding beside what
    friction could carry and beside the load. Both are compared where they are
    determinate.

    Attributes
    ----------
    force_size
        What distances of contact forces are divided by, the norm of the forces, N
        sqrt(s).
    """

    def __init__(self, reference: Fields, problem: Problem, load: Array) -> None:
        rules = rules_of(problem)
        self._weights = problem.time_weights
        self._determinate = determinate_forces(problem)
        self._held = held_instants(problem, reference.contact_force)
        self._dofs: Indices = np.unique(problem.row_dofs)
        self._displacement = reference.displacement[self._dofs] * self._held
        self._force = reference.contact_force * self._determinate
        self._displacement_size = self._norm(self._displacement) or 1.0
        force_size = self._norm(self._force)
        load_size = self._norm(load)
        bound = rules.bound * problem.scales.force
        allowed = self._norm(bound * np.ones(len(self._weights)))
        # Without a known bound it is the load alone that contact forces can vanish
        # beside.
        vanishes = force_size <= VANISHING * (min(load_size, allowed) or load_size)
        self.force_size = (load_size if vanishes else force_size) or 1.0
        self._kinds = [kind for kind in (rules.normal, ~rules.normal) if kind.any()]
        if vanishes:
            least = self.force_size
        else:
            least = LEAST_SHARE * self.force_size
        self._sizes = [
            max(self._norm(self._force[kind]), least) for kind in self._kinds
        ]

    def of_displacement(self, fields: Fields) -> float:
        """Relative error of the displacement."""
        difference = fields.displacement[self._dofs] * self._held - self._displacement
        return self._norm(difference) / self._displacement_size

    def of_friction_force(self, fields: Fields) -> float:
        """Relative error of the contact forces: of friction, or of pressure if larger.

        Each relative to its own norm; to `LEAST_SHARE` of both together where that is
        more.
        """
        difference = fields.contact_force * self._determinate - self._force
        errors = (self._norm(difference[kind]) for kind in self._kinds)
        return max(map(truediv, errors, self._sizes), default=0.0)

    def _norm(self, field: Array) -> float:
        largest = float(np.abs(field).max(initial=0.0))
        if largest == 0.0:
            return 0.0
        scaled = field / largest
        return largest * float(np.sqrt((scaled * scaled @ self._weights).sum()))


def distance_to(reference: Fields, problem: Problem) -> Distance:
    """Prepare the distance to a reference of a problem.

    Where no forces are given, those that move what is prescribed are the load; and
    where these are but rounding, because nothing resists, those that such
    displacements, and closing bodies that overlap, would cost elements.
    """
    forces = [given.values for given in problem.given_forces]
    forces += [
        part.body_force for part in problem.substructures if part.body_force is not None
    ]
    if not any(force.any() for force in forces):
        dofs, prescribed = problem.prescribed
        stiffness = assembled_stiffness(problem)
        moved = stiffness[dofs[prescribed.any(axis=1)]]
        forces = [moved @ reference.displacement / problem.scales.displacement]
        overlaps = abs(jumps(problem)).T @ np.maximum(-rules_of(problem).gap, 0.0)
        elements = abs(stiffness[:, dofs]) @ np.abs(prescribed)
        elements += (abs(stiffness) @ overlaps)[:, None]
        if np.abs(forces[0]).max(initial=0.0) <= VANISHING * elements.max(initial=0.0):
            forces = [elements]
    load = np.concatenate([*forces, np.zeros((1, problem.n_instants))])
    return Distance(reference, problem, load * problem.scales.force)


def held_instants(problem: Problem, contact_force: Array) -> Flags:
    """Instants at which contact forces determine where all bodies are, shape (n_instants,).

    A body that contact alone holds may lie anywhere along a rigid motion that neither
    goes against a contact that presses nor rubs: without friction, on level ground.
    Until contacts first carry anything it is at rest. Forces are stacked, (n_forces,
    n_instants), N.
    """
    held = np.ones(problem.n_instants, dtype=bool)
    if problem.motions is None:
        return held
    rules = rules_of(problem)
    force = contact_force / problem.scales.force
    small = VANISHING * np.abs(force).max(initial=0.0)
    force = np.where(force > small, force, 0.0)
    bound = rules.bounds(force, np.zeros_like(force))
    holds = np.where(rules.normal[:, None], force, bound) > 0.0
    moved = jumps(problem) @ problem.motions
    patterns, kind = np.unique(holds, axis=1, return_inverse=True)
    sure = [
        np.linalg.matrix_rank(moved[pattern]) == moved.shape[1]
        for pattern in patterns.T
    ]
    at_rest = ~np.logical_or.accumulate(holds.any(axis=0))
    return np.asarray(np.asarray(sure)[kind.ravel()] | at_rest)


def determinate_forces(problem: Problem) -> Flags:
    """Where contact forces are determinate, stacked, shape (n_forces, n_instants).

    Where prescribed displacements alone make a jump, a normal force is not, nor is the
    friction that it carries; friction of a known bound is while it slips. Forces that
    can balance each other (`solver.reference.glued`) are not.
    """
    dofs, displacement = problem.prescribed
    free = np.ones(problem.n_dofs)
    free[dofs] = 0.0
    all_jumps = jumps(problem)
    rules = rules_of(problem)
    moves = abs(all_jumps) @ free > 0.0
    slips = np.diff(all_jumps[:, dofs] @ displacement, axis=1, prepend=0.0) != 0.0
    slips[rules.normal] = False
    slips &= (moves | ~rules.normal)[rules.partner][:, None]
    moves &= (moves | ~rules.normal)[rules.partner]
    moving = np.flatnonzero(moves)
    free_jumps = (all_jumps @ sparse.diags_array(free))[moving]
    ring = np.any(
        self_stresses(free_jumps, rules.compliance[moving] == 0.0) != 0.0, axis=1
    )
    moves[moving[ring]] = False
    return np.asarray(moves[:, None] | slips)


def kkt_residual(fields: Fields, problem: Problem, max_ratio: float = np.inf) -> float:
    """Largest violation of equilibrium, laws and what is prescribed, as a share of the forces.

    By the equations alone, at every instant, however the fields were found: relative to
    the largest contact force, or to a small share of what the displacement makes of
    forces inside elements, which rounding is a share of, but to at most so many times
    what acts; and to the load where all vanish.
    """
    displacement = fields.displacement / problem.scales.displacement
    force = fields.contact_force / problem.scales.force
    stiffness = assembled_stiffness(problem)
    all_jumps = jumps(problem)
    outer = external_force(problem)
    fixed, prescribed = problem.prescribed
    free = np.setdiff1d(np.arange(problem.n_dofs), fixed)
    missed = stiffness.diagonal()[fixed, None] * np.abs(
        displacement[fixed] - prescribed
    )
    inner = stiffness @ displacement
    missing = inner - outer - all_jumps.T @ force
    unbalanced = missing[free]
    elastic = abs(stiffness) @ np.abs(displacement)
    size = force_size(force, outer, elastic, missing[fixed], max_ratio)
    rules = rules_of(problem)
    # Lengths become forces by the stiffness of the jump's own degrees of freedom.
    unit = abs(all_jumps) @ stiffness.diagonal()
    unit = unit / (1.0 + unit * rules.compliance)
    jump = all_jumps @ displacement + rules.compliance[:, None] * force
    opening = jump + rules.gap[:, None]
    slip = np.diff(jump, axis=1, prepend=0.0)
    broken = broken_laws(rules, unit, force, opening, slip) * determinate_forces(
        problem
    )
    wrong = unbalanced, broken, missed
    largest = max(float(np.abs(part).max(initial=0.0)) for part in wrong)
    if size > 0.0:
        return largest / size
    return largest


def force_size(
    force: Array,
    outer: Array,
    elastic: Array,
    reaction: Array,
    max_ratio: float,
) -> float:
    """Size that violations of forces are a share of, scaled.

    By contact forces, loads, the parts of forces inside elements without signs, and
    reactions of what is held; each of shape (n, n_instants). It is at most so many
    times what acts.
    """
    sizes = [force, ELASTIC * outer, ELASTIC * elastic]
    size = max(float(np.abs(part).max(initial=0.0)) for part in sizes)
    acting = float(np.abs(outer).max(initial=0.0))
    carried = max(float(np.abs(part).max(initial=0.0)) for part in (force, reaction))
    # Where bodies move as they like, what holds them has rounding alone to hold.
    if carried > NOTHING * float(elastic.max(initial=0.0)):
        acting = max(acting, carried)
    if acting > 0.0:
        return min(size, max_ratio * acting)
    return size


def broken_laws(
    rules: Rules, unit: Array, force: Array, opening: Array, slip: Array
) -> Array:
    """How far contacts are from their laws, as forces, shape (n_forces, n_instants), scaled.

    It is the distance of the normal force from (f - r g)+ with the opening g, and of
    the friction force from f - r v cut to its bound, with the slip v. A stiffness r of
    the pair, `unit`, of shape (n_forces,), makes a force of a length; laws hold if and
    only if the distances vanish.
    """
    unit = unit[:, None]
    bound = rules.bounds(force, slip, opening)
    pressed = np.maximum(force - unit * opening, 0.0)
    rubbed = np.clip(force - unit * slip, -bound, bound)
    return np.abs(force - np.where(rules.normal[:, None], pressed, rubbed))
