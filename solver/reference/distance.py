"""Errors: distances from a reference (MATHEMATICS.md, 4), and KKT residuals."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from solver.arrays import Array, Flags, Indices, largest_size
from solver.discrete.problem import Problem
from solver.reference.assembly import assembled_stiffness, external_force, jumps
from solver.reference.glued import self_stresses
from solver.reference.rules import Rules, rules_of

VANISHING = 1e-8
"""Share of the load and of the largest friction force below which contact forces
vanish."""
LEAST_SHARE = 0.01
"""Smallest size of pressure, or friction, as a share of both together: friction that is
next to nothing beside pressure has no digits that a run could find."""
ELASTIC = 1e-4
"""Share of the forces inside elements that counts like a contact force, since they
leave as much rounding. In slender bodies they are 1e5 times the loads."""
HIDDEN = 100.0
"""Largest size of forces, over the forces that act, where displacements alone have to
prove an answer: a body that nothing holds may be far away, and leaves rounding that
would hide all that acts."""
SURE = 1e-9
"""Square of the smallest singular value over that of the largest, above which columns
are independent for sure."""
NOTHING = 1e-12
"""Share of the forces inside elements up to which contact forces and reactions are
rounding."""


class Fields(Protocol):
    """Fields of an iterate or of a reference for errors, SI."""

    @property
    def displacement(self) -> Array:
        """Displacement, shape (n_dofs, n_instants), m."""

    @property
    def contact_force(self) -> Array:
        """Nodal forces of all contacts, stacked, shape (n_forces, n_instants), N."""


class Distance:
    """Relative L2 distance over space and time to a reference of the same problem.

    Displacements are compared at interfaces, without the turns of beams. Where the
    reference field vanishes, the distance is relative to the load instead, and absolute
    if that vanishes, too; contact forces vanish also if they are rounding beside the
    largest friction force and beside the load. Both fields are compared where they are
    determinate.

    Attributes
    ----------
    force_size
        Norm that distances of contact forces are divided by, N sqrt(s).
    """

    def __init__(self, reference: Fields, problem: Problem, load: Array) -> None:
        """Prepare the distance, with a load of shape (n, n_instants), N."""
        rules = rules_of(problem)
        self._weights = problem.time_weights
        self._determinate = determinate_forces(problem)
        self._held = held_instants(problem, reference.contact_force)
        dofs = np.unique(problem.row_dofs)
        self._dofs: Indices = dofs[~problem.is_turn[dofs]]
        self._displacement = reference.displacement[self._dofs] * self._held
        self._force = reference.contact_force * self._determinate
        scales = problem.scales
        load_size = self._norm(load)
        # As far as the load would stretch the structure.
        stretched = load_size * scales.displacement / scales.force
        self._displacement_size = self._norm(self._displacement) or stretched or 1.0
        self._set_sizes(rules, load_size, scales.force)

    def _set_sizes(self, rules: Rules, load_size: float, unit: float) -> None:
        """Set the norms of all contact forces, and of pressure and friction apart.

        With the norm of the load, N sqrt(s), and the unit of scaled forces, N.
        """
        force_size = self._norm(self._force)
        allowed = self._norm(rules.bound * unit * np.ones(len(self._weights)))
        # Without a known bound it is the load alone that contact forces can vanish
        # beside.
        vanishes = force_size <= VANISHING * (min(load_size, allowed) or load_size)
        if vanishes:
            self.force_size = load_size or 1.0
            smallest = self.force_size
        else:
            self.force_size = force_size or 1.0
            smallest = LEAST_SHARE * self.force_size
        # Pressing forces are far larger than friction, whose error they would hide.
        self._kinds: list[tuple[Flags, float]] = []
        for kind in (rules.normal, ~rules.normal):
            if kind.any():
                size = max(self._norm(self._force[kind]), smallest)
                self._kinds.append((kind, size))

    def of_displacement(self, fields: Fields) -> float:
        """Relative error of the displacement."""
        difference = fields.displacement[self._dofs] * self._held - self._displacement
        return self._norm(difference) / self._displacement_size

    def of_friction_force(self, fields: Fields) -> float:
        """Relative error of contact forces: of friction, or of pressure if larger.

        Each is relative to its own norm, or to `LEAST_SHARE` of both together where
        that is more.
        """
        difference = fields.contact_force * self._determinate - self._force
        errors = [self._norm(difference[kind]) / size for kind, size in self._kinds]
        return max(errors, default=0.0)

    def _norm(self, field: Array) -> float:
        """L2 norm over space and time, in the unit of the field times sqrt(s).

        The field, (n, n_instants), is scaled first, so that no square underflows.
        """
        largest = float(np.abs(field).max(initial=0.0))
        if largest == 0.0:
            return 0.0
        scaled = field / largest
        return largest * float(np.sqrt((scaled * scaled @ self._weights).sum()))


def distance_to(reference: Fields, problem: Problem) -> Distance:
    """Prepare the distance to a reference of a problem.

    The load is that of given forces. Where there are none, it is the forces that move
    prescribed displacements; and where these are rounding, because nothing resists, the
    forces that such displacements, and closing bodies that overlap, make in elements.
    """
    forces = [given.values for given in problem.prescribed_forces]
    for part in problem.substructures:
        if part.body_force is not None:
            forces.append(part.body_force)
    if not any(force.any() for force in forces):
        forces = [_forces_of_motion(reference, problem)]
    load = np.concatenate([*forces, np.zeros((1, problem.n_instants))])
    return Distance(reference, problem, load * problem.scales.force)


def _forces_of_motion(reference: Fields, problem: Problem) -> Array:
    """Forces due to prescribed displacements and overlaps, (n, n_instants), scaled.

    They are the reactions, or, where those are rounding, the forces inside elements
    without signs.
    """
    dofs, prescribed = problem.prescribed
    stiffness = assembled_stiffness(problem)
    moved = stiffness[dofs[prescribed.any(axis=1)]]
    reactions = moved @ reference.displacement / problem.scales.displacement
    overlaps = abs(jumps(problem)).T @ np.maximum(-rules_of(problem).gap, 0.0)
    inside = abs(stiffness[:, dofs]) @ np.abs(prescribed)
    inside += (abs(stiffness) @ overlaps)[:, None]
    if largest_size(reactions) <= VANISHING * inside.max(initial=0.0):
        return np.asarray(inside)
    return np.asarray(reactions)


def held_instants(problem: Problem, contact_force: Array) -> Flags:
    """Instants at which contact forces determine all positions, shape (n_instants,).

    A body that contact alone holds may lie anywhere along a rigid motion that neither
    goes against a contact that presses nor rubs: without friction, on level ground.
    Until contacts first carry a force the body is at rest.

    Parameters
    ----------
    problem
        Problem that the forces belong to.
    contact_force
        Contact forces, stacked, shape (n_forces, n_instants), N.
    """
    held = np.ones(problem.n_instants, dtype=bool)
    if problem.rigid_motions is None:
        return held
    rules = rules_of(problem)
    force = contact_force / problem.scales.force
    small = VANISHING * np.abs(force).max(initial=0.0)
    force = np.where(force > small, force, 0.0)
    bound = rules.bounds(force, np.zeros_like(force))
    holds = np.where(rules.normal[:, None], force, bound) > 0.0
    moved = jumps(problem) @ problem.rigid_motions
    acts = holds.any(axis=0)
    at_rest = ~np.logical_or.accumulate(acts)
    # Mostly the contacts that hold whenever any do hold the bodies already.
    always = holds[:, acts].all(axis=1)
    if are_independent(moved[always]):
        return np.asarray(acts | at_rest)
    # Few patterns of contact occur, each at many instants: one rank for each pattern.
    patterns, kind = np.unique(holds, axis=1, return_inverse=True)
    sure = [are_independent(moved[pattern]) for pattern in patterns.T]
    return np.asarray(np.asarray(sure)[kind.ravel()] | at_rest)


def are_independent(columns: Array) -> bool:
    """Check whether the columns of a matrix, (n, m), are linearly independent."""
    # Of no rows older versions of NumPy give no rank.
    if len(columns) < columns.shape[1]:
        return False
    squares = np.linalg.eigvalsh(columns.T @ columns)
    # Singular values are dearer, and distinguish columns that are nearly dependent.
    if squares[0] > SURE * squares[-1]:
        return True
    return bool(np.linalg.matrix_rank(columns) == columns.shape[1])


def determinate_forces(problem: Problem) -> Flags:
    """Flags of contact forces that are determinate, stacked, (n_forces, n_instants).

    Where prescribed displacements alone make a jump, its normal force is not
    determinate, nor is the friction that it carries; friction of a known bound is while
    it slips. Forces that can balance each other (`solver.reference.glued`) are not.
    """
    rules = rules_of(problem)
    dofs, displacement = problem.prescribed
    free = np.ones(problem.n_dofs)
    free[dofs] = 0.0
    all_jumps = jumps(problem)
    moves = abs(all_jumps) @ free > 0.0
    slips = np.zeros((len(moves), problem.n_instants), dtype=bool)
    # Mostly what is prescribed is held: such a jump never slips.
    if displacement.any():
        jumped = all_jumps[:, dofs] @ displacement
        slips = np.diff(jumped, axis=1, prepend=0.0) != 0.0
    slips[rules.normal] = False
    slips &= (moves | ~rules.normal)[rules.partner][:, None]
    moves &= (moves | ~rules.normal)[rules.partner]
    # Jumps with a spring in series have a force of their own even in a ring.
    moving = np.flatnonzero(moves)
    free_jumps = all_jumps[moving]
    free_jumps.data = free_jumps.data * free[free_jumps.indices]
    free_jumps.eliminate_zeros()
    ring = np.any(
        self_stresses(free_jumps, rules.compliance[moving] == 0.0) != 0.0, axis=1
    )
    moves[moving[ring]] = False
    return np.asarray(moves[:, None] | slips)


def kkt_residual(fields: Fields, problem: Problem, max_ratio: float = np.inf) -> float:
    """Largest violation of equilibrium, laws and prescribed values, as a share.

    It follows from the equations alone, at every instant, however the fields were
    found. Violations are relative to `force_size`, and to the load where all vanish.

    Parameters
    ----------
    fields
        Displacements and contact forces, SI.
    problem
        Problem that the fields should solve.
    max_ratio
        Largest size of forces, over the forces that act, as of `force_size`.
    """
    displacement = fields.displacement / problem.scales.displacement
    force = fields.contact_force / problem.scales.force
    stiffness = assembled_stiffness(problem)
    outer = external_force(problem)
    held, prescribed = problem.prescribed
    missing = stiffness @ displacement - outer - jumps(problem).T @ force
    elastic = abs(stiffness) @ np.abs(displacement)
    size = force_size(force, outer, elastic, missing[held], max_ratio)
    # Lengths become forces by the stiffness of their own degrees of freedom.
    stiffnesses = stiffness.diagonal()
    violations = (
        np.delete(missing, held, axis=0),
        _broken_laws_of(problem, stiffnesses, displacement, force),
        stiffnesses[held, None] * np.abs(displacement[held] - prescribed),
    )
    largest = largest_size(*violations)
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
    """Reference size for violations of forces, scaled.

    It is the largest contact force, or a small share of loads and of forces inside
    elements, since rounding is a share of these; and at most a multiple of the forces
    that act.

    Parameters
    ----------
    force, outer, elastic, reaction
        Contact forces, loads, parts of forces inside elements without signs, and
        reactions of held degrees of freedom, shape (n, n_instants) each, scaled.
    max_ratio
        Largest size over the largest force that acts.
    """
    size = largest_size(force, ELASTIC * outer, ELASTIC * elastic)
    acting = largest_size(outer)
    carried = largest_size(force, reaction)
    # A body that moves freely has rounding alone as contact forces and reactions.
    if carried > NOTHING * float(elastic.max(initial=0.0)):
        acting = max(acting, carried)
    if acting > 0.0:
        return min(size, max_ratio * acting)
    return size


def _broken_laws_of(
    problem: Problem, stiffnesses: Array, displacement: Array, force: Array
) -> Array:
    """Violation of the laws of contact by fields, (n_forces, n_instants), scaled.

    Parameters
    ----------
    problem
        Problem with these laws.
    stiffnesses
        Stiffness of every degree of freedom alone, shape (n_dofs,), scaled.
    displacement, force
        Displacements (n_dofs, n_instants) and contact forces (n_forces, n_instants),
        scaled.
    """
    rules = rules_of(problem)
    all_jumps = jumps(problem)
    unit = abs(all_jumps) @ stiffnesses
    unit = unit / (1.0 + unit * rules.compliance)
    jump = all_jumps @ displacement + rules.compliance[:, None] * force
    slip = np.diff(jump, axis=1, prepend=0.0)
    broken = broken_laws(rules, unit, force, jump + rules.gap[:, None], slip)
    return broken * determinate_forces(problem)


def broken_laws(
    rules: Rules, unit: Array, force: Array, opening: Array, slip: Array
) -> Array:
    """Violation of the laws of contact as a force, (n_forces, n_instants), scaled.

    It is the distance of the normal force from (f - r g)+ with the opening g, and of
    the friction force from f - r v cut to its bound, with the slip v. Laws hold if and
    only if the distances vanish, for every stiffness r > 0.

    Parameters
    ----------
    rules
        Rules of the jumps.
    unit
        Stiffness r of each pair, which makes a force of a length, shape (n_forces,),
        scaled.
    force, opening, slip
        Forces, openings g, and slips v of every instant, shape (n_forces, n_instants),
        scaled.
    """
    unit = unit[:, None]
    bound = rules.bounds(force, slip, opening)
    pressed = np.maximum(force - unit * opening, 0.0)
    rubbed = np.clip(force - unit * slip, -bound, bound)
    return np.abs(force - np.where(rules.normal[:, None], pressed, rubbed))
