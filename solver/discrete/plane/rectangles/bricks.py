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


def grid_of(bricks: Sequence[Brick]) -> tuple[int, int]:
    """Size of all bricks together, in elements along and up."""
    columns = max(brick.x + brick.columns for brick in bricks)
    rows = max(brick.y + brick.rows for brick in bricks)
    return columns, rows


class BrickJoint(NamedTuple):
    """Line along which two rectangles, or a rectangle and its support, touch.

    `above` is the number of the rectangle above or to the right, `below` that of the
    other one; None is the support. `first` and `last` are its ends on the grid, in
    elements. A joint between neighbours of a course is upright.
    """

    above: int
    below: int | None
    first: int
    last: int
    is_upright: bool = False

    @property
    def sides(self) -> list[tuple[int, str]]:
        """Rectangles and their sides at the joint; the upper or right one is first."""
        if self.is_upright:
            side_above = "left"
            side_below = "right"
        else:
            side_above = "bottom"
            side_below = "top"
        sides = [(self.above, side_above)]
        if self.below is not None:
            sides.append((self.below, side_below))
        return sides


def bonded(
    bond: Bond, columns: int, courses: int, size: tuple[int, int]
) -> list[Brick]:
    """Bricks of a wall: `columns` in each of the `courses`, from below.

    In a running bond every second course begins and ends with half a brick, in a stack
    bond all joints are one above the other. `size` is elements of a brick along, even
    in a running bond, and up.
    """
    along, up = size
    bricks = []
    for course in range(courses):
        widths = [along] * columns
        if bond == "running" and course % 2 == 1:
            half = along // 2
            widths = [half, *widths[1:], half]
        x = 0
        for width in widths:
            bricks.append(Brick(x, course * up, width, up))
            x += width
    return bricks


def with_opening(
    bricks: Sequence[Brick],
    size: tuple[int, int],
    bricks_along: tuple[int, int],
    courses: int,
) -> list[Brick]:
    """Bricks of a wall round an opening on the ground, with a lintel over it.

    `bricks` are those of the whole wall, `size` the elements of one along, which are
    even, and up. The opening is as many `courses` high, from the first of
    `bricks_along` in the lowest course to before the second. The lintel is the next
    course, and lies on half a brick at each end.
    """
    along, up = size
    left = bricks_along[0] * along
    right = bricks_along[1] * along
    half = along // 2
    lintel = Brick(left - half, courses * up, right - left + 2 * half, up)
    around = [lintel]
    for brick in bricks:
        course = brick.y // up
        if course < courses:
            around += _beside(brick, left, right)
        elif course == courses:
            around += _beside(brick, lintel.x, lintel.x + lintel.columns)
        else:
            around.append(brick)
    return sorted(around, key=lambda brick: (brick.y, brick.x))


def _beside(brick: Brick, left: int, right: int) -> list[Brick]:
    """Parts of a brick left and right of a range along, in elements."""
    end = brick.x + brick.columns
    parts = []
    for first, last in ((brick.x, min(end, left)), (max(brick.x, right), end)):
        if last > first:
            parts.append(brick._replace(x=first, columns=last - first))
    return parts


def grouped(bricks: Sequence[Brick], size: tuple[int, int], count: int) -> Indices:
    """Group of each brick, (n_bricks,), of `count` groups of neighbours.

    The largest group is halved across its longer direction until there are enough, or
    as many as bricks. `size` is elements of a brick along and up.
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


def joints_of(bricks: Sequence[Brick]) -> list[BrickJoint]:
    """All joints of rectangles that do not overlap, also those on the support.

    By the rectangle above: that on the support, lying ones, then upright ones.
    """
    lying = np.array(bricks).T
    joints = [
        BrickJoint(above, None, brick.x, brick.x + brick.columns)
        for above, brick in enumerate(bricks)
        if brick.y == 0
    ]
    # Upright joints are lying ones with both axes exchanged.
    for is_upright, (x, y, columns, rows) in enumerate((lying, lying[[1, 0, 3, 2]])):
        above, below = np.nonzero(y[:, None] == y + rows)
        ends = x + columns
        first = np.maximum(x[above], x[below])
        last = np.minimum(ends[above], ends[below])
        touches = last > first
        found = np.stack([above, below, first, last], axis=1)[touches]
        joints += [
            BrickJoint(above, below, first, last, bool(is_upright))
            for above, below, first, last in found.tolist()
        ]
    return sorted(joints, key=lambda joint: joint.above)
