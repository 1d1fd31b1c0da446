"""Rods whose friction hardens or softens with slip: one instant (solver/README.md, 14).

Below the slip length the bound is linear in the slip increment v, b + g |v|, so that

    phi(v) = 1/2 v' (K + G) v - g' v + sum b |v|,

with G = diag(g): the same minimum, of a structure that is stiffer, or softer, where it slips. Which
points pass the slip length within the instant is found by trial; their bound is the last.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.linalg import LinAlgError

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem
from solver.reference.band import Band
from solver.reference.search import Minimum, Search
from solver.reference.states import rules_of
from solver.reference.supports import points_dofs

TRIALS = 50
"""Sets of points that pass the slip length, at most."""


@dataclass(frozen=True, eq=False)
class Bounds:
    """Friction bounds of degrees of freedom at one instant, shape (n_dofs,) each, scaled.

    Attributes
    ----------
    first, last
        Before any slip, and after the slip length.
    length
        Slip length; infinite where slip changes nothing.
    """

    first: Array
    last: Array
    length: Array

    @cached_property
    def stay(self) -> bool:
        """Whether slip changes nothing."""
        return bool(np.array_equal(self.first, self.last))

    @property
    def slope(self) -> Array:
        """Growth of the bound per slip, below the slip length."""
        return np.asarray((self.last - self.first) / self.length)

    def at(self, gone: Array, some: Indices) -> Array:
        """Give the bounds of some after slip, both of shape (n,)."""
        if self.stay:
            return self.first[some]
        share = np.minimum(gone / self.length[some], 1.0)
        return np.asarray(self.first[some] + (self.last - self.first)[some] * share)


def bounds_of(problem: Problem) -> list[Bounds]:
    """Give the bounds of all interfaces, which are on supports.

    Returns
    -------
    Those of every instant, or of all where they stay the same.
    """
    dofs, rules = points_dofs(problem), rules_of(problem)
    first, ratio = np.zeros((problem.n_dofs, rules.bound.shape[1])), np.ones(problem.n_dofs)
    length = np.full(problem.n_dofs, np.inf)
    first[dofs], ratio[dofs], length[dofs] = rules.bound, rules.ratio, rules.slip_length
    return [Bounds(own, own * ratio, length) for own in np.ascontiguousarray(first.T)]


def least_with_changing_bound(
    band: Band, bounds: Bounds, movable: Array, force: Array, status: Array, gone: Array
) -> Minimum | None:
    """Minimum that the instant before certainly goes over into, None where that is not sure.

    It is sure if the structure is stable where points slip, however far they have softened on the
    way: then no other minimum slips there alone.
    """
    before = passes = gone >= bounds.length
    for _ in range(TRIALS):
        slope = np.where(passes, 0.0, bounds.slope) * movable
        bound = np.where(passes, bounds.last, bounds.first + bounds.slope * gone) * movable
        softer = band.stiffened(slope)
        search = Search(softer, bound, movable)
        try:
            least = search(force, status * search.rubs)
            slip = np.abs(least.increment)
            corrected = gone + slip >= bounds.length
            if np.array_equal(corrected, passes):
                softest = band.stiffened(np.where(before, 0.0, bounds.slope) * movable)
                softest.solve_kept(movable * (slip > 0.0), np.zeros_like(force))
                pull = least.pull + slope * least.increment
                return replace(least, pull=pull)
        except LinAlgError:
            return None
        finally:
            band.solutions += softer.solutions
        passes, status = corrected, least.status
    return None
