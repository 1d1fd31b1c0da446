"""The distance of a run to results of another program: one definition for page and command.

Our field is linear between its points and between its instants; so it has a value w(x, t) at every
row of the table, which has v. With d = w - v,

    distance = |d| / |v|,    |d|^2 = sum over instants of their weight times the mean of d^2 there.

The mean is over the points of that instant, each of which counts as half of the distance to its
neighbours does; an instant has the trapezoidal weight of the table's own instants. So rows may lie
anywhere, in any order, and a place that is sampled densely counts no more for that. What only one
of both covers is left out: rows beside the body or the run, or where our force is an arbitrary
share of what a support holds. Where v vanishes everywhere, |w| stands in its place.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem
from solver.reference.distance import Fields, determinate_forces
from solver.study.other_programs.brought import EDGE, FEWEST, FRICTION, Brought


class Beside:
    """A table laid beside the runs of one problem.

    Parameters
    ----------
    brought
        The table.
    problem
        What is solved.
    interface
        The one whose friction is compared; the first one if there is none of this name.

    Attributes
    ----------
    brought
        The table.
    interface
        Name of the interface.
    counted
        Number of rows that both cover.
    """

    def __init__(self, brought: Brought, problem: Problem, interface: str = "") -> None:
        names = list(problem.rubbing)
        self.brought = brought
        self.interface = interface if interface in names else names[0]
        self._of_friction = brought.quantity == FRICTION
        positions, known = problem.positions, None
        if self._of_friction:
            law = problem.rubbing[self.interface]
            self._places = problem.contact_places[self.interface][-1]
            self._sizes = law.by_point(law.weights)[:, None]
            positions, known = law.positions, determinate_forces(problem)[self._places]
        order = np.argsort(positions, kind="stable")
        lower, upper, share = _between(positions[order], brought.positions)
        self._points = order[lower], order[upper]
        *self._instants, part = _between(problem.instants, brought.times)
        corners = [one * two for two in (1.0 - part, part) for one in (1.0 - share, share)]
        counts = _covers(positions, brought.positions) & _covers(problem.instants, brought.times)
        if known is not None:
            for (points, instants), weight in zip(self._corners(), corners, strict=True):
                counts &= known[points, instants] | (weight == 0.0)
        self.counted = int(counts.sum())
        self._points = self._points[0][counts], self._points[1][counts]
        self._instants = [one[counts] for one in self._instants]
        self._shares = [one[counts] for one in corners]
        self._values = brought.values[counts]
        self._weights = weights_of(brought.positions[counts], brought.times[counts])

    def of(self, fields: Fields) -> float:
        """Distance to an iterate, or to a reference; NaN of fewer than `FEWEST` rows."""
        if self.counted < FEWEST:
            return float("nan")
        own = self.own(fields)
        size = self._norm(self._values) or self._norm(own) or 1.0
        return self._norm(own - self._values) / size

    def own(self, fields: Fields) -> Array:
        """Our field at the rows that both cover, shape (n_counted,)."""
        field = fields.displacement
        if self._of_friction:
            field = fields.contact_force[self._places] / self._sizes
        values = np.zeros(self.counted)
        for (points, instants), share in zip(self._corners(), self._shares, strict=True):
            values += share * field[points, instants]
        return values

    def _corners(self) -> list[tuple[Indices, Indices]]:
        (lower, upper), (before, after) = self._points, self._instants
        return [(lower, before), (upper, before), (lower, after), (upper, after)]

    def _norm(self, values: Array) -> float:
        largest = float(np.abs(values).max(initial=0.0))
        if largest == 0.0:
            return 0.0
        return largest * float(np.sqrt(self._weights @ (values / largest) ** 2))


def weights_of(positions: Array, times: Array) -> Array:
    """What every row counts, as above, shape (n_rows,)."""
    order = np.lexsort((positions, times))
    instants, number = np.unique(times[order], return_inverse=True)
    own = _halves(positions[order], np.diff(number) == 0)
    lengths = np.bincount(number, own, len(instants))
    # All points of an instant may be one.
    own[lengths[number] == 0.0] = 1.0
    lengths = np.bincount(number, own, len(instants))
    over_time = _halves(instants) if len(instants) > 1 else np.ones(len(instants))
    weights = np.empty(len(times))
    weights[order] = over_time[number] * own / lengths[number]
    return weights


def _covers(grid: Array, places: Array) -> NDArray[np.bool_]:
    """Which places lie between the ends of a grid."""
    low, high = float(grid.min()), float(grid.max())
    edge = EDGE * (high - low)
    return np.asarray((places >= low - edge) & (places <= high + edge))


def _between(grid: Array, places: Array) -> tuple[Indices, Indices, Array]:
    """The grid points below and above places, and the share of the one above."""
    upper = np.clip(np.searchsorted(grid, places, side="right"), 1, len(grid) - 1)
    lower = upper - 1
    width = grid[upper] - grid[lower]
    share = np.divide(places - grid[lower], width, out=np.zeros(len(places)), where=width > 0.0)
    return lower, upper, np.clip(share, 0.0, 1.0)


def _halves(places: Array, joined: NDArray[np.bool_] | bool = True) -> Array:
    """Half of the distances to the neighbours, of places that rise where they are joined."""
    steps = np.diff(places) * joined
    halves = np.zeros(len(places))
    halves[:-1] += 0.5 * steps
    halves[1:] += 0.5 * steps
    return halves
