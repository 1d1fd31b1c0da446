"""Limit analysis: the loads at which no contact forces are in equilibrium.

An equilibrium of the discrete problem, whatever its elasticity, is one of nodal contact
forces with N >= 0 and |T| <= r + mu N, times the strongest factor that slip may make,
that balance the loads on every body that contact alone holds. The largest share of a
step of the loads for which there are such forces is a linear program (R. K. Livesley,
Int. J. Numer. Meth. Eng. 12, 1978, for rigid blocks). That share is an upper bound:
Coulomb's friction is not associated with slip, so a structure may fail before, but not
after. The program's dual is the mechanism by which the structure collapses.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, auto

import numpy as np
import scipy
from scipy import sparse

from solver.arrays import Array, Indices, largest_size
from solver.discrete.problem import Problem
from solver.reference.assembly import (
    Interrupted,
    NoReferenceError,
    external_force,
    jumps,
    never,
)
from solver.reference.rules import rules_of

WHOLE = 1.0 - 1e-6
"""Share of a step of the loads from which on it counts as all of it, by the tolerance
of HiGHS."""
SURE = 1.0 - 1e-9
"""Share from which on a whole load holds, and no smaller steps are looked at."""
TURNED = 1e-3
"""Difference of displacements in a body, over the largest of all, from which on it
turns."""
ALIKE = 1e-3
"""Difference of the angles of bodies, over the largest, up to which they turn as
one."""
ON_LINE = 1e-12
"""Distance of loads from a line, over the largest load, up to which they lie on it."""
MOST = 1e6
"""Largest load over the other loads that counts as bounded."""
INFEASIBLE = 2
"""Status of `linprog` where no contact forces balance the loads."""


@dataclass(frozen=True, eq=False)
class Collapse:
    """Collapse: point of the load path beyond which contact cannot balance the loads.

    Attributes
    ----------
    time
        Time from which on there is no equilibrium, s.
    instant
        The first instant without one.
    share
        Share of the step of the loads to that instant up to which there is one.
    mechanism
        Rigid motions of all bodies in which they begin to move, shape (n_dofs,), the
        largest 1.
    motion
        Kind of the mechanism.
    """

    time: float
    instant: int
    share: float
    mechanism: Array
    motion: Motion


class Motion(Enum):
    """Kinds of mechanisms: bodies slide, turn as one, or turn about each other."""

    SLIDES = auto()
    TIPS = auto()
    FOLDS = auto()


class _Program:
    """The linear program of one step of the loads.

    Its unknowns are all contact forces, shape (n,), and the share of the step.
    """

    def __init__(
        self,
        problem: Problem,
        motions: sparse.csc_array,
        unit: float,
        largest: float = 1.0,
        stop: Callable[[], bool] = never,
    ) -> None:
        """Prepare what all instants share, with forces in a unit.

        `largest` is the largest share of a step that is looked at; `stop` is asked
        before each program.
        """
        self._rules = rules_of(problem)
        rules = self._rules
        self._unit = unit
        self._stop = stop
        self._balance = sparse.csc_array((jumps(problem) @ motions).T)
        self._rubs: Indices = np.flatnonzero(~rules.normal)
        # Slip may harden: what friction can ever carry is a bound whatever has slipped.
        self._strongest = max(rules.slip_factor.factors)
        self._limits = self._friction_limits()
        caps = rules.cap[self._rubs][self._capped]
        self._caps = np.tile(self._strongest * caps, 2) / unit
        size = len(rules.gap)
        # Pressing forces are not negative, nor is the share.
        lows = np.append(np.where(rules.normal, 0.0, -np.inf), 0.0)
        highs = np.append(np.full(size, np.inf), largest)
        self._bounds = np.stack([lows, highs], axis=1)
        self._aim = np.append(np.zeros(size), -1.0)

    @property
    def _capped(self) -> Indices:
        """Indices of the tangential jumps with a cap among these, shape (n_capped,)."""
        return np.flatnonzero(np.isfinite(self._rules.cap[self._rubs]))

    def _friction_limits(self) -> sparse.sparray:
        """Rows of |T| - mu N <= r and of |T| <= cap, (n_rows, n + 1)."""
        rules = self._rules
        every = sparse.eye_array(len(rules.gap), format="csr")
        along = every[self._rubs]
        pressing = every[rules.partner[self._rubs]]
        friction = self._strongest * rules.friction[self._rubs]
        carried = sparse.diags_array(friction) @ pressing
        capped = along[self._capped]
        cone = sparse.vstack([along - carried, -along - carried, capped, -capped])
        return sparse.hstack([cone, sparse.csr_array((cone.shape[0], 1))])

    def solve(self, instant: int, before: Array, step: Array) -> tuple[float, Array]:
        """Largest share of a step of the loads that contact balances, and its dual.

        With the loads before the step and the step, shape (n_motions,) each. The dual,
        (n_motions,), is of the motions that the loads do work on. Both are zero where
        nothing balances the loads before the step.

        Raises
        ------
        Interrupted
            If `stop` returns True.
        NoReferenceError
            If HiGHS finds no answer.
        """
        if self._stop():
            raise Interrupted
        known = self._strongest * self._rules.bound_at(instant)[self._rubs] / self._unit
        program = scipy.optimize.linprog(
            self._aim,
            A_ub=self._limits,
            b_ub=np.concatenate([known, known, self._caps]),
            A_eq=sparse.hstack([self._balance, sparse.csr_array(step[:, None])]),
            b_eq=-before,
            bounds=self._bounds,
            method="highs",
        )
        if program.status == INFEASIBLE:
            return 0.0, np.zeros_like(before)
        if program.status:
            raise NoReferenceError(f"limit analysis has no answer: {program.message}")
        return float(program.x[-1]), program.eqlin.marginals


def collapse_of(problem: Problem, stop: Callable[[], bool] = never) -> Collapse | None:
    """Collapse of a structure on its load path; None if it carries all loads.

    `stop` is asked before each linear program, one an instant.

    Raises
    ------
    Interrupted
        As soon as `stop` returns True.
    NoReferenceError
        If HiGHS finds no answer.
    """
    if problem.rigid_motions is None:
        return None
    motions = sparse.csc_array(problem.rigid_motions)
    loads = motions.T @ external_force(problem)
    unit = largest_size(loads) or 1.0
    program = _Program(problem, motions, unit, stop=stop)
    before = np.zeros(len(loads))
    path = loads.T / unit
    ends = _ends_of_line(problem, path)
    # Mostly nothing collapses: for proportional loads two linear programs show that.
    if ends and all(program.solve(end, before, path[end])[0] >= SURE for end in ends):
        return None
    for instant, now in enumerate(path):
        step = now - before
        # The load stands still: what held an instant before holds on.
        if instant and not step.any():
            continue
        share, dual = program.solve(instant, before, step)
        if share < WHOLE:
            return _collapse_at(problem, instant, share, dual)
        before = now
    return None


def _ends_of_line(problem: Problem, loads: Array) -> list[int]:
    """Instants of extreme loads if all loads are proportional; else none.

    Loads that contact balances are a convex set: what is between two of them is one,
    too. The loads have shape (n_instants, n_motions).
    """
    # A bound that changes with time makes another set at every instant.
    if rules_of(problem).bound.shape[1] > 1:
        return []
    moved = loads - loads[0]
    farthest = moved[np.abs(moved).max(axis=1).argmax()]
    course = moved @ farthest / (float(farthest @ farthest) or 1.0)
    apart = largest_size(moved - np.outer(course, farthest))
    if apart > ON_LINE * largest_size(loads):
        return []
    return sorted({int(course.argmin()), int(course.argmax())})


def load_factors(problem: Problem, without: Problem) -> Array:
    """Largest factor on some of the loads that contact can balance, (n_instants,).

    Each instant by itself. `without` is the same problem without these loads; where
    they are zero, or nothing bounds them, the factor is infinite, and 0 where the other
    loads alone have no equilibrium.

    Raises
    ------
    NoReferenceError
        If HiGHS finds no answer.
    """
    factors = np.full(problem.n_instants, np.inf)
    if problem.rigid_motions is None:
        return factors
    motions = sparse.csc_array(problem.rigid_motions)
    others = motions.T @ external_force(without)
    loads = motions.T @ external_force(problem) - others
    unit = largest_size(others) or 1.0
    program = _Program(problem, motions, unit, MOST)
    for instant in np.flatnonzero(loads.any(axis=0)).tolist():
        # In units of their own, as a small load has a large factor.
        size = largest_size(loads[:, instant])
        step = loads[:, instant] / size
        share, _ = program.solve(instant, others[:, instant] / unit, step)
        if share < MOST:
            factors[instant] = share * unit / size
    return factors


def _collapse_at(problem: Problem, instant: int, share: float, dual: Array) -> Collapse:
    """Collapse at a share of the step to an instant; the mechanism is the dual."""
    times = problem.instants
    first = times[max(instant - 1, 0)]
    time = float(first + share * (times[instant] - first))
    assert problem.rigid_motions is not None
    moved = -problem.rigid_motions @ dual
    mechanism = moved / (largest_size(moved) or 1.0)
    return Collapse(time, instant, share, mechanism, _motion_of(problem, mechanism))


def _motion_of(problem: Problem, mechanism: Array) -> Motion:
    """Kind of a mechanism, shape (n_dofs,), by the rotation of its bodies."""
    assert problem.inside is not None
    turns = []
    for part in problem.substructures:
        moved = mechanism[part.dofs]
        modes = problem.inside.rigid_modes(part.dofs)
        # All but what a translation explains.
        shares, *_ = np.linalg.lstsq(modes[:, :2], moved)
        is_turned = float(np.ptp(moved - modes[:, :2] @ shares)) > TURNED
        if is_turned:
            angles, *_ = np.linalg.lstsq(modes, moved)
            turns.append(angles[2])
    if not turns:
        return Motion.SLIDES
    largest = np.abs(turns).max()
    if np.ptp(turns) > ALIKE * largest:
        return Motion.FOLDS
    return Motion.TIPS
