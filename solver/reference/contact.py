"""The incremental reference where contacts open or two sides rub: instant by instant, exact.

In time it is backward Euler on the jumps (Jean and Moreau), from rest at zero, as the
laws of LATIN: friction opposes the increment of the tangential jump.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from solver.arrays import Array, Flags
from solver.discrete.problem import Problem
from solver.laws import OPEN
from solver.reference.assembly import Interrupted, NoReferenceError
from solver.reference.condensation import Condensation
from solver.reference.distance import broken_laws
from solver.reference.instants import Instants
from solver.reference.limit_analysis import Collapse, collapse_of
from solver.reference.newton import CONVERGED
from solver.reference.rules import Increment, Rules, States
from solver.reference.solution import Reference

MOST_JUMPS = 13_000
"""Jumps up to which there is a reference: it keeps a dense matrix of their size, 1.4
GB."""


class IncrementalContact:
    """The incremental solver of any interfaces with friction, ready to march through time.

    Friction may have several solutions for a large mu, or none where contact alone
    holds a body. Where several exist one of them is found, and `ambiguous` if that
    shows; where none is found, `converged` is False, and the contacts stay where they
    were, by forces that break the laws.

    Where the normal jump is prescribed, contact shares its force with the support in
    any way: it is taken as zero, and so is the friction there. Where the tangential
    jump is, friction is as `Problem.with_driven_friction` says.

    `stop` is asked now and then while it is made; `Interrupted` is raised where it
    returns True. NoReferenceError is raised if there are more than `MOST_JUMPS` jumps,
    or the structure can move with all contacts closed and stuck.
    """

    def __init__(
        self, problem: Problem, stop: Callable[[], bool] | None = None
    ) -> None:
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
        most: int | None = None,
        stop: Callable[[], bool] | None = None,
    ) -> Reference:
        """Solve instant by instant.

        Parameters
        ----------
        guess
            States from which an instant starts, stacked as `Problem.sum_of_contact`
            says, shape (n_forces, n_instants), unless those of the instant before turn
            out to be better.
        most
            Linear systems to solve; the instants that are not reached then do not move,
            and are not `converged`.
        stop
            Called before each linear system; `Interrupted` is raised as soon as it
            returns True.
        """
        problem = self._problem
        condensed = self._condensed
        if guess is None:
            own = None
        else:
            own = guess[condensed.moving]
        instants = Instants(
            condensed,
            problem.rest,
            own,
            lambda instant: self._may_hold(instant, stop),
            stop,
        )
        sizes = (len(condensed.moving),) * 2 + condensed.gauge.shape
        done = Increment(*(np.zeros((size, problem.n_instants)) for size in sizes))
        turned, reached = np.zeros((2, problem.n_instants), dtype=bool)
        for instant in range(problem.n_instants):
            if stop is not None and stop():
                raise Interrupted
            if most is not None and instants.system.solutions >= most:
                break
            for field, values in zip(done, instants(instant), strict=True):
                field[:, instant] = values
            turned[instant] = (
                instants.system.has_negative_determinant or instants.has_others
            )
            reached[instant] = True
            if self._collapse is not None and instant >= self._collapse.instant:
                break
        return self._judged(instants, done, turned, reached)

    def _may_hold(self, instant: int, stop: Callable[[], bool] | None) -> bool:
        """Whether any contact forces balance the loads of an instant."""
        if not self._is_analysed:
            self._collapse = collapse_of(self._problem, stop)
            self._is_analysed = True
        return self._collapse is None or instant < self._collapse.instant

    def _judged(
        self, instants: Instants, done: Increment, turned: Flags, reached: Flags
    ) -> Reference:
        """All fields, and how far they are from equilibrium and laws."""
        problem = self._problem
        condensed = self._condensed
        rules = self._rules
        motion = np.cumsum(done.motion, axis=1)
        deformation = condensed.deformation(np.cumsum(done.strained, axis=1))
        rigid = condensed.motions @ motion
        moved = condensed.jump(deformation)
        forces = np.zeros_like(moved)
        forces[condensed.moving] = done.force
        rows = (deformation + rigid)[problem.row_dofs]
        forces = problem.with_driven_friction(forces, rows)
        moved += rules.compliance[:, None] * forces
        slip = np.diff(moved, axis=1, prepend=0.0)
        slip += condensed.jump(condensed.motions @ done.motion)
        opening = moved + condensed.jump(rigid) + rules.gap[:, None]
        wrong = broken_laws(rules, condensed.unit, forces, opening, slip)
        # The force of a normal jump that is prescribed is not determinate, so it has no
        # law.
        wrong[np.setdiff1d(np.flatnonzero(rules.normal), condensed.moving)] = 0.0
        wrong = np.concatenate(
            [wrong, np.abs(condensed.unbalanced(deformation, forces))]
        )
        unbalanced = wrong.max(axis=0, initial=0.0)
        slip[condensed.moving] = done.jump
        size = max(condensed.largest_force, float(np.abs(forces).max(initial=0.0)))
        blurred = condensed.rounding(deformation, rigid, size)
        if size > 0.0:
            residual = unbalanced / size
        else:
            residual = unbalanced
        converged = reached & (unbalanced <= max(CONVERGED * size, blurred))
        scales = problem.scales
        return Reference(
            problem=problem,
            displacement=(deformation + rigid) * scales.displacement,
            deformation=deformation * scales.displacement,
            contact_force=forces * scales.force,
            status=_status(rules, slip, forces),
            residual=float(residual.max(initial=0.0)),
            unbalanced=float(unbalanced.max(initial=0.0)) * scales.force,
            rounding=blurred * scales.force,
            converged=converged,
            ambiguous=turned & converged,
            steps=instants.system.solutions,
            jumps_at=instants.jumps_at,
            is_lost=bool(np.any(reached & ~converged)),
            collapse=self._collapse,
        )


def jumps_in(problem: Problem) -> int:
    """Number of components of contact that `IncrementalContact` condenses."""
    laws = problem.rubbing.values()
    return sum(len(component.above) for law in laws for component in law.components)


def _status(rules: Rules, slip: Array, forces: Array) -> States:
    """Status of every point, stacked interface by interface, (n_points, n_instants)."""
    tangential = ~rules.normal
    status = np.sign(slip).astype(np.int8)
    with_normal = rules.normal[rules.partner][:, None]
    status[with_normal & (forces[rules.partner] <= 0.0)] = OPEN
    return np.asarray(status[tangential])
