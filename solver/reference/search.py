"""The minimum over one instant where friction has a known bound (solver/README.md, 6 and 14).

Where friction hardens or softens with slip the bound is linear in the slip increment v, b + g |v|,
between two points of its strength, so that, with G = diag(g),

    phi(v) = 1/2 v' (K + G) v - g' v + sum b |v|:

the same minimum, of a structure that is stiffer, or softer, where it slips. Which points of the
strength are passed within the instant is found by trial.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.linalg import LinAlgError

from solver.arrays import ROUNDING, Array, Flags, Indices
from solver.discrete.problem import Problem
from solver.reference.assembly import points_dofs
from solver.reference.band import Band, summed
from solver.reference.rules import Rules, rules_of

NEWTON_LIMIT = 8
"""Steps from one guess of the statuses before a better one is sought."""
TRIALS = 50
"""Sets of points of the strength that are passed, at most."""
COARSEST = 8
"""Degrees of freedom below which no coarser mesh is asked for a guess."""
HELD = 1e-13
"""Force that moves a rod as one by a unit, over the largest row of the stiffness, which is none."""
LEASH = 1e-10
"""Stiffness over the same that holds a loose rod for a step: it goes far, and keeps its digits."""


@dataclass(frozen=True, eq=False)
class Minimum:
    """Fields of shape (n_dofs,) at the minimum of phi, and its KKT residual, also relative."""

    increment: Array
    pull: Array
    status: Array
    violation: float
    residual: float


class _Guess(NamedTuple):
    """Statuses, with increment and pull where they are the minimum's, else the rods that change."""

    status: Array
    solved: tuple[Array, Array] | None
    changing: Flags


