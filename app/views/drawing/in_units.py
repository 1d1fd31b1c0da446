"""Drawings in the units that one reads; views give them in SI."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np

from app.picture.units import scale_of
from app.views.drawing.drawing import Axis, Colors, Curve, Drawing, Marks, QuadMesh

Placed = TypeVar("Placed", Curve, Marks)


def in_units(drawing: Drawing, units: str) -> Drawing:
    """Turn all that stands on axes, or is told by colours, into the chosen units."""
    # Bodies are to one scale, and what is alike on both axes is in one unit.
    alike = max(map(_size, (drawing.x, drawing.y))) if drawing.bodies else None
    x, across = _axis(drawing.x, units, alike)
    y, up = _axis(drawing.y, units, alike)
    colors, shade = _colors(drawing.colors, units)
    if across == up == shade == 1.0:
        return replace(drawing, x=x, y=y, colors=colors)
    image = drawing.image
    if image is not None:
        left, low = image.left / across, image.low / up
        width, height = image.width / across, image.height / up
        image = replace(image, left=left, low=low, width=width, height=height)
    return replace(
        drawing,
        x=x,
        y=y,
        curves=[_moved(one, across, up) for one in drawing.curves],
        marks=[_moved(one, across, up) for one in drawing.marks],
        image=image,
        bodies=drawing.bodies and _bodies(drawing.bodies, across, up, shade),
        colors=colors,
    )


def _size(axis: Axis | None) -> float:
    return max(-axis.low, axis.high) if axis else 0.0


def _axis(axis: Axis | None, units: str, size: float | None) -> tuple[Axis | None, float]:
    """Give an axis in a unit that suits it, and the size of that in SI."""
    if axis is None or not axis.unit:
        return axis, 1.0
    factor, unit = scale_of(_size(axis) if size is None else size, axis.unit, units)
    return replace(axis, low=axis.low / factor, high=axis.high / factor, unit=unit), factor


def _colors(colors: Colors | None, units: str) -> tuple[Colors | None, float]:
    if colors is None or not colors.unit:
        return colors, 1.0
    factor, unit = scale_of(max(-colors.low, colors.high), colors.unit, units)
    return Colors(colors.low / factor, colors.high / factor, unit), factor


def _moved(one: Placed, across: float, up: float) -> Placed:
    return replace(one, x=np.asarray(one.x) / across, y=np.asarray(one.y) / up)


def _bodies(bodies: QuadMesh, across: float, up: float, shade: float) -> QuadMesh:
    box = bodies.box
    fitted = replace(
        box,
        left=box.left / across,
        right=box.right / across,
        low=box.low / up,
        high=box.high / up,
        flattest=box.flattest / up,
    )
    places = (bodies.places / np.array([across, up])).astype(np.float32)
    return replace(bodies, places=places, values=bodies.values / np.float32(shade), box=fitted)
