"""All equilibria of one instant of a short rod, by trying every status."""

from __future__ import annotations

from itertools import product

import numpy as np

from solver.reference.assembly import assembled_stiffness, external_force, points_dofs
from solver.reference.rules import rules_of

ROUNDING = 1e-9


def numbers_of_equilibria(solution):
    """Number of equilibria of each instant, after the instants before it as solved.

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
    factor over slip: for each choice of all points the problem is linear, and its
    solution shows whether the choice was right. All choices are solved side by side.
    """
    tried = _Instant(problem, instant, before, accumulated_slip)
    direction, piece = tried.choices()
    moved, is_regular = tried.increments(direction, piece)
    is_right = tried.obeys(moved, direction[is_regular], piece[is_regular])
    found = moved[is_right]
    size = np.abs(found).max(initial=0.0) or 1.0
    return np.unique(np.round(found / size, 8), axis=0) * size


class _Instant:
    """Linear problems of one instant, one for each choice of statuses.

    A choice has a direction for each point that rubs, -1, 0 (it sticks) or 1, and the
    piece of the factor on which its slip ends; shape (n_choices, n_rubbing) each.
    """

    def __init__(self, problem, instant, before, accumulated_slip):
        fixed, prescribed = problem.prescribed
        rules = rules_of(problem)
        dofs = points_dofs(problem)
        bound = np.zeros(problem.n_dofs)
        bound[dofs] = rules.bound_at(instant)
        free = np.setdiff1d(dofs, fixed)
        self._fixed = fixed
        self._given = prescribed[:, instant] - before[fixed]
        self._slip_factor = rules.slip_factor
        self._stiffness = assembled_stiffness(problem).toarray()
        self._force = external_force(problem)[:, instant] - self._stiffness @ before
        self._rubbing = free[bound[free] > 0.0]
        self._bound = bound[self._rubbing]
        self._slipped = accumulated_slip[self._rubbing]
        self._slack = ROUNDING * max(np.abs(self._force).max(), bound.max())

    def choices(self):
        """All choices: directions and pieces."""
        pieces = range(len(self._slip_factor.slips))
        each = [(0, 0), *product((-1, 1), pieces)]
        choices = np.array(list(product(each, repeat=len(self._rubbing))))
        return choices[..., 0], choices[..., 1]

    def increments(self, direction, piece):
        """Solution of each choice, (n_regular, n_dofs), and which choices have one."""
        starts = np.array(self._slip_factor.slips)[piece]
        factors = np.array(self._slip_factor.factors)[piece]
        slopes = self._slip_factor.slopes[piece]
        # The bound at the end of a slip is linear in it: what is left without slip, and
        # the slope.
        left = self._bound * (factors + slopes * (self._slipped - starts))
        n_choices = len(direction)
        matrices = np.tile(self._stiffness, (n_choices, 1, 1))
        rights = np.tile(self._force, (n_choices, 1))
        rubbing = self._rubbing
        matrices[:, rubbing, rubbing] += np.abs(direction) * self._bound * slopes
        rights[:, rubbing] -= direction * left
        self._hold(matrices, rights, direction)
        is_regular = np.linalg.cond(matrices) < 1e13
        columns = rights[is_regular][..., None]
        return np.linalg.solve(matrices[is_regular], columns)[..., 0], is_regular

    def _hold(self, matrices, rights, direction):
        """Write what sticks, and what is prescribed, into systems in place."""
        held = np.zeros(rights.shape, dtype=bool)
        held[:, self._rubbing] = direction == 0
        held[:, self._fixed] = True
        given = np.zeros(rights.shape[1])
        given[self._fixed] = self._given
        matrices[held] = np.eye(len(given))[np.nonzero(held)[1]]
        rights[:] = np.where(held, given, rights)

    def obeys(self, moved, direction, piece):
        """Check which solutions, (n, n_dofs), are what was chosen, (n,)."""
        slip_factor = self._slip_factor
        pulled = np.abs(self._force - moved @ self._stiffness)[:, self._rubbing]
        slip = direction * moved[:, self._rubbing]
        rests = self._slipped + slip
        starts = np.array(slip_factor.slips)[piece]
        ends = np.append(slip_factor.slips[1:], np.inf)[piece]
        bound = self._bound * slip_factor(self._slipped)
        sticks = pulled <= bound + self._slack
        slips = (slip > 0.0) & (starts <= rests) & (rests <= ends)
        return np.where(direction == 0, sticks, slips).all(axis=1)
