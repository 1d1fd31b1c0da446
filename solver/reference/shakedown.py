"""Shakedown limit: the load up to which slip can cease (Melan, for friction).

**Known bounds** (A. Klarbring, M. Ciavarella, J. R. Barber, Shakedown in elastic
contact problems with Coulomb friction, Int. J. Solids Struct. 44, 2007): slip that
stays leaves forces behind that keep all others within the bound b at all instants
(MATHEMATICS.md, 15). The matrix from slip to these is regular, so that they may be
any. The limit holds wherever the slip begins.

**In the plane** slip changes what presses. With all contacts closed their forces follow
from the slips w of their points, f = S w - q(t), the pressing ones, too. So what
friction can hold at an instant is a polyhedron, |f_t| <= r + mu f_n or A w <= b(t),
which the load moves, and the slips are pushed by its planes. What lies inside at all
instants of a cycle may stay for ever. Where slip changes what presses, whether it comes
to that depends on the start, but for certain plane problems below a critical mu
(Klarbring et al.; L.-E. Andersson, J. R. Barber, Y.-J. Ahn, Attractors in frictional
systems subjected to periodic loads, SIAM J. Appl. Math. 73, 2013).

A point that presses and does not rub, or whose friction needs no pressing force, has a
plane of its own, f_n >= 0: between all planes the contacts are closed. Beyond the
largest swing there is no slip with which they stick and stay closed: something slips,
or opens, in every cycle.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
import scipy
from scipy import sparse

from solver.arrays import Array, largest_size
from solver.discrete.problem import Problem
from solver.reference.assembly import NoReferenceError, jumps
from solver.reference.condensation import Condensation
from solver.reference.rules import rules_of

MOST_KNOWN = 1000
"""Largest number of points of known bound whose matrices, which are full, take no more
than some seconds."""
FELT = 1e-9
"""Share of the largest bound up to which a force that changes is rounding, as for
HiGHS."""
SLACK = 1e-9
"""Share of its size by which rounding lets a corner lie beyond a plane."""
MOST_POINTS = 500
"""Points up to which the program of the plane, whose matrix is full, takes some
seconds: 423 of ten layers 3.6, 769 of a block 26, 893 of twenty layers 145
(measured)."""
UNBOUNDED = 3
"""Status of `linprog` where the factor may grow without limit."""


def driven_limit(problem: Problem, cycle: slice) -> float:
    """Largest factor on all motions in a cycle at which what they drive does not slip.

    It is that of points whose jumps prescribed displacements alone make, as at an end
    that is moved over its support: zero if such a point moves with nothing that gives
    way, and infinite without such points.
    """
    rules = rules_of(problem)
    fixed, prescribed = problem.prescribed
    all_jumps = jumps(problem)
    free = np.ones(problem.n_dofs)
    free[fixed] = 0.0
    is_driven = abs(all_jumps) @ free == 0.0
    driven = np.flatnonzero(is_driven & ~rules.normal & ~rules.is_frictionless)
    jump = all_jumps[driven][:, fixed] @ prescribed[:, cycle]
    is_moved = np.ptp(jump, axis=1) > FELT * largest_size(prescribed)
    driven = driven[is_moved]
    if not driven.size:
        return np.inf
    compliance = rules.compliance[driven, None]
    if not compliance.all():
        return 0.0
    bound = _bound_in(cycle, rules.bound[driven], problem)
    return _limit_of_points(jump[is_moved] / compliance, bound)


def _bound_in(cycle: slice, bound: Array, problem: Problem) -> Array:
    """Bounds of points at the instants of a cycle, (n_points, n_instants), scaled."""
    return np.broadcast_to(bound, (len(bound), problem.n_instants))[:, cycle]


def shakedown_limit(problem: Problem, cycle: slice) -> float:
    """Largest factor on all loads of rods in a cycle under which slip ceases.

    It is infinite where the loads stay the same, or nothing that rubs feels them.

    Raises
    ------
    NoReferenceError
        Where bounds depend on the pressing force or on slip, or there are too many
        points.
    """
    if problem.opens or problem.contacts.n_points > MOST_KNOWN:
        raise NoReferenceError(
            f"The limit is that of known bounds, and of at most {MOST_KNOWN} points."
        )
    # Jumps y = T y_b obey S y_b = T' f + q, and with a spring of compliance c in series
    # y = s - c f. A point whose bound is nothing at all times has f = 0.
    condensed = Condensation(problem)
    rules = condensed.rules
    if rules.changes_with_slip:
        raise NoReferenceError(
            "Where friction changes with slip the theorem says nothing."
        )
    residual, elastic, rings = _forces_of_slips(condensed, cycle)
    rubs = np.flatnonzero(rules.bounded)
    free = np.flatnonzero(~rules.bounded)
    carried = np.linalg.solve(
        residual[np.ix_(free, free)], residual[np.ix_(free, rubs)]
    ).T
    elastic = elastic[rubs] - carried @ elastic[free]
    bound = _bound_in(cycle, rules.bound[rubs], problem)
    if rings.shape[1]:
        limit = _limit_in_rings(elastic, bound, rings[rubs])
    else:
        limit = _limit_of_points(elastic, bound)
    # Points that are driven have no unknown jump.
    return min(limit, driven_limit(problem, cycle))


def _forces_of_slips(
    condensed: Condensation, cycle: slice
) -> tuple[Array, Array, Array]:
    """Forces of points by slips, by loads, and initially; scaled.

    Returns
    -------
    Stiffness from slips to forces, shape (n, n); forces of the loads where nothing
    slips, shape (n, n_instants of the cycle); and forces that move nothing, shape (n,
    n_stresses).
    """
    rules = condensed.rules
    gauge = condensed.gauge
    # A motion that nothing holds has a stiffness of its own, so that S is definite.
    size = float(np.diagonal(condensed.stiffness).mean())
    stiffness = condensed.stiffness + size * gauge @ gauge.T
    elastic = -condensed.load[:, cycle]
    if not rules.compliance.any():
        return stiffness, elastic, condensed.stresses
    # A force through a spring in series moves the structure and the spring.
    springs = 1.0 / rules.compliance[:, None]
    tied = springs * condensed.ties.toarray()
    gives = np.linalg.solve(stiffness + condensed.ties.T @ tied, tied.T)
    residual = np.diagflat(springs) - tied @ gives
    elastic = gives.T @ elastic - residual @ condensed.shift[:, cycle]
    # The force of a spring in series is determinate.
    return residual, elastic, np.zeros((len(rules.compliance), 0))


def _limit_of_points(elastic: Array, bound: Array) -> float:
    """Limit by the worst point, which slips in both directions beyond it.

    Forces of the loads and bounds have the shape (n_points, n_instants), scaled.
    """
    factor = np.inf
    felt = FELT * (largest_size(bound) or 1.0)
    # Slip that stays shifts all instants alike: only differences between two are fixed.
    for force, limit in zip(elastic.T, bound.T, strict=True):
        swing = np.abs(elastic - force[:, None])
        is_felt = swing > felt
        room = (bound + limit[:, None])[is_felt] / swing[is_felt]
        factor = min(factor, float(room.min(initial=np.inf)))
    return factor


def _limit_in_rings(elastic: Array, bound: Array, rings: Array) -> float:
    """Limit with self-stresses in rings, different at each instant.

    Forces of the loads and bounds have the shape (n_points, n_instants), scaled; forces
    round rings (n_points, n_stresses).
    """
    size, count = elastic.shape
    # HiGHS works with absolute tolerances, so numbers are brought near 1.
    scale = largest_size(bound) or 1.0
    within = sparse.hstack(
        [
            sparse.kron(sparse.eye_array(size), np.ones((count, 1))),
            elastic.reshape(-1, 1) / scale,
            sparse.kron(rings, sparse.eye_array(count)),
        ]
    )
    solution = _largest(
        size, sparse.vstack([within, -within]), np.tile(bound.ravel() / scale, 2)
    )
    if solution.status == UNBOUNDED:
        return np.inf
    return float(solution.x[size])


def _largest(
    place: int, matrix: Array | sparse.sparray, limit: Array
) -> scipy.optimize.OptimizeResult:
    """Largest value, at least zero, of the unknown at a place, with matrix x <= limit.

    With a matrix of shape (n_rows, n_unknowns), and limits of shape (n_rows,).
    """
    bounds = np.tile([-np.inf, np.inf], (matrix.shape[1], 1))
    bounds[place, 0] = 0.0
    aim = np.zeros(matrix.shape[1])
    aim[place] = -1.0
    solution = scipy.optimize.linprog(
        aim, A_ub=matrix, b_ub=limit, bounds=bounds, method="highs"
    )
    if not solution.success and solution.status != UNBOUNDED:
        raise NoReferenceError(f"No slip could stay: {solution.message}")
    return solution


@dataclass(frozen=True, eq=False)
class SlipSpace:
    """Set of slips w, A w <= b, for which all points stick and press.

    Attributes
    ----------
    matrix
        A, shape (n_planes, n_points), N/m: one plane for slip of each point to negative
        w, one for slip to positive w, and one for the opening of each point whose
        friction does not need the normal force.
    limit
        b, shape (n_planes, n_instants), N.
    """

    matrix: Array
    limit: Array


def slip_space(problem: Problem) -> SlipSpace:
    """Set of slips for which all points stick, and all contacts are closed.

    Points that a clamp holds, too, are left out.

    Raises
    ------
    NoReferenceError
        Where contacts are compliant, friction changes with slip, nothing
        rubs, forces do not follow from jumps, or there are too many points.
    """
    if problem.contacts.n_points > MOST_POINTS:
        raise NoReferenceError(f"The planes are those of at most {MOST_POINTS} points.")
    condensed = Condensation(problem)
    if not _is_of_coulomb(condensed):
        raise NoReferenceError(
            "The planes are those of Coulomb's friction, where forces follow from "
            "slips."
        )
    rules = condensed.rules
    stiffness = condensed.stiffness
    rubs = np.flatnonzero(~rules.normal)
    pressing = rules.partner[rubs]
    # Forces where nothing slips.
    closed = np.where(rules.normal, -rules.gap, 0.0)
    still = (stiffness @ closed)[:, None] - condensed.load
    friction = rules.friction[rubs, None]
    carried = friction * stiffness[np.ix_(pressing, rubs)]
    tangential = stiffness[np.ix_(rubs, rubs)]
    held = friction * still[pressing] + rules.bound[rubs]
    # Friction that needs the normal force ends where the contact opens.
    alone = np.setdiff1d(np.flatnonzero(rules.normal), pressing[~rules.bounded[rubs]])
    matrix = np.concatenate(
        [tangential - carried, -tangential - carried, -stiffness[np.ix_(alone, rubs)]]
    )
    limit = np.concatenate([held - still[rubs], held + still[rubs], still[alone]])
    force = problem.scales.force
    return SlipSpace(matrix * force / problem.scales.displacement, limit * force)


def _is_of_coulomb(condensed: Condensation) -> bool:
    """Check whether friction is Coulomb's, and forces are determined by jumps."""
    rules = condensed.rules
    is_whole = len(condensed.base) == len(condensed.moving)
    if not is_whole or condensed.stresses.size:
        return False
    if rules.compliance.any() or rules.is_nonlinear:
        return False
    return not rules.bonds.size and not bool(rules.is_frictionless.any())


