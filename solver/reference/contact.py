"""Incremental reference for contacts that open, or between two bodies.

The solution of every instant is exact. In time it is backward Euler on the jumps (Jean
and Moreau), from rest at zero, as the laws of LATIN: friction opposes the increment of
the tangential jump.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from solver.arrays import ROUNDING, Array, Flags
from solver.discrete.contact_groups import carries
from solver.discrete.problem import Problem
from solver.laws import OPEN
from solver.reference.assembly import Interrupted, NoReferenceError, never
from solver.reference.condensation import Condensation
from solver.reference.distance import broken_laws
from solver.reference.instants import Instants
from solver.reference.limit_analysis import Collapse, collapse_of
from solver.reference.newton import CONVERGED
from solver.reference.rules import Increment, Rules, States
from solver.reference.solution import Reference

MOST_JUMPS = 13_000
"""Largest number of jumps with a reference, which keeps a dense matrix of their size,
1.4 GB."""


class IncrementalContact:
    """Incremental solver for any interfaces with friction.

    Friction may have several solutions for a large mu, or no solution where contact
    alone holds a body. Where several exist one of them is found, and the instant is
    `ambiguous` if that shows; where no solution is found, the instant and all after it
    are not `converged`. The contacts stay where they were at that instant, by forces
    that break the laws.

    Where the normal jump is prescribed, contact may share its force with the support in
    any way: the force is taken as zero, and so is the friction there. Where the
    tangential jump is prescribed, friction is that of `Problem.with_driven_friction`.
    """

    def __init__(self, problem: Problem, stop: Callable[[], bool] = never) -> None:
        """Condense a problem.

        Raises
        ------
        Interrupted
            As soon as `stop` returns True; it is asked now and then.
        NoReferenceError
            If there are more than `MOST_JUMPS` jumps, or the structure can move with
            all contacts closed and stuck.
        """
        n_jumps = jumps_in(problem)
        if n_jumps > MOST_JUMPS:
            raise NoReferenceError(
                f"a reference would condense {n_jumps} components of contact (at most "
                f"{MOST_JUMPS}); take fewer elements, layers or wires to have one"
            )
        self._problem = problem
        self._condensed = Condensation(problem, stop)
        self._rules = self._condensed.all_rules
        self._is_analysed = False
        self._collapse: Collapse | None = None

    def march(
        self,
        guess: States | None = None,
        max_systems: int | None = None,
        stop: Callable[[], bool] = never,
    ) -> Reference:
        """Solve instant by instant, up to the first instant without solution.

        Friction depends on the path, so that nothing is known of the instants after it.

        Parameters
        ----------
        guess
            States from which an instant starts, stacked as `Problem.sum_of_contact`
            says, shape (n_forces, n_instants), unless those of the instant before turn
            out to be better.
        max_systems
            Largest number of linear systems to solve; the instants that are not reached
            then do not move, and are not `converged`.
        stop
            Function called before each linear system; `Interrupted` is raised as soon
            as it returns True.

        Raises
        ------
        Interrupted
            If `stop` asks for it.
        """
        problem = self._problem
        condensed = self._condensed
        states = None
        if guess is not None:
            states = guess[condensed.moving]
        instants = Instants(
            condensed,
            problem.rest,
            states,
            lambda instant: self._may_hold(instant, stop),
            stop,
        )
        n_instants = problem.n_instants
        # Instants that are not reached stay without increment and force.
        n_base, n_motions = condensed.gauge.shape
        done = Increment(
            jump=np.zeros((len(condensed.moving), n_instants)),
            force=np.zeros((len(condensed.moving), n_instants)),
            strained=np.zeros((n_base, n_instants)),
            motion=np.zeros((n_motions, n_instants)),
        )
        has_others = np.zeros(n_instants, dtype=bool)
        reached = np.zeros(n_instants, dtype=bool)
        for instant in range(n_instants):
            if stop():
                raise Interrupted
            if max_systems is not None and instants.system.solutions >= max_systems:
                break
            for field, values in zip(done, instants(instant), strict=True):
                field[:, instant] = values
            is_negative = instants.system.has_negative_determinant
            has_others[instant] = is_negative or instants.has_others
            reached[instant] = True
            # Beyond a collapse there is no equilibrium to seek.
            if self._collapse is not None and instant >= self._collapse.instant:
                break
            # To stay where they were may be the solution, up to rounding.
            if instants.is_stuck:
                so_far = self._judged(instants, done, has_others, reached)
                if not so_far.converged[instant]:
                    return so_far
        return self._judged(instants, done, has_others, reached)

    def _may_hold(self, instant: int, stop: Callable[[], bool]) -> bool:
        """Check whether any contact forces balance the loads of an instant."""
        # One analysis of the whole path, when a first instant fails.
        if not self._is_analysed:
            self._collapse = collapse_of(self._problem, stop)
            self._is_analysed = True
        return self._collapse is None or instant < self._collapse.instant

    def _judged(
        self, instants: Instants, done: Increment, has_others: Flags, reached: Flags
    ) -> Reference:
        """The reference: all fields, and their violation of equilibrium and laws.

        Parameters
        ----------
        instants
            The march, at its end.
        done
            Steps of all instants, (..., n_instants).
        has_others, reached
            Instants that certainly have other solutions, and those that were tried,
            shape (n_instants,).
        """
        problem = self._problem
        condensed = self._condensed
        deformation = condensed.deformation(np.cumsum(done.strained, axis=1))
        rigid = condensed.motions @ np.cumsum(done.motion, axis=1)
        forces = self._forces(done, deformation + rigid)
        slip, opening = self._slip_and_opening(done, deformation, rigid, forces)
        unbalanced = self._unbalanced(deformation, forces, slip, opening)
        # Sticking points have exactly no slip in the solution; that of the fields is
        # rounding.
        slip[condensed.moving] = done.jump
        size = max(condensed.largest_force, float(np.abs(forces).max(initial=0.0)))
        blurred = condensed.rounding(deformation, rigid, size)
        least = ROUNDING * condensed.inside(deformation)
        is_open = _without_forces(self._rules, forces, least)
        converged = reached & (unbalanced <= max(CONVERGED * size, blurred))
        scales = problem.scales
        return Reference(
            problem=problem,
            displacement=(deformation + rigid) * scales.displacement,
            deformation=deformation * scales.displacement,
            contact_force=forces * scales.force,
            status=_status(self._rules, slip, forces, is_open),
            unbalanced=float(unbalanced.max(initial=0.0)) * scales.force,
            rounding=blurred * scales.force,
            converged=converged,
            ambiguous=has_others & converged,
            steps=instants.system.solutions,
            jumps_at=instants.jumps_at,
            is_lost=bool(np.any(reached & ~converged)),
            collapse=self._collapse,
        )

    def _forces(self, done: Increment, displacement: Array) -> Array:
        """Forces of all jumps, shape (n_forces, n_instants), scaled.

        By the steps of all instants and the displacement, shape (n_dofs, n_instants).
        """
        problem = self._problem
        forces = np.zeros((len(self._rules.gap), problem.n_instants))
        forces[self._condensed.moving] = done.force
        return problem.with_driven_friction(forces, displacement[problem.row_dofs])

    def _slip_and_opening(
        self, done: Increment, deformation: Array, rigid: Array, forces: Array
    ) -> tuple[Array, Array]:
        """Slip increments and openings, including springs in series; scaled.

        Both have the shape of the forces, (n_forces, n_instants); deformation and rigid
        motion have the shape (n_dofs, n_instants).
        """
        condensed = self._condensed
        rules = self._rules
        # Without the rigid motion, which may be far larger and hide the digits of the
        # slip.
        moved = condensed.jump(deformation)
        moved += rules.compliance[:, None] * forces
        slip = np.diff(moved, axis=1, prepend=0.0)
        slip += condensed.jump(condensed.motions @ done.motion)
        opening = moved + condensed.jump(rigid) + rules.gap[:, None]
        return slip, opening

    def _unbalanced(
        self, deformation: Array, forces: Array, slip: Array, opening: Array
    ) -> Array:
        """Largest violation of equilibrium and laws as a force, (n_instants,), scaled.

        The deformation has the shape (n_dofs, n_instants), the others that of the
        forces, (n_forces, n_instants).
        """
        condensed = self._condensed
        rules = self._rules
        violation = broken_laws(rules, condensed.unit, forces, opening, slip)
        # The force of a normal jump that is prescribed is not determinate, so it has no
        # law.
        prescribed = np.setdiff1d(np.flatnonzero(rules.normal), condensed.moving)
        violation[prescribed] = 0.0
        missing = np.abs(condensed.unbalanced(deformation, forces))
        violation = np.concatenate([violation, missing])
        return np.asarray(violation.max(axis=0, initial=0.0))


def jumps_in(problem: Problem) -> int:
    """Number of components of contact that `IncrementalContact` condenses."""
    count = 0
    for law in problem.contacts.laws.values():
        count += sum(len(component.above) for component in law.components)
    return count


def _without_forces(rules: Rules, forces: Array, least: float) -> Flags:
    """Mask of the points that are open, (n_points, n_instants); rounding becomes 0.

    Forces of all jumps have the shape (n_forces, n_instants). Those between bodies that
    do not yield are the rest that balances the forces inside bodies, and up to `least`
    may be rounding of these; a spring in series tells its force by itself.
    """
    tangential = np.flatnonzero(~rules.normal)
    normal = rules.partner[tangential]
    smallest = np.where(rules.compliance[normal] > 0.0, 0.0, least)[:, None]
    touches = carries(forces[normal], np.abs(forces[tangential]), smallest)
    # A friction force of a known pressure has itself as partner, and never opens.
    is_open = rules.normal[normal][:, None] & ~touches
    for components in (normal, tangential):
        is_rounding = is_open & (np.abs(forces[components]) <= smallest)
        forces[components] = np.where(is_rounding, 0.0, forces[components])
    return is_open


def _status(rules: Rules, slip: Array, forces: Array, is_open: Flags) -> States:
    """Status of every point, stacked interface by interface, (n_points, n_instants).

    By slips and forces of all jumps, shape (n_forces, n_instants), and a mask of the
    points that are open, shape (n_points, n_instants).
    """
    tangential = ~rules.normal
    status = np.sign(slip).astype(np.int8)
    # Friction never drives a slip: one along it is rounding, of a point that stays
    # where it was, at its bound.
    status[slip * forces > 0.0] = 0
    of_points = status[tangential]
    of_points[is_open] = OPEN
    return of_points
