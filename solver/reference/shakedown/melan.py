"""The load up to which slip ceases: Melan's theorem for friction, as a linear program.

Where the bound does not depend on slip, a structure shakes down under a load that repeats itself if
there is any slip s, the same at all instants, whose forces keep all forces within the bound b:

    |lambda f_e(t) + R s| <= b(t),

with f_e the forces where nothing has slipped and R s those that slip alone leaves behind. The
largest lambda is the limit, wherever the slip begins (A. Klarbring, M. Ciavarella, J. R. Barber,
Shakedown in elastic contact problems with Coulomb friction, Int. J. Solids Struct. 44, 2007;
solver/README.md, 15).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.optimize import linprog

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.reference.condensation import Condensation, NoReferenceError
from solver.reference.rules import rules_of

MOST_POINTS = 1000
"""Points above which the program, whose matrix is full, takes more than some seconds."""


@dataclass(frozen=True, eq=False)
class ShakedownLimit:
    """The largest factor on all loads under which slip ceases, and what shows it.

    Attributes
    ----------
    factor
        Lambda; infinite where the loads stay the same, or nothing that rubs feels them.
    slip
        A slip s that ceases under it, shape (n,), m, of all points that rub and are not held.
    left
        Forces R s on the bodies above that it leaves behind, same shape, N.
    elastic, bound
        Forces f_e without slip, and their bounds b, shape (n, n_instants) each, N.
    """

    factor: float
    slip: Array
    left: Array
    elastic: Array
    bound: Array


def shakedown_limit(problem: Problem, some: slice = slice(None)) -> ShakedownLimit:
    """Find the shakedown limit of rods.

    Parameters
    ----------
    problem
        Bodies whose friction has known bounds; all that acts is scaled, but for these.
    some
        The instants of a cycle; what came before says nothing of the limit.

    Raises
    ------
    NoReferenceError
        Where bounds depend on the pressing force or on slip, or there are too many points.
    """
    forces = _forces(problem, some)
    factor, slip, left = _largest(forces)
    moved, forced = problem.scales.displacement, problem.scales.force
    seen = forces.elastic * forced, forces.bound * forced
    return ShakedownLimit(factor, slip * moved, left * forced, *seen)


class _Forces(NamedTuple):
    """R, f_e and b of the points that rub, and Q, forces on them that move nothing; scaled."""

    residual: Array
    elastic: Array
    bound: Array
    stresses: Array


def _largest(forces: _Forces) -> tuple[float, Array, Array]:
    """Give lambda, s and R s. Unknown are s, R s, lambda, and of every instant a share of Q."""
    residual, elastic, bound, stresses = forces
    scale = float(bound.max(initial=0.0)) or 1.0
    (size, count), rings = elastic.shape, stresses.shape[1]
    # Of slip the unit is what makes a force of `scale` alone.
    unit = scale / np.diagonal(residual)
    beside = np.zeros((size + rings, 1 + rings * count))
    own = np.block(
        [
            [residual * unit / scale, -np.eye(size)],
            [stresses.T * unit / scale, np.zeros((rings, size))],
        ]
    )
    within = sparse.hstack(
        [
            sparse.csr_array((size * count, size)),
            sparse.kron(sparse.eye_array(size), np.ones((count, 1))),
            elastic.reshape(-1, 1) / scale,
            sparse.kron(stresses, sparse.eye_array(count)),
        ]
    )
    found = linprog(
        -(np.arange(within.shape[1]) == 2 * size).astype(float),
        A_ub=sparse.vstack([within, -within]),
        b_ub=np.tile(bound.ravel() / scale, 2),
        A_eq=np.hstack([own, beside]),
        b_eq=np.zeros(size + rings),
        bounds=(None, None),
        method="highs",
    )
    if found.status == UNBOUNDED:
        return np.inf, np.zeros(size), np.zeros(size)
    if not found.success:
        raise NoReferenceError(f"The linear program has no solution: {found.message}")
    return float(found.x[2 * size]), found.x[:size] * unit, found.x[size : 2 * size] * scale


UNBOUNDED = 3
"""Status of `linprog` where lambda may grow without end."""


def _forces(problem: Problem, some: slice) -> _Forces:
    """Give the forces of slip and of loads, on all points that rub and are not held.

    Jumps y = T y_b obey S y_b = T' f + q (`solver.reference.condensation`), and with a spring of
    compliance c in series y = s - c f. A point whose bound is nothing at all times has f = 0.
    """
    if problem.opens or sum(len(law.positions) for law in problem.rubbing.values()) > MOST_POINTS:
        raise NoReferenceError("The limit is that of known bounds, and of at most 1000 points.")
    condensed = Condensation(problem)
    rules = rules_of(problem).kept(condensed.moving)
    if rules.ages:
        raise NoReferenceError("Where friction changes with slip the theorem says nothing.")
    residual, elastic = condensed.stiffness, -condensed.load[:, some]
    stresses = condensed.stresses
    if rules.compliance.any():
        stresses = np.zeros((len(rules.compliance), 0))  # what gives way tells its own force
        stiff = 1.0 / rules.compliance[:, None]
        tied = stiff * condensed.ties.toarray()
        gives = np.linalg.solve(residual + condensed.ties.T @ tied, tied.T)
        residual = np.diagflat(stiff) - tied @ gives
        elastic = gives.T @ elastic - residual @ condensed.shift[:, some]
    rubs, free = np.flatnonzero(rules.bounded), np.flatnonzero(~rules.bounded)
    carried = np.linalg.solve(residual[np.ix_(free, free)], residual[np.ix_(free, rubs)]).T
    return _Forces(
        residual[np.ix_(rubs, rubs)] - carried @ residual[np.ix_(free, rubs)],
        elastic[rubs] - carried @ elastic[free],
        np.broadcast_to(rules.bound[rubs], (len(rubs), problem.n_instants))[:, some],
        stresses[rubs],
    )
