"""The minimum over one instant where friction has a known bound (solver/README.md, 6)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from solver.arrays import ROUNDING, Array
from solver.reference.band import Band, pairs

NEWTON_LIMIT = 8
"""Steps from one guess of the statuses before a better one is sought."""
COARSEST = 8
"""Degrees of freedom below which no coarser mesh is asked for a guess."""


@dataclass(frozen=True, eq=False)
class Minimum:
    """Fields of shape (n_dofs,) at the minimum of phi, and its KKT residual, also relative."""

    increment: Array
    pull: Array
    status: Array
    violation: float
    residual: float


class _Guess(NamedTuple):
    """Statuses that were sought, with increment and pull if they are those of the minimum."""

    status: Array
    solved: tuple[Array, Array] | None


class Search:
    """Minimise phi where some degrees of freedom are held at zero.

    Newton's method for the statuses takes a few steps from a good guess, but a front then advances
    by one point a step, and the method may cycle. So it gives up early, and starts again from the
    statuses of a mesh twice as coarse, found in the same way. Where that fails too, an active-set
    method ends in finitely many steps.
    """

    def __init__(self, band: Band, bound: Array, movable: Array) -> None:
        self._band = band
        self._bound = bound
        self._movable = movable
        self.rubs = (bound > 0.0) * movable
        self._free = movable - self.rubs  # neither held nor rubbing
        self._limit = np.where(self.rubs > 0.0, bound, np.inf)

    def __call__(self, force: Array, status: Array) -> Minimum:
        """Find the minimum from a guess of the statuses; no force where nothing moves."""
        status, solved = self._sought(force, status)
        if solved is None:
            return self.released(force, status)
        return self._judged(force, status, *solved)

    def released(self, force: Array, status: Array) -> Minimum:
        """Find the minimum from statuses, releasing or stopping one point after the other."""
        status = self._descend(force, status)
        increment = self._slip(force, status)
        return self._judged(force, status, increment, force - self._band.product(increment))

    def _judged(self, force: Array, status: Array, increment: Array, pull: Array) -> Minimum:
        bound = self._bound
        held = np.where(status != 0.0, bound * status, np.minimum(np.maximum(pull, -bound), bound))
        violation = float((np.abs(pull - held) * self._movable).max())
        relative = violation / float(np.abs(force).sum()) if violation else 0.0
        return Minimum(increment, held, status, violation, relative)

    def _sought(self, force: Array, status: Array) -> _Guess:
        """Seek the statuses, from a guess, and from that of a coarser mesh if need be."""
        found = self._newton(force, status)
        if found.solved is not None or len(force) < COARSEST:
            return found
        coarse = self._coarser._sought(pairs(force), np.sign(pairs(status)))
        return self._newton(force, self.rubs * np.repeat(coarse.status, 2)[: len(force)])

    def _newton(self, force: Array, status: Array) -> _Guess:
        largest = np.abs(force).max()
        for _ in range(NEWTON_LIMIT):
            increment = self._slip(force, status)
            pull = force - self._band.product(increment)
            limit = self._limit + self._rounding(largest, increment)
            corrected = np.where(
                status != 0.0,
                status * (status * increment > 0.0),
                np.sign(pull) * (np.abs(pull) > limit),
            )
            if (corrected == status).all():
                return _Guess(status, (increment, pull))
            status = corrected
        return _Guess(status, None)

    @cached_property
    def _coarser(self) -> Search:
        """The same structure with each two successive degrees of freedom tied together."""
        movable = np.minimum(pairs(self._movable), 1.0)
        band = self._band.tied_in_pairs(self._movable, movable)
        return Search(band, pairs(self._bound), movable)

    def _slip(self, force: Array, status: Array) -> Array:
        """Solve for the increment under given statuses; exactly zero where they are zero."""
        keep = self._free + np.abs(status)
        return self._band.solve_kept(keep, keep * (force - self._bound * status))

    def _rounding(self, largest: float, increment: Array) -> float:
        """Give what rounding leaves of a pull, where the largest force is given."""
        return ROUNDING * float(self._band.largest_row * np.abs(increment).max() + largest)

    def _descend(self, force: Array, status: Array) -> Array:
        """Minimise phi by an active-set method, every step of which lowers phi.

        A step ends where a first point stops, which then sticks; at a minimum over the slipping
        points, the point pulled most beyond its bound is released, and moves the way it is
        pulled. So no set of statuses has its minimum reached twice.
        """
        largest = np.abs(force).max()
        increment = self._slip(force, status)
        status = status * (status * increment > 0.0)
        increment *= self._free + np.abs(status)
        while True:
            target = self._slip(force, status)
            stops = np.flatnonzero(status * target < 0.0)
            if len(stops):
                share = increment[stops] / (increment[stops] - target[stops])
                first = stops[share.argmin()]
                if increment[first] == 0.0:  # released a moment ago, within rounding of its bound
                    status[first] = 0.0
                    return status
                increment += share.min() * (target - increment)
                increment[first] = 0.0
                status = status * (status * increment > 0.0)
                increment *= self._free + np.abs(status)
                continue
            increment = target
            pull = force - self._band.product(increment)
            excess = np.where(status == 0.0, np.abs(pull) - self._limit, -np.inf)
            most = int(excess.argmax())
            if excess[most] <= self._rounding(largest, increment):
                return status
            status[most] = np.sign(pull[most])
