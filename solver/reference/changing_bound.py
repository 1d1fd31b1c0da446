"""Rods whose friction hardens or softens with slip: one instant (solver/README.md, 14).

Between two points of its strength the bound is linear in the slip increment v, b + g |v|, so that

    phi(v) = 1/2 v' (K + G) v - g' v + sum b |v|,

with G = diag(g): the same minimum, of a structure that is stiffer, or softer, where it slips. Which
points of the strength are passed within the instant is found by trial.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.linalg import LinAlgError

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem
from solver.reference.assembly import points_dofs
from solver.reference.band import Band
from solver.reference.rules import Rules, rules_of
from solver.reference.search import Minimum, Search

TRIALS = 50
"""Sets of points of the strength that are passed, at most."""


@dataclass(frozen=True, eq=False)
class Bounds:
    """Friction bounds of degrees of freedom at one instant.

    Attributes
    ----------
    first
        Before any slip, shape (n_dofs,), scaled.
    dofs
        Those that rub, shape (n,).
    rules
        What says how slip changes their bounds.
    """

    first: Array
    dofs: Indices
    rules: Rules

    @property
    def stay(self) -> bool:
        """Whether slip changes nothing."""
        return not self.rules.ages

    def at(self, gone: Array) -> Array:
        """Bounds after accumulated slip, shape (n_dofs,) both."""
        bounds = self.first.copy()
        if self.rules.ages:
            bounds[self.dofs] *= self.rules.factor(gone[self.dofs])
        return bounds

    def growth(self, first: Array, last: Array) -> Array:
        """Least growth of the bound per slip on the way from one slip to another, (n_dofs,)."""
        growths = np.zeros_like(self.first)
        dofs = self.dofs
        growths[dofs] = self.first[dofs] * self.rules.lowest_growth(first[dofs], last[dofs])
        return growths


def bounds_of(problem: Problem) -> list[Bounds]:
    """Bounds of all interfaces, which are on supports: of every instant, or of all alike."""
    dofs, rules = points_dofs(problem), rules_of(problem)
    first = np.zeros((problem.n_dofs, rules.bound.shape[1]))
    first[dofs] = rules.bound
    return [Bounds(bound, dofs, rules) for bound in np.ascontiguousarray(first.T)]


def least_with_changing_bound(
    band: Band, bounds: Bounds, movable: Array, force: Array, status: Array, gone: Array
) -> Minimum | None:
    """Minimum that the instant before certainly goes over into, None where that is not sure.

    It is sure if the structure is stable where points slip, however far they have softened on the
    way: then no other minimum slips there alone.
    """
    end = gone
    for _ in range(TRIALS):
        slope = bounds.growth(end, end) * movable
        bound = (bounds.at(end) - slope * (end - gone)) * movable
        softer = band.stiffened(slope)
        try:
            least = Search(softer, bound, movable)(force, status * (bound > 0.0))
            reached = gone + np.abs(least.increment)
            if _same(bounds, end, reached):
                softest = band.stiffened(bounds.growth(gone, reached) * movable)
                slips = movable * (least.increment != 0.0)
                softest.solve_kept(slips, np.zeros_like(force))
                if np.any(bound[slips > 0.0] < 0.0):
                    return None
                return replace(least, pull=least.pull + slope * least.increment)
        except LinAlgError:
            return None
        finally:
            band.solutions += softer.solutions
        end, status = reached, least.status
    return None


def _same(bounds: Bounds, first: Array, second: Array) -> bool:
    """Whether all slips are between the same points of the strength."""
    dofs, segment = bounds.dofs, bounds.rules.segment
    return np.array_equal(segment(first[dofs]), segment(second[dofs]))
