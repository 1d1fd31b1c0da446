"""Layout of the scene: position and scale of bodies, size of displacements."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import chain, product

import numpy as np

from app.frame import Geometry
from app.views.axis import rounded_up
from app.views.type_size import LETTER, ROW
from solver.arrays import Array
from solver.discrete.structure import OUTWARD, Act, Description
from solver.study.trade_case import Surroundings

THICK = 52.0
SHARE = 0.15
"""Largest thickness of a rod: px in a low figure, share of the height in a high one."""
BAND = 7.0
"""Thickness of the band of an interface, px."""
COLUMN = 20.0
"""Width of the column of keys, letters."""
LONG = 5.0
"""Least length over height of long bodies."""
HIGH = 3.0
BROAD = 8.0
"""Largest width over height of high bodies, and of broad ones."""
WALL = 54.0
"""Distance from a body to the wall of its spring, px."""
DEEPEST = 18.0
IMAGE = 26.0
"""Largest depth of a gap in a low figure, and depth of the image below bodies, px."""
MOST = 1.25
"""Largest motion over the room for it with which a magnification is kept."""
FARTHEST = 2.0
"""Largest motion of an iterate over that room with which it has the magnification of
its run."""
GROUND = 26.0
"""Depth of the ground of a case, px."""
FOOTING = 18.0
"""Depth of the hatching of a footing, px."""
BESIDE = "left", "right"
SIDES = *BESIDE, "bottom", "top"
"""Sides of bodies, those beside them first."""
EACH = " each"
"""Words behind the value of several equal loads."""
LONGEST = 1.6
"""Largest length of an arrow over that of the largest value when arrows were scaled."""
WORD = 12
"""Letters of the value of a load, about."""
KEYS = 80
"""Letters of the keys with their marks, about."""
LARGER = 1.5
"""Scale of bodies over that with words at their sides, from which on words stand in
rows above."""


@dataclass(frozen=True)
class Canvas:
    """Bodies to be laid out, and the figure that they are laid out in.

    Attributes
    ----------
    geometry
        The undeformed bodies.
    is_bare
        Whether the bodies are shown without loads.
    type_size
        Size of the letters, px.
    width, height
        Size of the figure, px.
    surroundings
        Surroundings of a case, or None.
    """

    geometry: Geometry
    is_bare: bool
    type_size: float
    width: float
    height: float
    surroundings: Surroundings | None = None

    @property
    def is_upright(self) -> bool:
        """Check whether the bodies stand upright in their surroundings."""
        return self.surroundings is not None and self.surroundings.is_upright

    @property
    def has_ground(self) -> bool:
        """Check whether the ground of a case is drawn."""
        return self.surroundings is not None and not self.is_bare


class Layout:
    """Position and scale of the bodies on a `canvas`.

    Arrays have shape (2,), along x and y. The bodies have the `size` in m, length and
    height as they are drawn. `scale` is in px/m: only of rods it differs along x and
    y. `origin` is the middle of their foot, px. An arrow is `arrow` px long at its
    largest value, a letter of its words `letter` px wide, and a line of them `row` px
    high; a body is about `body_height` m high; the largest displacement takes `motion`
    px at most. Of each load `equals` are equal, itself included; 0 where an earlier one
    has their words. Keys stand below the bodies in `key_rows`, or at their left in a
    column of the width `column`, px, if there are none. Words of loads on the left and
    right side are next to these, or `in_rows` above all else.

    Rods that stand upright, by the surroundings of a case, are laid out in a figure
    that is turned by a quarter to the right: their left end is on top. `angle` is that
    of this turn, rad.
    """

    def __init__(self, canvas: Canvas, key_rows: int, *, in_rows: bool = False) -> None:
        self.canvas = canvas
        self.in_rows = in_rows
        self.key_rows = key_rows
        self.letter = LETTER * canvas.type_size
        self.column = COLUMN * self.letter
        self.row = ROW * canvas.type_size
        geometry = canvas.geometry
        self.description = geometry.description
        if canvas.is_bare:
            self.description = replace(self.description, acts=())
        self.equals = counts_of_equals(self.description.acts)
        top = float(geometry.nodes[:, 1].max())
        self.body_height = top / self.description.bodies
        if self.description.footings is not None:
            # Bands may go beyond the lines of their nodes.
            top = float(self.description.height or top)
            area = self.description.length * top
            self.body_height = math.sqrt(area / self.description.bodies)
        self.size = np.array([self.description.length, top])
        self.angle = 0.0
        # Rods alone are drawn level, whatever they are.
        is_rod = self.description.height is None
        if canvas.is_upright and is_rod:
            self.angle = -0.5 * math.pi
        self.arrow = min(max(0.19 * canvas.height, 18.0), 38.0)
        self.deepest = max(DEEPEST, 0.1 * canvas.height)
        # Words of a load on top that have no room beside its arrows stand over them.
        self._has_words_over = False
        self._fit()
        for act in self.description.acts:
            is_above = act.side == "top" and not self.angle
            if is_above and not self.has_room_beside(act, act.points_at(0)):
                self._has_words_over = True
        if self._has_words_over:
            self._fit()

    def _fit(self) -> None:
        """Fit the bodies and their largest motion between the margins."""
        description = self.description
        top = float(self.size[1])
        corner, room, figure = self._free()
        low, high = _extent(description.length, top, description.tilt)
        # Displacements get their room first: of long bodies more across, as they bend.
        share = 0.06
        if description.length > LONG * top:
            share = 0.12
        motion = figure * [0.04, share]
        if description.height is None:
            motion[1] = 0.0
        scale = np.maximum(room - 2.0 * motion, 20.0) / (high - low)
        if description.height is None:
            # Rods have no height: they are drawn as thick as there is room, up to a
            # limit.
            thickness = max(THICK, SHARE * self.canvas.height)
            scale[1] = min(scale[1], thickness * description.bodies / top)
        else:
            scale[:] = scale.min()
        # Half of what the bodies leave is on either side of them.
        rest = room - (high - low) * scale
        motion[0] = min(motion[0], 0.12 * description.length * scale[0])
        self.scale = scale
        self.origin = corner + 0.5 * rest - low * scale
        if self.angle:
            along, across = self.origin
            self.origin = np.array([across, self.canvas.height - along])
        self.motion = motion

    def _free(self) -> tuple[Array, Array, Array]:
        """Corner and size of the area between the margins; size of the figure, (2,).

        All are along and across the bodies, px; the corner is the lower one.
        """
        left, right, below, above = self._margins()
        figure = np.array([self.canvas.width, self.canvas.height])
        if not self.key_rows:
            left += self.column
        # Upright bodies have words in rows above them, and keys below them.
        if self.angle:
            figure = figure[::-1]
            left += self.row * len(self.description.acts)
            right += self.row * self.key_rows
        else:
            below += self.row * self.key_rows
        room = np.maximum(figure - [left + right, below + above], 24.0)
        return np.array([left, below]), room, figure

    def _margins(self) -> tuple[float, float, float, float]:
        """Margins on the left, on the right, below and above, px."""
        room = {
            "left": 10.0,
            "right": 10.0,
            "bottom": 6.0,
            "top": 8.0,
        }
        for side, size in chain(self._room_of_supports(), self._room_of_loads()):
            room[side] = max(room[side], size)
        acts = self.description.acts
        if any(self._acts_on_bodies(act) for act in acts):
            # Their words stand above the arrows on top.
            room["top"] = max(room["top"], self.arrow + 10.0) + 2.2 * self.letter
        for act, count in zip(acts, self.equals, strict=True):
            room["top"] += self.row * self.is_told_above(act, count)
        room["top"] += self.row * self._has_words_over
        return room["left"], room["right"], room["bottom"], room["top"]

    def _acts_on_bodies(self, act: Act) -> bool:
        """Check whether the arrow of a load of all bodies begins on a body.

        Below an arch there are none, and its words stand there.
        """
        if not act.where.startswith("body"):
            return False
        places = act.points_at(0)[:, None] * self.size
        geometry = self.canvas.geometry
        corners = geometry.nodes[geometry.cells]
        is_right_above = places >= corners.min(axis=1)
        is_left_below = places <= corners.max(axis=1)
        return bool(np.any(np.all(is_right_above & is_left_below, axis=-1)))

    def _room_of_supports(self) -> Iterator[tuple[str, float]]:
        """Space for supports and ground by side of the bodies, px."""
        supports = {"spring": WALL + 16.0, "image": IMAGE, "support": 16.0}
        for hold in self.description.holds:
            size = supports.get(hold.kind, 18.0)
            if hold.gap is not None and np.any(hold.gap > 0.0):
                # An open gap is drawn, too.
                size += self.deepest
            yield hold.side, size
        for footing in self.description.footings or ():
            for side, outward in OUTWARD.items():
                if np.max(footing.outward @ outward) > 0.5:
                    yield side, FOOTING
        surroundings = self.canvas.surroundings
        if surroundings is not None:
            yield "bottom", GROUND + 16.0
            if surroundings.place == "around":
                yield "top", GROUND + 16.0

    def _room_of_loads(self) -> Iterator[tuple[str, float]]:
        """Space for loads and labels by side of the bodies, px."""
        for act, count in zip(self.description.acts, self.equals, strict=True):
            if act.side not in SIDES:
                continue
            if self.canvas.is_upright:
                yield act.side, self.arrow + 10.0
            elif act.side in BESIDE:
                yield from self._room_beside(act, count)
            elif is_aside(act):
                yield act.side, beside(self.description, act.side) + 11.0
                if act.outward is not None:
                    # On bodies of any shape the arrow may stand at an end of the side.
                    for end in BESIDE:
                        yield end, self.arrow + 6.0
            else:
                yield act.side, self.arrow + 10.0

    def _room_beside(self, act: Act, count: int) -> Iterator[tuple[str, float]]:
        """Space for a load on the left or right, and for its label, px."""
        size = 20.0
        if count != 1:
            # The words of equal loads stand below all bodies.
            yield "bottom", FOOTING + 1.2 * self.row
        elif not self.is_told_above(act, count):
            size += self.letter * (len(act.symbol) + len(act.unit) + 9)
        else:
            # Beside words an arrow has room, without them it needs its own.
            size = max(size, self.arrow + 10.0)
        if act.outward is not None:
            size += self.arrow
        yield act.side, size

    def has_room_beside(self, act: Act, places: Array) -> bool:
        """Check whether the label of a load on top fits next to its arrows.

        The arrows stand at places, (n, 2), over the length and height of all bodies.
        """
        across = self.local(places * self.size)[:, 0] + self.origin[0]
        if is_at_left(places):
            room = across.min()
        else:
            room = self.canvas.width - across.max()
        if is_aside(act):
            room -= LONGEST * self.arrow
        # A load that varies along its side has the values at both ends.
        values = 2 if act.values.ndim > 1 else 1
        return bool(room > self.letter * (len(act.symbol) + values * WORD))

    def is_told_above(self, act: Act, count: int) -> bool:
        """Check whether the label of a load is in a row above the picture.

        `count` is the number of loads equal to it, itself included.
        """
        return self.in_rows and count == 1 and act.side in BESIDE

    def local(self, positions: Array) -> Array:
        """Positions, px, from the middle of the foot, for positions, m, (..., 2)."""
        return np.asarray((positions - self.size * [0.5, 0.0]) * self.scale)

    def fitting(self, largest: Array, factor: float | None) -> float:
        """Factor on displacements: unchanged while motion is visible and fits.

        `largest` is the largest displacement over all instants along x and y, (2,), m.
        """
        share = self._share_of(largest)
        if share <= 0.0:
            return factor or 1.0
        # A factor that followed each frame would hide that displacements change.
        if factor is not None and 0.2 <= factor * share <= MOST:
            return factor
        return float(f"{1.0 / rounded_up(share / 1.001):.6g}")

    def limited(self, largest: Array, factor: float) -> float:
        """The factor, or a smaller one for a motion that would go far beyond its room.

        `largest` is as in `fitting`.
        """
        if factor * self._share_of(largest) <= FARTHEST:
            return factor
        return self.fitting(largest, None)

    def _share_of(self, largest: Array) -> float:
        """Largest displacement, along x and y, (2,), m, over the room for motion."""
        room = np.where(self.motion > 0.0, self.motion, np.inf)
        return float((largest * self.scale / room).max())


def shape_of(geometry: Geometry) -> str:
    """Shape of a picture: high, broad or long; plots are arranged by it.

    A high picture has more room beside plots than above them; a broad one needs as much
    height as they do, a long one less.
    """
    description = geometry.description
    top = float(geometry.nodes[:, 1].max())
    low, high = _extent(description.length, top, description.tilt)
    width, height = high - low
    if description.height is None or width > BROAD * height:
        return "long"
    if width > HIGH * height:
        return "broad"
    return "high"


def turned(points: Array, angle: float) -> Array:
    """Points turned about the origin by an angle in rad, shape (..., 2) each."""
    cos = math.cos(angle)
    sin = math.sin(angle)
    return np.asarray(points @ np.array([[cos, sin], [-sin, cos]]))


def is_at_left(places: Array) -> bool:
    """Check whether the label of a load at `places`, (n, 2), is on the left."""
    return float(np.mean(places[:, 0])) < 0.45


def is_aside(act: Act) -> bool:
    """Check whether a load acts along the side that it acts on."""
    return np.ndim(act.towards) == 1 and abs(float(np.dot(act.towards, act.away))) < 0.5


def is_opposite(act: Act, other: Act) -> bool:
    """Check whether two loads are the same pressure from both sides."""
    if act.unit != other.unit or act.values.shape != other.values.shape:
        return False
    if np.ndim(act.towards) != 1 or np.ndim(other.towards) != 1:
        return False
    same = np.dot(act.towards, other.towards)
    return same != 0.0 and np.array_equal(act.values, -same * other.values)


def is_equal(act: Act, other: Act) -> bool:
    """Check whether loads of bodies of any shape are equal except for direction."""
    if act.outward is None or other.outward is None:
        return False
    if act.symbol != other.symbol or act.unit != other.unit:
        return False
    if act.values.shape != other.values.shape:
        return False
    return np.allclose(act.values, other.values, atol=0.0)


def counts_of_equals(acts: Sequence[Act]) -> list[int]:
    """Number of loads equal to each load; 0 if an earlier one has the label."""
    counts: list[int] = []
    for act in acts:
        firsts = [n for n, count in enumerate(counts) if count]
        alike = [first for first in firsts if is_equal(act, acts[first])]
        counts.append(int(not alike))
        for first in alike:
            counts[first] += 1
    return counts


@lru_cache(maxsize=16)
def layout_of(canvas: Canvas) -> Layout:
    """The layout, with labels in rows or not, that shows bodies larger.

    Keys stand below or at the left, words beside the bodies or, if these become much
    larger, in rows above. Bare bodies have a single key, below them.
    """
    if canvas.is_bare:
        return Layout(canvas, 1)
    if canvas.is_upright:
        return Layout(canvas, 5)
    width = KEYS * LETTER * canvas.type_size
    rows = math.ceil(min(width / canvas.width, 2.0))
    layouts = [
        Layout(canvas, key_rows, in_rows=in_rows)
        for in_rows, key_rows in product((False, True), (rows, 0))
    ]
    return max(layouts, key=_worth)


def _worth(layout: Layout) -> float:
    """Scale of bodies, by which layouts are chosen."""
    scale = float(layout.scale[0])
    if layout.in_rows:
        return scale / LARGER
    return scale


def _extent(length: float, top: float, tilt: Array | None) -> tuple[Array, Array]:
    """Lower and upper corner, (2,), m, of the box about bodies at all their tilts, rad.

    Both are from the middle of the foot.
    """
    half = 0.5 * length
    corners = np.array([[-half, 0.0], [half, 0.0], [half, top], [-half, top]])
    angles = np.zeros(1)
    if tilt is not None:
        angles = np.linspace(tilt.min(), tilt.max(), 9)
    all_corners = np.concatenate([turned(corners, float(angle)) for angle in angles])
    return all_corners.min(axis=0), all_corners.max(axis=0)


def beside(description: Description, side: str) -> float:
    """Distance of an arrow along a side from that side, px."""
    is_held = any(hold.side == side for hold in description.holds)
    if is_held or description.footings:
        return 20.0
    return 9.0