def largest_swing(space: SlipSpace, cycle: slice) -> tuple[float, Array]:
    """Largest factor on the swing of a load about its mean for which slip can cease.

    Returns
    -------
    The factor on the load's distance from its mean over the instants of whole cycles,
    equally far apart, infinite where the load stands still; and a slip that stays under
    it, shape (n_points,), m.

    Raises
    ------
    NoReferenceError
        Where not even the mean of the load could be held.
    """
    limit = space.limit[:, cycle]
    mean = 0.5 * (limit[:, 1:] + limit[:, :-1]).mean(axis=1)
    lowest = (limit - mean[:, None]).min(axis=1)
    # Near 1, as HiGHS has absolute tolerances.
    unit = float(np.abs(space.matrix).max())
    scale = float(np.abs(limit).max()) or 1.0
    size = space.matrix.shape[1]
    matrix = np.column_stack([space.matrix / unit, -lowest / scale])
    solution = _largest(size, matrix, mean / scale)
    if solution.status == UNBOUNDED:
        return np.inf, np.zeros(size)
    return float(solution.x[size]), solution.x[:size] * scale / unit


def persistent_slips(space: SlipSpace, cycle: slice) -> Array:
    """Polygon of slips of two points that can persist at all instants.

    Returns
    -------
    Corners in their order, shape (n_corners, 2), m; no corner where no slip may stay.
    """
    matrix = space.matrix
    limit = space.limit[:, cycle].min(axis=1)
    slack = SLACK * float(np.abs(space.limit).max(initial=0.0))
    corners = []
    # A corner is where two lines meet and no other line cuts it off.
    for pair in combinations(range(len(matrix)), 2):
        lines = matrix[list(pair)]
        if abs(np.linalg.det(lines)) > SLACK * np.abs(lines).max() ** 2:
            corner = np.linalg.solve(lines, limit[list(pair)])
            if np.all(matrix @ corner <= limit + slack):
                corners.append(corner)
    if not corners:
        return np.zeros((0, 2))
    away = (corners - np.mean(corners, axis=0)).T
    return np.array(corners)[np.argsort(np.arctan2(away[1], away[0]))]
