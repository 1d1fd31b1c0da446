"""Checks of rectangular bodies together, of their sides and supports."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from solver.checks import (
    ANY_NUMBER,
    NON_NEGATIVE,
    AnyOf,
    Count,
    InstanceOf,
    Numbers,
    SequenceOf,
    check_value,
)
from solver.discrete.plane.rectangles.bricks import Brick, grid_of
from solver.discrete.plane.rectangles.sides import Side, SideComponent, Support
from solver.refusal import RefusedError


def check_bricks(bricks: Sequence[Brick]) -> None:
    """Refuse rectangles off the grid, without elements, or over each other."""
    for number, brick in enumerate(bricks):
        check_value(f"Stack.bricks[{number}]", brick[:2], SequenceOf(Count(0), 2))
        check_value(f"Stack.bricks[{number}]", brick[2:], SequenceOf(Count(1), 2))
    taken = np.zeros(grid_of(bricks), dtype=bool)
    for number, (x, y, columns, rows) in enumerate(bricks):
        covered = taken[x : x + columns, y : y + rows]
        if covered.any():
            raise RefusedError(
                f"Stack.bricks[{number}]",
                [x, y, columns, rows],
                "bodies that lie beside each other",
                "it overlaps one before, move it",
            )
        covered[:] = True


def check_sides(sides: Mapping[str, Side], instants: int, strips: int) -> None:
    """Refuse displacements and tractions of other shapes than those of the instants.

    The displacement of the bottom may be that of each strip of ground.
    """
    over_time = Numbers(((instants,),))
    slope = AnyOf(ANY_NUMBER, over_time)
    for side, components in sides.items():
        mean = over_time
        if side == "bottom" and strips:
            mean = Numbers(((instants,), (strips, instants)))
        for component, given in zip("xy", components, strict=True):
            where = f"Stack.sides[{side!r}].{component}"
            check_value(where, given, InstanceOf(SideComponent))
            check_value(f"{where}.mean", given.mean, mean)
            check_value(f"{where}.slope", given.slope, slope)


def check_support(support: Support, bodies: int, nodes: int, instants: int) -> None:
    """Refuse fields of a support that do not fit the bodies, nodes and instants."""
    along = Numbers(((nodes,),))
    check_value("Stack.support.gap", support.gap, along)
    friction = AnyOf(NON_NEGATIVE, Numbers(along.shapes, low=0.0))
    check_value("Stack.support.friction", support.friction, friction)
    check_value("Stack.support.strips", support.strips, Count(0, bodies - 1))
    if support.strength is not None:
        strength = Numbers(((nodes, instants),), low=0.0)
        check_value("Stack.support.strength", support.strength, strength)
