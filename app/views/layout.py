"""Where bodies lie on the screen, and how much their displacement is magnified."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np

from app.frame import Geometry
from app.views.axis import rounded_up
from solver.arrays import Array
from solver.discrete.structure import Act, Description

THICK = 52.0
"""Most pixels that a rod is thick."""
BAND = 7.0
"""Thickness of what rubs, px."""
FOOT = 18.0
COLUMN = 150.0
"""Height of the line of keys below the bodies, or width of their column, px."""
LETTER = 0.56
"""Width of a letter of a word, about, as a share of the size of its type."""
LONG = 5.0
"""Length over height of bodies that are long, at least."""
HIGH = 3.0
"""Width over height of bodies that are high, at most."""
WALL = 54.0
"""Pixels from a body to the wall that its spring is fixed to."""
DEEPEST = 18.0
IMAGE = 26.0
"""Pixels that a gap is deep at most in a low figure, and of the image below the
bodies."""
NARROW = 560.0
"""Width below which keys take two lines, px."""


class Layout:
    """From metres to pixels, of bodies in a figure of so many pixels; bare ones show no acts.

    The bodies have the `size` in m, length and height as they are drawn. `scale` is in
    pixels per metre, along x and y, which differ for rods alone; `origin` is the middle
    of their foot, px. An arrow is `arrow` px long at its largest value; the largest
    displacement takes `motion` px at most, along x and y. Keys stand below the bodies
    in `key_rows`, or at their left if there are none. A `letter` of what belongs to
    arrows is so many pixels wide.
    """

    def __init__(
        self,
        geometry: Geometry,
        is_bare: bool,
        type_size: float,
        width: float,
        height: float,
        key_rows: int,
    ) -> None:
        self.is_bare = is_bare
        self.width = width
        self.height = height
        self.key_rows = key_rows
        self.letter = LETTER * type_size
        described = geometry.description
        top = float(geometry.nodes[:, 1].max())
        if is_bare:
            description = replace(described, acts=())
        else:
            description = described
        arrow = min(max(0.19 * height, 18.0), 38.0)
        self.deepest = max(DEEPEST, 0.1 * height)
        left, right, below, above = _margins(
            description, arrow, self.letter, self.deepest
        )
        left = left + (0.0 if key_rows else COLUMN)
        below = below + FOOT * key_rows
        room = np.maximum([width - left - right, height - below - above], 24.0)
        low, high = _extent(description.length, top, description.tilt)
        is_long = description.length > LONG * top
        motion = np.array([0.04 * width, (0.12 if is_long else 0.06) * height])
        if description.height is None:
            motion[1] = 0.0
        scale = np.maximum(room - 2.0 * motion, 20.0) / (high - low)
        if description.height is None:
            scale[1] = min(scale[1], THICK * description.bodies / top)
        else:
            scale[:] = scale.min()
        origin = (
            np.array([left, below]) + 0.5 * (room - (high - low) * scale) - low * scale
        )
        motion[0] = min(motion[0], 0.12 * description.length * scale[0])
        self.description = description
        self.arrow = arrow
        self.size = np.array([description.length, top])
        self.scale = scale
        self.origin = origin
        self.motion = motion

    def local(self, places: Array) -> Array:
        """Pixels from the middle of the foot, along the bodies, of places in m, (..., 2)."""
        return np.asarray((places - self.size * [0.5, 0.0]) * self.scale)

    def fitting(self, largest: Array, factor: float | None) -> float:
        """Factor on displacements: the present one as long as motion is seen and has room.

        That depends on the largest displacement over all instants, along x and y, m.
        """
        room = np.where(self.motion > 0.0, self.motion, np.inf)
        share = float((largest * self.scale / room).max())
        if share <= 0.0:
            return factor or 1.0
        if factor is not None and 0.2 <= factor * share <= 1.8:
            return factor
        return float(f"{1.0 / rounded_up(share / 1.001):.6g}")


def is_high(geometry: Geometry) -> bool:
    """Whether a picture of the bodies has more room beside plots than above them."""
    described = geometry.description
    top = float(geometry.nodes[:, 1].max())
    low, high = _extent(described.length, top, described.tilt)
    width, height = high - low
    return described.height is not None and bool(width <= HIGH * height)


def turned(points: Array, angle: float) -> Array:
    """Points turned about the origin, (..., 2)."""
    cos = math.cos(angle)
    sin = math.sin(angle)
    return np.asarray(points @ np.array([[cos, sin], [-sin, cos]]))


def is_aside(act: Act) -> bool:
    """Whether it acts along the side that it acts on."""
    return np.ndim(act.towards) == 1 and abs(float(np.dot(act.towards, act.away))) < 0.5


def is_opposite(act: Act, other: Act) -> bool:
    """Whether two acts are the same pressure from both sides."""
    return act.unit == other.unit and np.array_equal(act.values, -other.values)


@lru_cache(maxsize=16)
def layout_of(
    geometry: Geometry, is_bare: bool, type_size: float, width: float, height: float
) -> Layout:
    """The layout of bodies in a figure of so many pixels, keys below them or at their left."""
    below = Layout(
        geometry, is_bare, type_size, width, height, 2 if width < NARROW else 1
    )
    beside = Layout(geometry, is_bare, type_size, width, height, 0)
    return beside if beside.scale[0] > below.scale[0] else below


def _extent(length: float, top: float, tilt: Array | None) -> tuple[Array, Array]:
    """Corners of the box that bodies take as they are tilted, from the middle of their foot, m."""
    half = 0.5 * length
    corners = np.array([[-half, 0.0], [half, 0.0], [half, top], [-half, top]])
    if tilt is None:
        angles = np.zeros(1)
    else:
        angles = np.linspace(tilt.min(), tilt.max(), 9)
    all_corners = np.concatenate([turned(corners, float(angle)) for angle in angles])
    return all_corners.min(axis=0), all_corners.max(axis=0)


def _margins(
    description: Description, arrow: float, letter: float, deepest: float
) -> tuple[float, float, float, float]:
    """Pixels on the left, on the right, below and above, for what holds and what acts."""
    room = {"left": 10.0, "right": 10.0, "bottom": 6.0, "top": 8.0}
    for hold in description.holds:
        size = {"spring": WALL + 16.0, "image": IMAGE, "support": 16.0}.get(
            hold.kind, 18.0
        )
        if hold.gap is not None and np.any(hold.gap > 0.0):
            size += deepest
        room[hold.side] = max(room[hold.side], size)
    for act in description.acts:
        side = act.where.partition(" ")[0]
        if side in ("left", "right"):
            room[side] = max(
                room[side], 20.0 + letter * (len(act.symbol) + len(act.unit) + 9)
            )
        elif side in ("top", "bottom"):
            held = beside(description, side)
            room[side] = max(room[side], held + 11.0 if is_aside(act) else arrow + 10.0)
    return room["left"], room["right"], room["bottom"], room["top"]


def beside(description: Description, side: str) -> float:
    """Pixels between a side and an arrow along it."""
    return 20.0 if any(hold.side == side for hold in description.holds) else 9.0
