"""All equilibria of one instant of a short rod,
by trying every status of every point.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from solver.reference.assembly import assembled_stiffness, external_force, points_dofs
from solver.reference.rules import rules_of

ROUNDING = 1e-9


def numbers_of_equilibria(solution):
    """How many equilibria each instant has after the instants before it, as they were
    solved.

    Of a rod on a support with friction that changes with slip. What is singular is left
    out: there a rod may lie anywhere.
    """
    problem = solution.problem
    numbers = []
    accumulated_slip, before = np.zeros((2, problem.n_dofs))
    for instant, now in enumerate(
        (solution.displacement / problem.scales.displacement).T
    ):
        numbers.append(len(equilibria(problem, instant, before, accumulated_slip)))
        accumulated_slip = accumulated_slip + np.abs(now - before)
        before = now
    return np.array(numbers)


def equilibria(problem, instant, before, accumulated_slip):
    """All increments of an instant, shape (n_equilibria, n_dofs), scaled.

    A point sticks, or slips either way and comes to rest between two points of the
    strength: for each choice of all points the problem is linear, and its solution
    shows whether the choice was right. All choices are solved side by side.
    """
    rules = rules_of(problem)
    dofs = points_dofs(problem)
    strength = rules.strength
    fixed, prescribed = problem.prescribed
    bound = np.zeros(problem.n_dofs)
    bound[dofs] = rules.bound_at(instant)
    stiffness = assembled_stiffness(problem).toarray()
    force = external_force(problem)[:, instant] - stiffness @ before
    rubbing = np.array([dof for dof in dofs if dof not in fixed and bound[dof] > 0.0])
    pieces = range(len(strength.slips))
    each = [(0, 0), *product((-1, 1), pieces)]
    choices = np.array(list(product(each, repeat=len(rubbing))))
    way = choices[..., 0]
    piece = choices[..., 1]
    slopes = strength.slopes
    ends = np.append(strength.slips[1:], np.inf)
    starts = np.array(strength.slips)
    factors = np.array(strength.factors)
    # The bound at the end of a slip is linear in it: what is left without slip, and the
    # slope.
    left = bound[rubbing] * (
        factors[piece] + slopes[piece] * (accumulated_slip[rubbing] - starts[piece])
    )
    slope = np.abs(way) * bound[rubbing] * slopes[piece]
    matrices = np.tile(stiffness, (len(choices), 1, 1))
    rights = np.tile(force, (len(choices), 1))
    matrices[:, rubbing, rubbing] += slope
    rights[:, rubbing] -= way * left
    held = np.zeros((len(choices), problem.n_dofs), dtype=bool)
    held[:, rubbing] = way == 0
    held[:, fixed] = True
    given = np.zeros(problem.n_dofs)
    given[fixed] = prescribed[:, instant] - before[fixed]
    matrices[held] = np.eye(problem.n_dofs)[np.nonzero(held)[1]]
    rights = np.where(held, given, rights)
    regular = np.linalg.cond(matrices) < 1e13
    way = way[regular]
    piece = piece[regular]
    moved = np.linalg.solve(matrices[regular], rights[regular][..., None])[..., 0]
    slack = ROUNDING * max(np.abs(force).max(), bound.max())
    pulled = np.abs(force - moved @ stiffness)[:, rubbing]
    slip = way * moved[:, rubbing]
    rests = accumulated_slip[rubbing] + slip
    sticks = pulled <= bound[rubbing] * strength(accumulated_slip[rubbing]) + slack
    slips = (slip > 0.0) & (starts[piece] <= rests) & (rests <= ends[piece])
    found = moved[np.where(way == 0, sticks, slips).all(axis=1)]
    size = np.abs(found).max(initial=0.0) or 1.0
    return np.unique(np.round(found / size, 8), axis=0) * size
