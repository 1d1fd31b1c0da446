"""Whether any contact forces balance the loads, and where along the path none do any more.

An equilibrium of the discrete problem, whatever its elasticity, is one of nodal contact
forces with N >= 0 and |T| <= r + mu N, times the strongest factor that slip may make,
that balance the loads on every body that contact alone holds. The largest share of a
step of the loads for which there are such forces is a linear program (R. K. Livesley,
Int. J. Numer. Meth. Eng. 12, 1978, for rigid blocks). It is a bound: Coulomb's friction
is not associated with slip, so a structure may fail before; it never fails after. The
program's dual is the mechanism by which it collapses.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.optimize import linprog

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.reference.assembly import (
    Interrupted,
    NoReferenceError,
    external_force,
    jumps,
)
from solver.reference.rules import rules_of

WHOLE = 1.0 - 1e-6
"""Share of a step of the loads from which on it is all of it, but for what HiGHS
leaves."""
TURNED = 1e-3
"""Difference of displacements in a body, over the largest of all, from which on it
turns."""


@dataclass(frozen=True, eq=False)
class Collapse:
    """Where the loads go beyond all that contact can balance.

    Attributes
    ----------
    time
        From when on there is no equilibrium, s.
    instant
        The first instant without one.
    share
        Share of the step of the loads to that instant up to which there is one.
    mechanism
        Rigid motions of all bodies in which they begin to move, shape (n_dofs,), the
        largest 1.
    tips
        Whether any of them turns, and does not only slide.
    """

    time: float
    instant: int
    share: float
    mechanism: Array
    tips: bool


def collapse_of(
    problem: Problem, stop: Callable[[], bool] | None = None
) -> Collapse | None:
    """Where a structure collapses on the path of its loads; None if it never does.

    `stop` is asked before each linear program, one an instant.

    Raises
    ------
    Interrupted
        As soon as `stop` returns True.
    NoReferenceError
        If HiGHS finds no answer.
    """
    if problem.motions is None:
        return None
    rules = rules_of(problem)
    motions = sparse.csc_array(problem.motions)
    loads = motions.T @ external_force(problem)
    unit = float(np.abs(loads).max(initial=0.0)) or 1.0
    holds = sparse.csc_array((jumps(problem) @ motions).T)
    size = len(rules.gap)
    rubs = np.flatnonzero(~rules.normal)
    every = sparse.eye_array(size, format="csr")
    along = every[rubs]
    under = every[rules.partner[rubs]]
    # Slip may harden: what friction can ever carry is a bound whatever has slipped.
    strongest = max(rules.strength.factors)
    across = sparse.diags_array(strongest * rules.friction[rubs]) @ under
    caps = np.flatnonzero(np.isfinite(rules.cap[rubs]))
    capped = np.tile(strongest * rules.cap[rubs][caps], 2) / unit
    cone = sparse.vstack([along - across, -along - across, along[caps], -along[caps]])
    none = sparse.csr_array((cone.shape[0], 1))
    lows = np.where(rules.normal, 0.0, -np.inf)
    bounds = np.stack(
        [np.append(lows, 0.0), np.append(np.full(size, np.inf), 1.0)], axis=1
    )
    before = np.zeros(len(loads))
    times = problem.instants
    for instant, now in enumerate(loads.T / unit):
        known = strongest * rules.bound_at(instant)[rubs] / unit
        step = sparse.csr_array((now - before)[:, None])
        if not step.nnz and instant:
            continue
        if stop is not None and stop():
            raise Interrupted
        program = linprog(
            np.append(np.zeros(size), -1.0),
            A_ub=sparse.hstack([cone, none]),
            b_ub=np.concatenate([known, known, capped]),
            A_eq=sparse.hstack([holds, step]),
            b_eq=-before,
            bounds=bounds,
            method="highs",
        )
        if program.status not in (0, 2):
            raise NoReferenceError(f"limit analysis has no answer: {program.message}")
        if program.status == 0:
            share = float(program.x[-1])
        else:
            share = 0.0
        if share < WHOLE:
            first = times[max(instant - 1, 0)]
            time = float(first + share * (times[instant] - first))
            if program.status:
                shares = np.zeros(len(loads))
            else:
                shares = program.eqlin.marginals
            moved = -problem.motions @ shares
            mechanism = moved / (np.abs(moved).max(initial=0.0) or 1.0)
            return Collapse(time, instant, share, mechanism, _tips(problem, mechanism))
        before = now
    return None


def _tips(problem: Problem, mechanism: Array) -> bool:
    """Whether points of a body do not move alike in a mechanism."""
    assert problem.inside is not None
    component = problem.inside.components
    return any(
        float(np.ptp(mechanism[part.dofs[component[part.dofs] == axis]])) > TURNED
        for part in problem.substructures
        for axis in (0, 1)
        if np.any(component[part.dofs] == axis)
    )
