"""Sampling of a sweep where its answer bends: some points of the grid instead of all."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable, Iterator

import numpy as np

from solver.arrays import Array
from solver.definitions import SettingError
from solver.running.pool import Pool
from solver.study.sweep.chart import is_wide
from solver.study.sweep.drive import AHEAD, Schedule
from solver.study.sweep.plan import Plan
from solver.study.sweep.point import Row

FIRST = 0.25
"""Share of the runs that are spread evenly: a bend between points that saw nothing is not found."""
FEWEST = 4
"""Points along an axis to begin with, and of a chart at all."""
DISTANCE = 0.02
"""Weight of the squared distance to the nearest point, for bends that nothing tells of yet."""


def sweep_adaptively(
    plan: Plan,
    pool: Pool,
    most: int,
    *,
    known: Iterable[Row] = (),
    limit: float = math.inf,
    fields: str | None = None,
) -> Iterator[Row]:
    """Run points of a plan where its readings bend most, by all that is known by then.

    Parameters
    ----------
    plan
        Its grid is how finely points may lie.
    pool, limit, fields
        As for `sweep`.
    most
        Runs in all, the known ones among them.
    known
        Rows that there are.

    Yields
    ------
    Rows as they come, as `sweep` does.

    Raises
    ------
    SettingError
        For settings that are no numbers, or too few runs.
    """
    chooser = Chooser(plan, most)
    for row in known:
        chooser.tell(row)
    course = Schedule(plan, pool, limit, fields, False, deque())
    try:
        while True:
            course.waiting.extend(chooser.ask(AHEAD * pool.width - len(course.pieces)))
            if not course.send():
                return
            for row in course.hear():
                chooser.tell(row)
                yield row
    finally:
        course.cancel()


class Chooser:
    """Which point of a grid tells most: where a smooth surface and a faceted one differ most.

    Points under way are taken for what the smooth surface says, so that the next lie elsewhere.
    """

    def __init__(self, plan: Plan, most: int) -> None:
        least = FEWEST ** len(plan.axes)
        if not all(axis.is_numeric and len(axis.values) > 1 for axis in plan.axes):
            names = [axis.name for axis in plan.axes]
            raise SettingError(
                "--adaptive", most, f"ranges of numbers, not {names}", "leave it out"
            )
        if most < least:
            raise SettingError("--adaptive", most, f"at least {least} runs", "raise it")
        self._plan, self._most = plan, min(most, plan.size)
        self._places = _places(plan.shape)
        self._asked: set[int] = set()
        self._distance = np.full(plan.size, np.inf)
        self._rows: dict[int, Row] = {}
        self._first = deque(_spread(plan.shape, FIRST * most))

    def tell(self, row: Row) -> None:
        """Take note of a row."""
        self._take(row.number)
        self._rows[row.number] = row

    def ask(self, number: int) -> list[int]:
        """Give the next points, as many as asked for or as there may be."""
        found = []
        for _ in range(min(number, self._most - len(self._asked))):
            point = self._next()
            self._take(point)
            found.append(point)
        return found

    def _take(self, point: int) -> None:
        """Note that a point is asked for, and how far the others are from it."""
        self._asked.add(point)
        apart = ((self._places - self._places[point]) ** 2).sum(axis=1)
        self._distance = np.minimum(self._distance, apart)

    def _next(self) -> int:
        while self._first:
            point = self._first.popleft()
            if point not in self._asked:
                return point
        asked = np.array(sorted(self._asked))
        score = DISTANCE * self._distance
        for place in range(len(self._plan.readings)):
            score = np.maximum(score, self._bend(place, asked))
        score[asked] = -1.0
        return int(np.argmax(score))

    def _bend(self, place: int, asked: Array) -> Array:
        """Tell how far the two surfaces of a reading are apart, over its range, at every point."""
        values = {
            number: row.values[place]
            for number, row in self._rows.items()
            if math.isfinite(row.values[place])
        }
        known = np.array(sorted(values))
        heights = np.array([values[number] for number in known], dtype=float)
        if len(known) < FEWEST or np.ptp(heights) == 0.0:
            return np.zeros(len(self._places))
        heights = np.log(heights) if is_wide(heights) else heights
        heights = heights / np.ptp(heights)
        under_way = np.setdiff1d(asked, [*self._rows])
        believed = self._surfaces(known, heights, under_way)[0]
        holds = np.isfinite(believed)
        smooth, faceted = self._surfaces(
            np.concatenate([known, under_way[holds]]),
            np.concatenate([heights, believed[holds]]),
            slice(None),
        )
        return np.nan_to_num(np.abs(smooth - faceted))

    def _surfaces(self, points: Array, heights: Array, where: Array | slice) -> tuple[Array, Array]:
        """Lay a smooth and a faceted surface through points; NaN outside of them."""
        # to load them takes a quarter of a second, which other commands need not wait
        from scipy.interpolate import (
            Akima1DInterpolator,
            CloughTocher2DInterpolator,
            LinearNDInterpolator,
        )
        from scipy.spatial import Delaunay

        order = np.argsort(points)
        x, heights = self._places[points[order]], heights[order]
        there = self._places[where]
        if len(self._plan.axes) == 1:
            smooth = Akima1DInterpolator(x[:, 0], heights)(there[:, 0])
            return smooth, np.interp(there[:, 0], x[:, 0], heights)
        facets = Delaunay(x)
        smooth = CloughTocher2DInterpolator(facets, heights)(there)
        return smooth, LinearNDInterpolator(facets, heights)(there)


def _places(shape: tuple[int, ...]) -> Array:
    """Give the points of a grid in the unit square, shape (n_points, n_axes)."""
    lines = [np.linspace(0.0, 1.0, count) for count in shape]
    return np.stack([axis.ravel() for axis in np.meshgrid(*lines, indexing="ij")], axis=1)


def _spread(shape: tuple[int, ...], wanted: float) -> list[int]:
    """Spread some points evenly over a grid, its corners among them."""
    along = max(FEWEST, round(wanted ** (1.0 / len(shape))))
    lines = [np.unique(np.linspace(0, count - 1, along).round().astype(int)) for count in shape]
    chosen = np.meshgrid(*lines, indexing="ij")
    return [int(number) for number in np.ravel_multi_index(chosen, shape).ravel()]
