"""Friction of contacts that stay closed, in the space of their slips: where they may stick.

With all contacts closed their forces follow from the slips w of their points, f = S w - q(t), the
pressing ones, too. So what friction can hold at an instant is a polyhedron: two planes a point,

    |f_t| <= r + mu f_n    or    A w <= b(t),

which the load moves, and the slips are pushed by them. What lies inside at all instants of a cycle
may stay for ever. Where no slip changes what presses, the planes push slip there wherever it
begins, as Melan's theorem says; where slip does, that depends on the start, but for certain plane
problems below a critical mu (A. Klarbring, M. Ciavarella, J. R. Barber, Shakedown in elastic
contact problems with Coulomb friction, Int. J. Solids Struct. 44, 2007; L.-E. Andersson,
J. R. Barber, Y.-J. Ahn, Attractors in frictional systems subjected to periodic loads, SIAM J. Appl.
Math. 73, 2013).

The theorem is of complete contacts, all of whose points press at all times, and the space says so
itself: |f_t| <= mu f_n leaves no room where f_n < 0. A point that presses and does not rub, or
whose friction needs no pressing force, has a plane of its own, f_n >= 0. So between all planes the
contacts are closed, and beyond the largest swing there is no slip with which they stick and stay
closed: something slips, or opens, in every cycle, wherever it began.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.optimize import linprog

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.reference.condensation import Condensation, NoReferenceError
from solver.reference.rules import rules_of

SLACK = 1e-9
"""Share of its size by which rounding lets a corner lie beyond a plane."""
MOST_POINTS = 500
"""Points up to which the program, whose matrix is full, takes some seconds: 423 of ten layers 3.6,
769 of a block 26, 893 of twenty layers 145 (measured)."""
UNBOUNDED = 3
"""Status of `linprog` where the factor may grow without end."""


@dataclass(frozen=True, eq=False)
class SlipSpace:
    """The planes between which all points stick and press: A w <= b.

    Attributes
    ----------
    matrix
        A, shape (n_planes, n_points), N/m: where each point slips to negative w, where to positive,
        and where one opens whose friction does not say so.
    limit
        b, shape (n_planes, n_instants), N.
    """

    matrix: Array
    limit: Array


def slip_space(problem: Problem) -> SlipSpace:
    """Find the planes between which all points stick, and all contacts are closed.

    Points that a clamp holds, too, are left out.

    Raises
    ------
    NoReferenceError
        Where contacts give way before they slip, friction changes with slip, nothing rubs, forces
        do not follow from jumps, or there are too many points.
    """
    if sum(len(law.positions) for law in problem.rubbing.values()) > MOST_POINTS:
        raise NoReferenceError(f"The planes are those of at most {MOST_POINTS} points.")
    condensed = Condensation(problem)
    rules = rules_of(problem).kept(condensed.moving)
    is_whole = len(condensed.base) == len(condensed.moving) and not condensed.stresses.size
    if not is_whole or rules.compliance.any() or not rules.is_linear or rules.smooth.any():
        raise NoReferenceError(
            "The planes are those of Coulomb's friction, where forces follow from slips."
        )
    stiffness, rubs = _elastic(condensed), np.flatnonzero(~rules.normal)
    closed = np.where(rules.normal, -rules.gap, 0.0)
    still = (stiffness @ closed)[:, None] - condensed.load
    friction, pressing = rules.friction[rubs, None], rules.partner[rubs]
    carried, bound = friction * stiffness[np.ix_(pressing, rubs)], rules.bound[rubs]
    own, held = stiffness[np.ix_(rubs, rubs)], friction * still[pressing] + bound
    # Friction that takes pressing says so by itself.
    alone = np.setdiff1d(np.flatnonzero(rules.normal), pressing[~rules.bounded[rubs]])
    matrix = np.concatenate([own - carried, -own - carried, -stiffness[np.ix_(alone, rubs)]])
    limit = np.concatenate([held - still[rubs], held + still[rubs], still[alone]])
    force = problem.scales.force
    return SlipSpace(matrix * force / problem.scales.displacement, limit * force)


def _elastic(condensed: Condensation) -> Array:
    """Give S without what holds rigid motions: they are part of the slips, and cost nothing."""
    stiffness, gauge = condensed.stiffness, condensed.gauge
    # Each of these motions is held by a stiffness of its own.
    held = gauge * (gauge * (stiffness @ gauge)).sum(axis=0)
    return np.asarray(stiffness - held @ gauge.T)


def largest_swing(space: SlipSpace, some: slice) -> tuple[float, Array]:
    """Find how much a load may swing about its mean until no slip could stay, or a contact opens.

    Parameters
    ----------
    space
        The planes.
    some
        The instants of whole cycles, equally far apart.

    Returns
    -------
    factor
        On the load's distance from its mean over the time of the cycles; infinite where it stands
        still.
    slip
        One that stays under it, with all contacts closed, shape (n_points,), m.

    Raises
    ------
    NoReferenceError
        Where not even the mean of the load could be held.
    """
    limit = space.limit[:, some]
    mean = 0.5 * (limit[:, 1:] + limit[:, :-1]).mean(axis=1)
    least = (limit - mean[:, None]).min(axis=1)
    unit, scale = float(np.abs(space.matrix).max()), float(np.abs(limit).max()) or 1.0
    size = space.matrix.shape[1]
    found = linprog(
        -(np.arange(size + 1) == size).astype(float),
        A_ub=np.column_stack([space.matrix / unit, -least / scale]),
        b_ub=mean / scale,
        bounds=[(None, None)] * size + [(0.0, None)],
        method="highs",
    )
    if found.status == UNBOUNDED:
        return np.inf, np.zeros(size)
    if not found.success:
        raise NoReferenceError(f"No slip could stay under the mean of the load: {found.message}")
    return float(found.x[size]), found.x[:size] * scale / unit


def room_of_two(space: SlipSpace, some: slice) -> Array:
    """Find where two points may stay at all instants, between the lines that come farthest.

    Returns
    -------
    Corners in their order, shape (n_corners, 2), m; none where nothing is left.
    """
    matrix, limit = space.matrix, space.limit[:, some].min(axis=1)
    slack = SLACK * float(np.abs(space.limit).max(initial=0.0))
    found = []
    for pair in combinations(range(len(matrix)), 2):
        lines = matrix[list(pair)]
        if abs(np.linalg.det(lines)) > SLACK * np.abs(lines).max() ** 2:
            corner = np.linalg.solve(lines, limit[list(pair)])
            if np.all(matrix @ corner <= limit + slack):
                found.append(corner)
    if not found:
        return np.zeros((0, 2))
    corners = np.array(found)
    away = corners - corners.mean(axis=0)
    return np.asarray(corners[np.argsort(np.arctan2(away[:, 1], away[:, 0]))])
