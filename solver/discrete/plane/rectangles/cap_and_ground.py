"""Further bodies of a wall: a stiff cap, and strips of ground that settle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from solver.arrays import Array
from solver.discrete.plane.rectangles.bricks import Brick
from solver.discrete.plane.rectangles.sides import Side, SideComponent, Support
from solver.discrete.plane.rectangles.stack import Stack

CAP_STIFFNESS = 1e5
"""Young's modulus of a cap over that of the bricks."""


def with_cap(stack: Stack, rows: int, *, is_guided: bool) -> Stack:
    """Add a cap on top of bricks, as the last body.

    It is `rows` elements high. A guided one stays level: its ends stand out by an
    element, and move as far along as the top does.
    """
    columns, top = stack.grid
    sides = dict(stack.sides)
    out = 0
    if is_guided:
        out = 1
        free = SideComponent(False, np.zeros_like(stack.instants))
        sides["left"] = Side(sides["top"].x, free)
        sides["right"] = sides["left"]
    bricks = [brick._replace(x=brick.x + out) for brick in stack.rectangles]
    bricks.append(Brick(0, top, columns + 2 * out, rows))
    stiffness = np.ones(len(bricks))
    stiffness[-1] = CAP_STIFFNESS
    groups = stack.groups
    if groups is not None:
        groups = np.append(groups, groups.max() + 1)
    return replace(
        stack, bricks=bricks, stiffness=stiffness, groups=groups, sides=sides
    )


def on_strips(
    stack: Stack, ends: tuple[int, int], settlement: Array, friction: float
) -> Stack:
    """Add strips of ground below bricks; strips between two ends settle.

    Parameters
    ----------
    stack
        The bricks, without a support.
    ends
        Ends of the ground that settles, in elements from the left end of the lowest
        course.
    settlement
        Distance by which it goes down over time, shape (n_instants,), m.
    friction
        Coefficient mu between the bricks and the ground.
    """
    begin = min(brick.x for brick in stack.rectangles if brick.y == 0)
    first = begin + ends[0]
    last = begin + ends[1]
    strips = strips_below(stack.rectangles, (first, last))
    middles = np.array([strip.x + 0.5 * strip.columns for strip in strips])
    is_settled = (middles > first) & (middles < last)
    moved = SideComponent(True, -np.outer(is_settled, settlement))
    still = SideComponent(True, np.zeros_like(stack.instants))
    above = [brick._replace(y=brick.y + 1) for brick in stack.rectangles]
    stiffness = stack.stiffness
    if stiffness is not None:
        stiffness = np.concatenate([np.ones(len(strips)), stiffness])
    groups = stack.groups
    if groups is not None:
        numbers = groups.max() + 1 + np.arange(len(strips))
        groups = np.concatenate([numbers, groups])
    gap = np.zeros(stack.grid[0] + 1)
    return replace(
        stack,
        bricks=[*strips, *above],
        stiffness=stiffness,
        groups=groups,
        support=Support(gap, friction, strips=len(strips)),
        sides={**stack.sides, "bottom": Side(still, moved)},
    )


def strips_below(bricks: Sequence[Brick], ends: tuple[int, int]) -> list[Brick]:
    """Strips of ground below the lowest bricks, which begin at y = 0, from the left.

    Each is below a single brick, and ends where that does or at the `ends`, in
    elements. They have one row of elements: neighbours then have no pair of nodes.
    """
    strips = []
    for brick in bricks:
        if brick.y:
            continue
        last = brick.x + brick.columns
        cuts = [end for end in sorted(ends) if brick.x < end < last]
        for left, right in pairwise([brick.x, *cuts, last]):
            if right > left:
                strips.append(Brick(left, 0, right - left, 1))
    return strips
