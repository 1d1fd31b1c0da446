"""What holds a structure and what acts on it, as a picture of the scene shows it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from app.worker.portrait import PITCH, THICKNESS
from solver.arrays import Array
from solver.discrete.rods import Rods
from solver.discrete.stack import Given, Side, Stack
from solver.scenes import behind
from solver.settings import Settings

OUTWARD = {
    "left": (-1.0, 0.0),
    "right": (1.0, 0.0),
    "bottom": (0.0, -1.0),
    "top": (0.0, 1.0),
}


@dataclass(frozen=True, eq=False)
class Act:
    """A force, or a displacement, that is given.

    Attributes
    ----------
    symbol
        What it is called.
    places
        Where on the undeformed body, shape (n, 2), m.
    towards
        Direction of positive values, a unit vector, or one of each instant, (2, n_instants).
    away
        Direction in which there is room for an arrow, a unit vector.
    values
        Over time, shape (n_instants,) or, of each place, (n, n_instants).
    unit
        Of the values.
    setting
        Name of the setting that scales them, or empty.
    where
        On which side, and along which axis, as "top, x".
    """

    symbol: str
    places: Array
    towards: tuple[float, float] | Array
    away: tuple[float, float]
    values: Array
    unit: str
    setting: str = ""
    where: str = ""


def size_of(data: Rods | Stack) -> tuple[float, float]:
    """Give the length and the height of all bodies as they are drawn, m."""
    if isinstance(data, Rods):
        return data.length, data.length * (PITCH * (data.wires - 1) + THICKNESS)
    return data.length, data.bodies * data.height


def acts_on(data: Rods | Stack, settings: Settings) -> list[Act]:
    """Give all that acts and is not zero throughout."""
    found = _on_rods(data, settings) if isinstance(data, Rods) else _on_stack(data)
    names = behind(settings)
    return [
        replace(act, setting=names.get(where, ""), where=where.replace(" ", ", "))
        for where, act in found
        if np.any(act.values)
    ]


def _on_rods(data: Rods, settings: Settings) -> Iterator[tuple[str, Act]]:
    """Give what acts, each with where it does."""
    length, height = size_of(data)
    end, start = np.array([[length, 0.5 * height]]), np.array([[0.0, 0.5 * height]])
    right = OUTWARD["right"]
    if data.rigid_grip:
        moved = data.load * data.length / data.stiffness
        yield "right x", Act("u", end, right, right, moved, "m")
    else:
        yield "right x", Act("F", end, right, right, data.load, "N")
    if data.support is not None:
        yield "left x", Act("u", start, right, OUTWARD["left"], data.support, "m")
    if data.body_force is not None:
        middle = np.array([[0.5 * length, height]])
        yield "body", Act("b", middle, right, right, data.body_force, "N/m")
    pressure = np.full(len(data.instants), float(settings.values()["pressure"]))
    pressed = np.interp([0.1, 0.3, 0.5, 0.7, 0.9], data.nodes / length, data.bound) > 0.0
    x = np.array([0.1, 0.3, 0.5, 0.7, 0.9])[pressed] * length
    if len(x):
        places = np.stack([x, np.full_like(x, height)], axis=1)
        yield "top y", Act("p", places, OUTWARD["bottom"], OUTWARD["top"], pressure, "N/m")


def _on_stack(data: Stack) -> Iterator[tuple[str, Act]]:
    """Give what acts, each with where it does."""
    length, height = size_of(data)
    for name, side in data.sides.items():
        if name == "bottom" and data.support is not None:
            continue
        first, last = ends_of(name, length, height)
        for component, given in enumerate((side.x, side.y)):
            act = _given(given, first, last, component, OUTWARD[name])
            yield f"{name} {'xy'[component]}", act
    if data.body_force is not None:
        middle = np.array([[0.5 * length, 0.5 * height]])
        size = np.hypot(*data.body_force)
        towards = data.body_force / np.where(size > 0.0, size, 1.0)
        yield "body", Act("W", middle, towards, (1.0, 0.0), size * length * height, "N")


def _given(
    given: Given, first: Array, last: Array, component: int, away: tuple[float, float]
) -> Act:
    """Show what is given along a side: evenly in the middle, unevenly at both ends."""
    towards = (1.0, 0.0) if component == 0 else (0.0, 1.0)
    unit = "m" if given.prescribed else "Pa"
    is_normal = away[component] != 0.0
    symbol = "u" if given.prescribed else "σ" if is_normal else "τ"
    if np.any(given.slope):
        values = np.stack([given.mean - given.slope, given.mean + given.slope])
        return Act(symbol, np.stack([first, last]), towards, away, values, unit)
    several = is_normal and not given.prescribed
    share = np.array([0.15, 0.5, 0.85] if several else [0.7 if is_normal else 0.3])
    return Act(symbol, first + share[:, None] * (last - first), towards, away, given.mean, unit)


def ends_of(side: str, length: float, height: float) -> tuple[Array, Array]:
    """Give both ends of a side of all bodies, the lower or the left one first, m."""
    x = {"left": (0.0, 0.0), "right": (length, length)}.get(side, (0.0, length))
    y = {"bottom": (0.0, 0.0), "top": (height, height)}.get(side, (0.0, height))
    return np.array([x[0], y[0]]), np.array([x[1], y[1]])


def holds(side: Side) -> str:
    """Tell how a side is held at rest: "clamp", "rollers" or, if it is not, nothing."""
    still = [
        given.prescribed and not np.any(given.mean) and not np.any(given.slope)
        for given in (side.x, side.y)
    ]
    return "clamp" if all(still) else "rollers" if any(still) else ""
