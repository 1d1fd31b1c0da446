"""Loads and motions that act on a structure, as arrows with words."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from app.units import settled
from app.views.colors import DISPLACEMENT, FORCE
from app.views.layout import LONGEST, WORD, Layout, beside, is_aside, is_at_left
from app.views.parts import gapped, heads_of
from app.views.words import half_of_line
from solver.arrays import Array
from solver.discrete.structure import OUTWARD, Act
from solver.files.amounts import Unit, unit_for

SHORTEST = 0.02
"""Value over the largest one below which an arrow is not drawn, nor dragged."""
ALIKE = 0.999
"""Length over the longest one from which on an arrow counts as long: equal loads at
moved points differ by rounding."""
SNAP = 4.0
"""Distance from zero within which a dragged load is zero, px."""
HEAD = 9.0
"""Length of the head of an arrow, px."""
BOW = 0.22
"""Height of the bow of an arrow that bends, over its length."""


@dataclass(frozen=True, eq=False)
class Rest:
    """A load that was dragged to zero: a handle without an arrow.

    The handle is in px from the middle of the bodies' foot, (2,); `per_px` is the value
    of the setting for each px along x and y, (2,).
    """

    act: Act
    setting: str
    handle: Array
    per_px: Array

    def scaled(self, present: float, pointer: Array) -> float:
        """Value of the setting with the handle at a pointer, (2,), px."""
        way = pointer - self.handle
        if np.hypot(*way) < SNAP:
            return 0.0
        return float(way @ self.per_px)


class Arrows:
    """Arrows of a load at an instant, px from the middle of the bodies' foot.

    There are n of them: none where the value is nearly zero; an arrow of the `peak` has
    full length. `lines` go from tails to heads, (n, k, 2), at moved `points`, (m, 2),
    whose `places` are shares of the length and height of all bodies, (m, 2).
    The longest is dragged by one of its ends, which sets the `setting` of the load:
    `base`, (n, 2), is this end at the value 0, `handles`, (n, 2), at the present one.
    """

    def __init__(
        self,
        act: Act,
        setting: str | None,
        points: Array,
        layout: Layout,
        peak: float,
        column: int,
    ) -> None:
        self.act = act
        self.setting = setting
        self.points = points
        towards = np.asarray(act.towards)
        if towards.ndim > 1:
            towards = towards[:, column]
        away = np.array(act.away)
        side = act.side
        self.places = act.points_at(column)
        now = np.broadcast_to(act.values.T[column], len(points))
        share = np.clip(now / peak, -LONGEST, LONGEST)
        is_shown = np.abs(share) >= SHORTEST
        distance = 0.0
        if is_aside(act):
            distance = beside(layout.description, side)
        base = points[is_shown] + distance * away
        span = layout.arrow * share[is_shown, None] * towards
        # An arrow that pushes on a side ends there; all others begin at the body.
        can_push = not is_aside(act) and side != "body"
        pushes = (span @ away < 0.0)[:, None] & can_push
        handles = np.where(pushes, base - span, base + span)
        tails = np.where(pushes, handles, base)
        heads = np.where(pushes, base, handles)
        self._layout = layout
        self._places = self.places[is_shown]
        self._distance = distance
        self.base = base
        self.handles = handles
        self.lines = np.stack([tails, heads], axis=1)
        if act.unit == "1/m":
            self.lines = _bows(self.lines, np.hypot(*span.T), away)

    @cached_property
    def _along(self) -> Array:
        """Unit vectors along the arrows at their tips, shape (n, 2)."""
        along = self.lines[:, -1] - self.lines[:, -2]
        return np.asarray(along / np.hypot(*along.T)[:, None])

    @property
    def heads(self) -> Array:
        """Corners of the heads, shape (n, 3, 2)."""
        tips = self.lines[:, -1]
        lengths = np.minimum(HEAD, np.hypot(*(tips - self.lines[:, 0]).T))
        return heads_of(tips, self._along, lengths[:, None])

    @property
    def strokes(self) -> Array:
        """Shafts of the arrows with NaN behind each, shape (n_all, 2).

        A line over the tails follows where the load is spread along a side.
        """
        shafts = self.lines.copy()
        size = np.hypot(*(self.lines[:, -1] - self.lines[:, -2]).T)[:, None]
        # Inside the heads, whose tips are sharper than the end of a stroke.
        shafts[:, -1] -= np.minimum(5.0, 0.9 * size) * self._along
        strokes = gapped(shafts)
        return np.concatenate([strokes, self.spread])

    @property
    def spread(self) -> Array:
        """The line over the tails of a distributed load, (n, 2).

        Without points where it is not, or has but two arrows.
        """
        is_spread = self.act.unit != "N" and not is_aside(self.act)
        if is_spread and len(self.handles) > 2:
            return self.handles
        return self.handles[:0]

    @cached_property
    def _longest(self) -> int:
        """Index of the longest arrow; of several the middle one, at all instants.

        Those at the ends may be near to the arrow of another load.
        """
        lengths = np.hypot(*(self.handles - self.base).T)
        longest = np.flatnonzero(lengths > ALIKE * lengths.max())
        return int(longest[len(longest) // 2])

    @property
    def handle(self) -> Array:
        """The handle: the end of the longest arrow, shape (2,)."""
        return self.handles[self._longest]

    def scaled(self, present: float, pointer: Array) -> float:
        """Value of the setting with the handle at a pointer, (2,), px."""
        base = self.base[self._longest]
        along = self.handle - base
        share = float((pointer - base) @ along / (along @ along))
        # Zero is a place that a hand finds.
        if abs(share) * np.hypot(*along) < SNAP:
            return 0.0
        return present * share

    def rest(self, present: float) -> Rest:
        """The handle that remains when the setting becomes zero."""
        place = self._places[self._longest] * self._layout.size
        away = self._distance * np.array(self.act.away)
        along = self.handle - self.base[self._longest]
        per_px = present * along / (along @ along)
        handle = self._layout.local(place) + away
        return Rest(self.act, self.setting or "", handle, per_px)


def _bows(lines: Array, lengths: Array, away: Array) -> Array:
    """Bows, (n, 9, 2), for arrows of a curvature, (n, 2, 2), of lengths (n,), px."""
    along = np.linspace(0.0, 1.0, 9)[:, None]
    height = BOW * lengths[:, None, None] * 4.0 * along * (1.0 - along)
    return lines[:, :1] + along * (lines[:, 1:] - lines[:, :1]) + height * away


def color_of(act: Act) -> str:
    """The colour of a given displacement or force."""
    return DISPLACEMENT if act.unit in ("m", "1/m") else FORCE


def anchor_of(arrows: Arrows, layout: Layout) -> tuple[Array, str]:
    """Anchor of the label of a load, (2,), px, and the side of the label at it."""
    act = arrows.act
    side = act.side
    if side in ("top", "bottom"):
        return _anchor_above(arrows, layout, side)
    if side == "body":
        length, height = layout.size * layout.scale
        room = layout.origin[0] - 0.5 * length - 14.0
        if not layout.key_rows:
            room -= layout.column
        has_room = room > layout.letter * (len(act.symbol) + WORD)
        # Beside a body that tilts they would meet its corners.
        if has_room and layout.description.tilt is None:
            return np.array([-0.5 * length - 14.0, 0.5 * height]), "right"
        above = height + layout.arrow + 6.0 + layout.letter
        return np.array([0.0, above]), "center"
    away = OUTWARD.get(side, act.away)[0]
    align = "left" if side == "right" else "right"
    if act.outward is not None and len(arrows.handles) and not is_aside(act):
        # Bodies of any shape may be above and below the arrow.
        ends = np.array([arrows.handle, arrows.base[0]])
        outer = ends[(away * ends[:, 0]).argmax()]
        return outer + np.array([10.0 * away, 0.0]), align
    # Clear of the handle, also in large type.
    above = max(15.0, half_of_line(layout) + 7.0)
    if is_aside(act):
        above = -16.0
    # Clear of rollers, and of an arrow along the end of the bodies.
    return arrows.points[-1] + np.array([22.0 * away, above]), align


def _anchor_above(arrows: Arrows, layout: Layout, side: str) -> tuple[Array, str]:
    """Anchor, (2,), px, and side, as in `anchor_of`, of a load on the top or bottom.

    The words are next to its arrows where there is room, else over them.
    """
    act = arrows.act
    up = OUTWARD[side][1]
    is_left = is_at_left(arrows.places)
    nearest = arrows.points[0 if is_left else -1]
    ends = np.append(arrows.lines[:, :, 0], nearest[0])
    if is_aside(act):
        # Large words are higher than their arrow stands above the bodies.
        above = max(beside(layout.description, side), 0.5 * layout.row)
    else:
        above = 0.75 * layout.arrow
    if not layout.has_room_beside(act, arrows.places):
        middle = 0.5 * (ends.min() + ends.max())
        heights = up * arrows.lines[:, :, 1].ravel()
        top = up * max(heights, default=up * nearest[1] + above)
        return np.array([middle, top + up * (6.0 + layout.letter)]), "center"
    y = nearest[1] + above * up
    if is_left:
        x = ends.min() - 10.0
        return np.array([x, y]), "right"
    x = ends.max()
    surroundings = layout.canvas.surroundings
    if surroundings is not None and surroundings.place == "around":
        # Beside the ground, in which the arrows stand.
        x = max(x, 0.5 * float(layout.size[0] * layout.scale[0]))
    return np.array([x + 10.0, y]), "left"


def text_of(act: Act, column: int) -> str:
    """Symbol and value of a load at an instant, or its values at both ends."""
    unit = unit_of(act)
    now = np.atleast_1d(act.values.T[column])
    peak = float(np.abs(act.values).max())
    ends = now[[0, -1]][: len(now)]
    if len(now) > 2 and np.isclose(*ends):
        ends = np.array([now.min(), now.max()])
    # Rounding of a load path leaves a value near zero, as of sin(pi).
    texts = [unit(settled(float(value), peak)) for value in ends]
    return f"{act.symbol} = {' to '.join(texts)}"


def unit_of(act: Act) -> Unit:
    """The unit in which the values of a load are read."""
    return unit_for(float(np.abs(act.values).max()), act.unit)
