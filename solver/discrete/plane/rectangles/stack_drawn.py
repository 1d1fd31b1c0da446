"""Arrows of loads and motions, and holds, of rectangular bodies for drawings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from solver.arrays import Array
from solver.discrete.plane.rectangles.bricks import Brick, grid_of
from solver.discrete.plane.rectangles.sides import Side, SideComponent, Spring, Support
from solver.discrete.structure import MOVED, OUTWARD, Act, Hold, on_side


def _open_sides(sides: Mapping[str, Side], support: Support | None) -> dict[str, Side]:
    """Outer sides by name, without the bottom if there is a support."""
    open_sides = dict(sides)
    if support is not None:
        del open_sides["bottom"]
    return open_sides


def acts_on_sides(
    sides: Mapping[str, Side], support: Support | None, rectangles: Sequence[Brick]
) -> Iterator[Act]:
    """Yield loads and prescribed displacements of sides.

    A displacement that is one of several sides is drawn at the first of them.
    """
    drawn: list[tuple[int, SideComponent]] = []
    for name, side in _open_sides(sides, support).items():
        for component, given in enumerate(side):
            is_same = [
                across == component and given is other for across, other in drawn
            ]
            if given.prescribed and any(is_same):
                continue
            drawn.append((component, given))
            yield _act_on_side(given, name, component, rectangles)


def _act_on_side(
    given: SideComponent, side: str, component: int, rectangles: Sequence[Brick]
) -> Act:
    """Arrow of a load or displacement of a side, at both ends if it is not uniform."""
    is_normal = OUTWARD[side][component] != 0.0
    along = "xy"[component]
    towards = ((1.0, 0.0), (0.0, 1.0))[component]
    values = given.mean
    if given.prescribed:
        symbol = MOVED[component]
        unit = "m"
    elif given.is_pressure:
        symbol = "p"
        unit = "Pa"
        x, y = OUTWARD[side]
        towards = (-x, -y)
        values = -OUTWARD[side][component] * values
    elif is_normal:
        symbol = "σ"
        unit = "Pa"
    else:
        symbol = "τ"
        unit = "Pa"
    # Arrows along a side are next to those across it.
    shares = [0.15]
    if is_normal:
        shares = [0.7]
    if np.any(given.slope):
        shares = [0.0, 1.0]
        values = np.stack([given.mean - given.slope, given.mean + given.slope])
    elif is_normal and not given.prescribed:
        shares = [0.15, 0.5, 0.85]
    return Act(
        where=f"{side} {along}",
        symbol=symbol,
        points=_on_bodies(side, on_side(side, shares), rectangles),
        towards=towards,
        values=values,
        unit=unit,
    )


def _on_bodies(side: str, points: Array, rectangles: Sequence[Brick]) -> Array:
    """Points on a side, moved up or down onto the outline of the bodies.

    Shape (n, 2) both, as shares of the length and height of all bodies.
    """
    x, y, columns, rows = np.array(rectangles).T
    points = points.copy()
    along, up = grid_of(rectangles)
    for point in points:
        position = point[0] * along
        is_there = (x <= position) & (position <= x + columns)
        low = y[is_there].min() / up
        high = (y + rows)[is_there].max() / up
        if side == "top":
            low = high
        elif side == "bottom":
            high = low
        point[1] = low + point[1] * (high - low)
    return points


def act_of_ground(settlement: Array, strips: Sequence[Brick], columns: int) -> Act:
    """Arrow of the settlement of strips of ground, in the middle of the largest one.

    `settlement` is that of each strip, shape (n_strips, n_instants), m; `columns` are
    the elements along all bodies.
    """
    size = np.abs(settlement).max(axis=1)
    lowest = [
        strip
        for strip, moved in zip(strips, size.tolist(), strict=True)
        if moved == size.max()
    ]
    first = lowest[0].x
    last = lowest[-1].x + lowest[-1].columns
    middle = 0.5 * (first + last) / columns
    return Act(
        where="bottom y",
        symbol=MOVED[1],
        points=on_side("bottom", [middle]),
        towards=(0.0, -1.0),
        values=settlement[size.argmax()],
        unit="m",
    )


def holds_of(
    sides: Mapping[str, Side], support: Support | None, spring: Spring | None
) -> Iterator[Hold]:
    """Yield the support, clamps and rollers at sides, and the spring."""
    if support is not None:
        yield Hold("support", "bottom", gap=support.gap)
    for name, side in _open_sides(sides, support).items():
        is_still = [given.prescribed and given.is_zero for given in side]
        if all(is_still):
            yield Hold("clamp", name)
        elif any(is_still):
            yield Hold("rollers", name)
    if spring is not None:
        yield Hold("spring", "right")
