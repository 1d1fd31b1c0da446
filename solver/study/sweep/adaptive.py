"""Some points of a grid instead of all: those where the readings of a sweep bend most."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
from scipy.interpolate import Akima1DInterpolator, CloughTocher2DInterpolator, LinearNDInterpolator
from scipy.spatial import Delaunay, KDTree, QhullError

from solver.arrays import Array
from solver.definitions import SettingError
from solver.study.sweep.chart import is_wide
from solver.study.sweep.plan import Plan, Row

FIRST = 0.25
"""Share of the runs that are spread evenly: a bend between points that saw nothing is not found."""
FEWEST = 4
"""Points along an axis to begin with, and of a chart at all."""
DISTANCE = 0.02
"""Weight of the squared distance to the nearest point, for bends that nothing tells of yet."""
AT_ONCE = 0.1
"""Share of the runs that are under way at once; more would be chosen before much is known."""


class Chooser:
    """Next points of a sweep, as `following` of `sweep`, on the grid of its plan.

    It takes so many runs at most, those of which there are rows, by number, among them; whoever
    sweeps adds to these.

    Raises
    ------
    SettingError
        For settings that are no numbers, or too few runs.
    """

    def __init__(self, plan: Plan, most: int, rows: dict[int, Row]) -> None:
        if not all(axis.is_numeric and len(axis.values) > 1 for axis in plan.axes):
            ranges = f"ranges of numbers, not {[axis.name for axis in plan.axes]}"
            raise SettingError("--adaptive", most, ranges, "leave it out")
        if most < (least := FEWEST ** len(plan.axes)):
            raise SettingError("--adaptive", most, f"at least {least} runs", "raise it")
        self._most, self._rows, self._asked = min(most, plan.size), rows, set(rows)
        along = max(FEWEST, round((FIRST * most) ** (1.0 / len(plan.shape))))
        lines = [np.linspace(0, count - 1, along).round().astype(int) for count in plan.shape]
        even = np.ravel_multi_index(np.meshgrid(*lines, indexing="ij"), plan.shape)
        self._first = iter(even.ravel().tolist())
        grid = np.stack(np.unravel_index(np.arange(plan.size), plan.shape), axis=1)
        self._places = grid / (np.array(plan.shape) - 1.0)

    def __call__(self, under_way: int) -> list[int]:
        """Points to run besides those under way."""
        wanted, points = max(FEWEST, round(AT_ONCE * self._most)) - under_way, []
        for _ in range(min(wanted, self._most - len(self._asked))):
            even = next((number for number in self._first if number not in self._asked), None)
            points.append(self._best() if even is None else even)
            self._asked.add(points[-1])
        return points

    def _best(self) -> int:
        asked, numbers = np.array(sorted(self._asked)), np.array(list(self._rows), dtype=int)
        score = DISTANCE * KDTree(self._places[asked]).query(self._places)[0] ** 2
        for heights in np.array([row.values for row in self._rows.values()]).T:
            known = np.isfinite(heights)
            if known.sum() >= FEWEST and np.ptp(heights[known]) > 0.0:
                with suppress(QhullError):  # of points on one line
                    score = np.fmax(score, self._bend(numbers[known], heights[known], asked))
        score[asked] = -1.0
        return int(score.argmax())

    def _bend(self, numbers: Array, heights: Array, asked: Array) -> Array:
        """Distance of a smooth and a faceted surface over the range, at all points; NaN outside.

        Points under way are taken for what the smooth one says, so that the next lie elsewhere.
        """
        heights = np.log(heights) if is_wide(heights) else heights
        span, others = np.ptp(heights), np.setdiff1d(asked, numbers)
        believed = _surfaces(self._places[numbers], heights, self._places[others])[0]
        inside = np.isfinite(believed)
        places = self._places[np.concatenate([numbers, others[inside]])]
        heights = np.concatenate([heights, believed[inside]])
        return np.abs(np.subtract(*_surfaces(places, heights, self._places))) / span


def _surfaces(points: Array, heights: Array, at: Array) -> tuple[Array, Array]:
    """Smooth and faceted interpolation, (n,), from and to places of shape (n, n_axes)."""
    if points.shape[1] == 2:
        kinds = CloughTocher2DInterpolator, LinearNDInterpolator
        return tuple(kind(Delaunay(points), heights)(at) for kind in kinds)
    order, at = points[:, 0].argsort(), at[:, 0]
    x, heights = points[order, 0], heights[order]
    return Akima1DInterpolator(x, heights)(at), np.interp(at, x, heights)
