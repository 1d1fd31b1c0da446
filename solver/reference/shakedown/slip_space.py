"""Friction of contacts that stay closed, in the space of their slips: where they may stick.

With all contacts closed their forces follow from the slips w of their points, f = S w - q(t), the
pressing ones, too. So what friction can hold at an instant is a polyhedron: two planes a point,

    |f_t| <= r + mu f_n    or    A w <= b(t),

which the load moves, and the slips are pushed by them. What lies inside at all instants of a cycle
may stay for ever. Where no slip changes what presses, the planes push slip there wherever it
begins, as Melan's theorem says; where slip does, that depends on the start (A. Klarbring,
M. Ciavarella, J. R. Barber, Shakedown in elastic contact problems with Coulomb friction, Int. J.
Solids Struct. 44, 2007; L.-E. Andersson, J. R. Barber, Y.-J. Ahn, Attractors in frictional systems
subjected to periodic loads, SIAM J. Appl. Math. 73, 2013).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.optimize import linprog

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.reference.condensation import Condensation, NoReferenceError
from solver.reference.states import rules_of

SLACK = 1e-9
"""Share of its size by which rounding lets a corner lie beyond a plane."""
UNBOUNDED = 3
"""Status of `linprog` where the factor may grow without end."""


@dataclass(frozen=True, eq=False)
class SlipSpace:
    """The planes between which all points stick: A w <= b.

    Attributes
    ----------
    matrix
        A, shape (2 n_points, n_points), N/m: where each point slips to negative w, and to positive.
    limit
        b, shape (2 n_points, n_instants), N.
    """

    matrix: Array
    limit: Array


def slip_space(problem: Problem) -> SlipSpace:
    """Find the planes between which all points stick, while all contacts are closed.

    Points that a clamp holds, too, are left out.

    Raises
    ------
    NoReferenceError
        Where contacts give way before they slip, friction changes with slip, jumps depend on each
        other, or bodies are held by contact alone.
    """
    condensed = Condensation(problem)
    rules = rules_of(problem).kept(condensed.moving)
    is_whole = len(condensed.base) == len(condensed.moving)
    if not is_whole or condensed.gauge.size or rules.compliance.any() or np.any(rules.ratio != 1.0):
        raise NoReferenceError(
            "The planes are those of Coulomb's friction, on bodies that are held."
        )
    stiffness, rubs = condensed.stiffness, np.flatnonzero(~rules.normal)
    closed = np.where(rules.normal, -rules.gap, 0.0)
    still = (stiffness @ closed)[:, None] - condensed.load
    friction, pressing = rules.friction[rubs, None], rules.partner[rubs]
    carried, bound = friction * stiffness[np.ix_(pressing, rubs)], rules.bound[rubs]
    own, held = stiffness[np.ix_(rubs, rubs)], friction * still[pressing] + bound
    matrix = np.concatenate([own - carried, -own - carried])
    limit = np.concatenate([held - still[rubs], held + still[rubs]])
    force = problem.scales.force
    return SlipSpace(matrix * force / problem.scales.displacement, limit * force)


def largest_swing(space: SlipSpace, some: slice) -> tuple[float, Array]:
    """Find how much a load may swing about its mean until no slip could stay.

    Parameters
    ----------
    space
        The planes.
    some
        The instants of a cycle.

    Returns
    -------
    factor
        On the load's distance from its mean over the cycle; infinite where it stands still.
    slip
        One that stays under it, shape (n_points,), m.

    Raises
    ------
    NoReferenceError
        Where not even the mean of the load could be held.
    """
    limit = space.limit[:, some]
    mean = limit.mean(axis=1)
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