class Search:
    """Minimise phi where some degrees of freedom are held at zero.

    Newton's method for the statuses takes a few steps from a good guess, but a front then advances
    by one point a step, and the method may cycle. So it gives up early, and starts again from the
    statuses of a mesh twice as coarse, found in the same way. Where that fails too, an active-set
    method ends in finitely many steps. Rods that nothing ties to each other are solved together,
    but each on its own way: those whose statuses are found wait for the others.
    """

    def __init__(self, band: Band, bound: Array, movable: Array) -> None:
        self._band = band
        self._bound = bound
        self._movable = movable
        self.rubs = (bound > 0.0) * movable
        self._free = movable - self.rubs  # neither held nor rubbing
        self._limit = np.where(self.rubs > 0.0, bound, np.inf)
        self._starts = band.apart(movable)
        sizes = np.diff(self._starts, append=len(movable))
        self._rod = np.repeat(np.arange(len(sizes)), sizes)
        self._loose = self._loose_rods()

    def _loose_rods(self) -> Flags:
        """Rods that move as one without force, where nothing sticks."""
        is_whole = np.logical_and.reduceat(self._movable > 0.0, self._starts)
        if not is_whole.any():
            return is_whole
        pulled = np.abs(self._band.product(self._movable))
        return is_whole & (
            np.maximum.reduceat(pulled, self._starts) <= HELD * self._band.largest_row
        )

    def __call__(self, force: Array, status: Array) -> Minimum:
        """Minimum, sought from a guess of the statuses; no force where nothing moves."""
        guess = self._newton(force, status)
        if guess.solved is not None:
            return self._judged(force, guess.status, *guess.solved)
        rods, settled = guess.changing, guess.status
        if 2 * np.count_nonzero(rods) >= len(force):
            return self._of(force, self._mended(force, status))
        parts = Search(self._band.only(rods), self._bound[rods], self._movable[rods])
        settled[rods] = parts._mended(force[rods], status[rods])
        self._band.solutions += -(-parts._band.solutions * len(parts._bound) // len(force))
        return self._of(force, settled)

    def _of(self, force: Array, status: Array) -> Minimum:
        """Minimum whose statuses these are."""
        increment = self._slip(force, status)
        return self._judged(force, status, increment, force - self._band.product(increment))

    def _judged(self, force: Array, status: Array, increment: Array, pull: Array) -> Minimum:
        bound = self._bound
        held = np.where(status != 0.0, bound * status, np.minimum(np.maximum(pull, -bound), bound))
        violation = float((np.abs(pull - held) * self._movable).max())
        relative = violation / float(np.abs(force).sum()) if violation else 0.0
        return Minimum(increment, held, status, violation, relative)

    def _mended(self, force: Array, status: Array) -> Array:
        """Statuses where those of Newton's method do not come to rest."""
        if len(force) >= COARSEST:
            guess = self._newton(force, self._from_coarser(force, status))
            if guess.solved is not None:
                return guess.status
            status = guess.status
        return self._descend(force, status)

    def _guessed(self, force: Array, status: Array) -> Array:
        """Guess the statuses, where need be from those of a mesh that is coarser still."""
        guess = self._newton(force, status)
        if guess.solved is not None or len(force) < COARSEST:
            return guess.status
        again = self._from_coarser(force, status)
        return self._newton(force, np.where(guess.changing, again, guess.status)).status

    def _from_coarser(self, force: Array, status: Array) -> Array:
        coarser, group = self._coarser
        guess = coarser._guessed(summed(group, force), np.sign(summed(group, status)))
        return np.asarray(self.rubs * guess[group])

    def _newton(self, force: Array, status: Array) -> _Guess:
        largest = np.abs(force).max()
        changing = np.ones(len(status), dtype=bool)
        for _ in range(NEWTON_LIMIT):
            increment = self._slip(force, status)
            pull = force - self._band.product(increment)
            limit = self._limit + self._rounding(largest, increment)
            corrected = np.where(
                status != 0.0,
                status * (status * increment > 0.0),
                np.sign(pull) * (np.abs(pull) > limit),
            )
            changing = corrected != status
            if not changing.any():
                return _Guess(status, (increment, pull), changing)
            status = corrected
        return _Guess(status, None, np.logical_or.reduceat(changing, self._starts)[self._rod])

    @cached_property
    def _coarser(self) -> tuple[Search, Indices]:
        """The same structure with degrees of freedom of a rod tied in pairs; the pair of each."""
        places = np.arange(len(self._rod)) - self._starts[self._rod]
        begins = places % 2 == 0
        group = np.cumsum(begins) - 1
        movable = np.minimum(summed(group, self._movable), 1.0)
        band = self._band.tied(group, self._movable)
        return Search(band, summed(group, self._bound), movable), group

    def _slip(self, force: Array, status: Array) -> Array:
        """Solve for the increment under given statuses; exactly zero where they are zero.

        A loose rod of which all points slip goes as far as it has to for some of them to turn back.
        """
        keep, band = self._free + np.abs(status), self._band
        if self._loose.any():
            flies = self._loose & np.logical_and.reduceat(keep > 0.0, self._starts)
            if flies.any():
                leash = LEASH * band.largest_row
                band = band.stiffened(np.where(flies[self._rod], leash, 0.0))
                self._band.solutions += 1
        return band.solve_kept(keep, keep * (force - self._bound * status))

    def _rounding(self, largest: float, increment: Array) -> float:
        """What rounding leaves of a pull, where the largest force is given."""
        return ROUNDING * float(self._band.largest_row * np.abs(increment).max() + largest)

    def _descend(self, force: Array, status: Array) -> Array:
        """Minimise phi by an active-set method, every step of which lowers phi.

        A step ends where a first point stops, which then sticks; at a minimum over the slipping
        points that pulled most beyond its bound is released, and moves the way it is pulled.
        """
        rod = self._rod
        largest = np.abs(force).max()
        increment = self._slip(force, status)
        status = status * (status * increment > 0.0)
        increment *= self._free + np.abs(status)
        goes_on = np.ones(len(self._starts), dtype=bool)
        released = np.zeros(len(force), dtype=bool)
        while goes_on.any():
            target = self._slip(force, status)
            share = np.full(len(force), np.inf)
            turns = status * target < 0.0
            share[turns] = increment[turns] / (increment[turns] - target[turns])
            least = np.minimum.reduceat(share, self._starts)
            stops = goes_on & np.isfinite(least)
            first = self._first(share == least[rod], stops)
            # One that goes back before it has moved was released within rounding of its bound; but
            # one that was slipping may have stood still all the while.
            goes_on[rod[first[released[first] & (increment[first] == 0.0)]]] = False
            increment += np.where(stops, least, 1.0)[rod] * (target - increment)
            increment[first] = status[first] = 0.0
            released[first] = False
            status = np.where(stops[rod], status * (status * increment > 0.0), status)
            increment *= self._free + np.abs(status)
            points = self._release(force, increment, status, largest, goes_on & ~stops)
            released[points] = True
            goes_on &= stops | np.isin(np.arange(len(goes_on)), rod[points])
        return status

    def _release(
        self, force: Array, increment: Array, status: Array, largest: float, rods: Flags
    ) -> Indices:
        """Release the point of each rod that is pulled most beyond its bound; those released."""
        pull = force - self._band.product(increment)
        excess = np.where(status == 0.0, np.abs(pull) - self._limit, -np.inf)
        most = np.maximum.reduceat(excess, self._starts)
        beyond = rods & (most > self._rounding(largest, increment))
        points = self._first(excess == most[self._rod], beyond)
        status[points] = np.sign(pull[points])
        return points

    def _first(self, is_one: Flags, rods: Flags) -> Indices:
        """First of these degrees of freedom on each of the rods."""
        places = np.flatnonzero(is_one & rods[self._rod])
        return places[np.unique(self._rod[places], return_index=True)[1]]


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
            dofs, segment = bounds.dofs, bounds.rules.segment
            if np.array_equal(segment(end[dofs]), segment(reached[dofs])):
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
