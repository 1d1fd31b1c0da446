"""Rectangles on a grid of equal elements, and the joints where their sides meet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from solver.arrays import Indices

Bond = Literal["running", "stack"]


class Brick(NamedTuple):
    """A rectangle on the grid: its lower left corner and its size, in elements."""

    x: int
    y: int
    columns: int
    rows: int

    def nodes(self) -> tuple[slice, slice]:
        """Its nodes along and up, among those of the grid."""
        x = self.x
        y = self.y
        return slice(x, x + self.columns + 1), slice(y, y + self.rows + 1)


class Joint(NamedTuple):
    """Where two rectangles touch, or one its support, between two ends on the grid, in elements.

    Of numbers of the one above, or to the right, and of the other; None is the support.
    One between neighbours of a course is upright.
    """

    above: int
    below: int | None
    first: int
    last: int
    is_upright: bool = False

    @property
    def sides(self) -> list[tuple[int, str]]:
        """Rectangles of the joint and their sides there, the one above or to the right first."""
        if self.is_upright:
            above = "left"
            below = "right"
        else:
            above = "bottom"
            below = "top"
        return [
            (self.above, above),
            *([] if self.below is None else [(self.below, below)]),
        ]


def bonded(
    bond: Bond, columns: int, courses: int, size: tuple[int, int]
) -> list[Brick]:
    """Bricks of a wall, course by course from below: of so many in a course, and courses.

    In a running bond every second course begins and ends with a half, in a stack bond
    all joints are one above the other. `size` is elements of a brick along, even in a
    running bond, and up.
    """
    along, up = size
    bricks = []
    for course in range(courses):
        halves = bond == "running" and course % 2 == 1
        half = [along // 2] * halves
        x = 0
        for width in [*half, *[along] * (columns - halves), *half]:
            bricks.append(Brick(x, course * up, width, up))
            x += width
    return bricks


def with_opening(
    bricks: Sequence[Brick],
    size: tuple[int, int],
    bricks_along: tuple[int, int],
    courses: int,
) -> list[Brick]:
    """Bricks round an opening that stands on the ground, so many courses high, with a lintel.

    Of the bricks of the whole wall and the elements of one, even along it;
    `bricks_along` are the first of the lowest course that is left out, and the first
    behind these. The lintel is the next course, and lies on half a brick at each end.
    """
    along, up = size
    left, right = (number * along for number in bricks_along)
    half = along // 2
    lintel = Brick(left - half, courses * up, right - left + 2 * half, up)
    found = [lintel]
    for brick in bricks:
        course = brick.y // up
        end = brick.x + brick.columns
        first = left
        last = right
        if course == courses:
            first = lintel.x
            last = lintel.x + lintel.columns
        elif course > courses:
            first = last = end
        for start, stop in ((brick.x, min(end, first)), (max(brick.x, last), end)):
            if stop > start:
                found.append(brick._replace(x=start, columns=stop - start))
    return sorted(found, key=lambda brick: (brick.y, brick.x))


def grouped(bricks: Sequence[Brick], size: tuple[int, int], count: int) -> Indices:
    """Group of each brick, of `count` groups: the largest is halved where it is longest.

    There are as many as bricks at most; `size` is elements of one along and up.
    """
    x, y, columns, rows = np.array(bricks).T
    centres = np.stack([(x + 0.5 * columns) / size[0], (y + 0.5 * rows) / size[1]])
    groups = np.zeros(len(bricks), dtype=np.intp)
    for number in range(1, min(count, len(bricks))):
        members = np.flatnonzero(groups == np.bincount(groups).argmax())
        longest = int(np.ptp(centres[:, members], axis=1).argmax())
        order = np.lexsort((centres[1 - longest, members], centres[longest, members]))
        groups[members[order[len(order) // 2 :]]] = number
    return groups


def joints_of(bricks: Sequence[Brick]) -> list[Joint]:
    """All joints of rectangles that do not overlap: with the support, beds, and upright ones."""
    lying = np.array(bricks).T
    upright = lying[[1, 0, 3, 2]]
    joints = []
    for above, brick in enumerate(bricks):
        if brick.y == 0:
            joints.append(Joint(above, None, brick.x, brick.x + brick.columns))
        for is_upright, (x, y, columns, rows) in enumerate((lying, upright)):
            ends = x + columns
            for below in np.flatnonzero(y + rows == y[above]).tolist():
                first = int(max(x[above], x[below]))
                last = int(min(ends[above], ends[below]))
                if last > first:
                    joints.append(Joint(above, below, first, last, bool(is_upright)))
    return joints
