"""What acts on the bodies, as arrows and in words, and strokes of what holds them."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from app.units import Unit, unit_for
from app.views.colors import DISPLACEMENT, FORCE
from app.views.layout import BAND, WALL, Layout, beside, is_aside
from app.worker.geometry import PITCH, THICKNESS
from solver.arrays import Array
from solver.discrete.structure import OUTWARD, Act, on_side

LEAST = 0.02
"""Share of its largest value below which an arrow is not drawn, or cannot be
dragged."""
LONGEST = 1.6
"""Length at most, over that of the largest value when arrows were scaled."""
WORD = 12
"""Letters of a value, about."""
HEAD = 9.0
BOW = 0.22
"""Height of the bow of an arrow that bends, over its length."""
DEPTH = 9.0
SPACING = 11.0
BEYOND = 7.0
"""Of hatching, between its strokes, and by which clamps go on beyond bodies, px."""
RADIUS = 4.0
"""Of rollers, px."""
RING = np.stack(
    [f(np.linspace(0.0, 2.0 * np.pi, 13)) for f in (np.cos, np.sin)], axis=1
)


class Arrows:
    """Arrows of what acts at an instant, px from the middle of the bodies' foot.

    There are n of them: none where the value is nearly zero; one of the `peak` has full
    length. `lines` go from tails to heads, (n, k, 2), at `places` that have moved, (m,
    2). The longest is dragged by one of its ends, and sets what is behind the act:
    `base`, (n, 2), is where an end would be at the value 0, `handles` where it is.
    """

    def __init__(
        self,
        act: Act,
        setting: str | None,
        places: Array,
        layout: Layout,
        peak: float,
        column: int,
    ) -> None:
        self.act = act
        self.setting = setting
        self.places = places
        towards = np.asarray(act.towards)
        if towards.ndim > 1:
            towards = towards[:, column]
        else:
            towards = towards
        away = np.array(act.away)
        aside = is_aside(act)
        side = act.where.partition(" ")[0]
        now = np.broadcast_to(act.values.T[column], len(places))
        share = np.clip(now / peak, -LONGEST, LONGEST)
        is_shown = np.abs(share) >= LEAST
        if aside:
            room = beside(layout.description, side)
        else:
            room = 0.0
        self.base = base = places[is_shown] + room * away
        span = layout.arrow * share[is_shown, None] * towards
        pushes = (span @ away < 0.0)[:, None] & (not aside) & (side != "body")
        self.handles = handles = np.where(pushes, base - span, base + span)
        lines = np.stack(
            [np.where(pushes, handles, base), np.where(pushes, base, handles)], axis=1
        )
        if act.unit == "1/m":
            # What bends is a bow.
            along = np.linspace(0.0, 1.0, 9)[:, None]
            height = (
                BOW * np.hypot(*span.T)[:, None, None] * 4.0 * along * (1.0 - along)
            )
            lines = lines[:, :1] + along * (lines[:, 1:] - lines[:, :1]) + height * away
        self.lines = lines

    @cached_property
    def _along(self) -> Array:
        """Directions at the tips, shape (n, 2)."""
        along = self.lines[:, -1] - self.lines[:, -2]
        return np.asarray(along / np.hypot(*along.T)[:, None])

    @property
    def heads(self) -> Array:
        """Corners of the heads, shape (n, 3, 2)."""
        tips = self.lines[:, -1]
        along = self._along
        length = np.minimum(HEAD, np.hypot(*(tips - self.lines[:, 0]).T))[:, None]
        half = 0.5 * length * along[:, ::-1] * [-1.0, 1.0]
        return np.stack(
            [tips, tips - length * along + half, tips - length * along - half], axis=1
        )

    @property
    def strokes(self) -> Array:
        """Lines that end inside their heads, and one over them of what is spread along a side."""
        shafts = self.lines.copy()
        size = np.hypot(*(self.lines[:, -1] - self.lines[:, -2]).T)[:, None]
        shafts[:, -1] -= np.minimum(5.0, 0.9 * size) * self._along
        is_spread = len(shafts) > 2 and self.act.unit != "N" and not is_aside(self.act)
        return np.concatenate(
            [gapped(shafts), self.handles if is_spread else self.handles[:0]]
        )

    @property
    def _longest(self) -> int:
        return int(np.hypot(*(self.handles - self.base).T).argmax())

    @property
    def handle(self) -> Array:
        """The end of the longest."""
        return self.handles[self._longest]

    def scaled(self, present: float, pointer: Array) -> float:
        """The setting with which the handle is under a pointer, by its present value."""
        base = self.base[self._longest]
        along = self.handle - base
        return float(present * ((pointer - base) @ along) / (along @ along))


def gapped(lines: Array) -> Array:
    """Lines of as many points each, shape (n, k, 2), as one, with NaN behind each."""
    gaps = np.full((len(lines), 1, 2), np.nan)
    return np.concatenate([lines, gaps], axis=1).reshape(-1, 2)


def color_of(act: Act) -> str:
    """The colour of what is given: a displacement, or a force."""
    return DISPLACEMENT if act.unit in ("m", "1/m") else FORCE


def anchor_of(arrows: Arrows, layout: Layout) -> tuple[Array, str]:
    """Where the words of what acts stand, and on which side of them that is."""
    act = arrows.act
    places = arrows.places
    side = act.where.partition(" ")[0]
    aside = is_aside(act)
    (away, up) = act.away
    if side in ("top", "bottom"):
        is_left = float(np.mean(act.places[:, 0])) < 0.45
        place = places[0 if is_left else -1]
        ends = np.append(arrows.lines[:, :, 0], place[0])
        if aside:
            above = beside(layout.description, side)
        else:
            above = 0.75 * layout.arrow
        if not _has_room(act, layout, is_left):
            middle = 0.5 * (ends.min() + ends.max())
            top = up * max(
                up * arrows.lines[:, :, 1].ravel(), default=up * place[1] + above
            )
            return np.array([middle, top + up * (6.0 + layout.letter)]), "center"
        if is_left:
            x = ends.min() - 10.0
        else:
            x = ends.max() + 10.0
        return np.array([x, place[1] + above * up]), "right" if is_left else "left"
    if side == "body":
        length, height = layout.size * layout.scale
        if length < 0.5 * layout.width:
            return np.array([-0.5 * length - 14.0, 0.5 * height]), "right"
        return np.array([0.0, 0.5 * height + 14.0]), "center"
    # Clear of an arrow that stands across the end of the bodies.
    across = [
        a for a in layout.description.acts if a.where.startswith(side) and is_aside(a)
    ]
    if aside:
        shift = [22.0 * away, -16.0]
    else:
        shift = [(22.0 if across else 9.0) * away, 15.0]
    return places[-1] + shift, "left" if side == "right" else "right"


def _has_room(act: Act, layout: Layout, is_left: bool) -> bool:
    """Whether the words of what acts on the top have room beside its longest arrows."""
    across = layout.local(act.places * layout.size)[:, 0] + layout.origin[0]
    if is_left:
        room = across.min()
    else:
        room = layout.width - across.max()
    if is_aside(act):
        reach = LONGEST * layout.arrow
    else:
        reach = 0.0
    return bool(room - reach > layout.letter * (len(act.symbol) + WORD))


def text_of(act: Act, column: int) -> str:
    """A symbol and its value now; what varies along a side at both of its ends."""
    unit = unit_of(act)
    now = np.atleast_1d(act.values.T[column])
    peak = float(np.abs(act.values).max())
    # Rounding of a load path leaves what is nearly nothing, as sin(pi).
    texts = [
        unit(0.0 if abs(value) < 1e-6 * peak else float(value))
        for value in now[[0, -1]]
    ]
    return f"{act.symbol} = {' to '.join(texts[: len(now)])}"


def unit_of(act: Act) -> Unit:
    """The unit that its values are read in."""
    return unit_for(float(np.abs(act.values).max()), act.unit)


def strokes_of(layout: Layout, factor: float, column: int, feet: Array) -> list[Array]:
    """Lines of what holds the bodies at an instant, px from the middle of their foot, NaN between.

    `column` is that of the instant in the description's values; `feet` is where the
    left and the right end of the foot have gone, to which a spring is fixed, shape (2,
    2).
    """
    lines: list[Array] = []
    for hold in layout.description.holds:
        first, last = layout.local(on_side(hold.side, [0.0, 1.0]) * layout.size)
        if hold.moved is None:
            moved = 0.0
        else:
            moved = hold.moved[column]
        shift = np.array([moved * factor * layout.scale[0], 0.0])
        edge = np.array([first + share * (last - first) for share in hold.stretch])
        away = np.array(OUTWARD[hold.side])
        if hold.kind == "clamp":
            along = (last - first) / np.hypot(*(last - first)) * BEYOND
            lines.append(hatched(edge + shift + [-along, along], away))
        elif hold.kind == "rollers":
            lines.append(_rollers(edge, away))
        elif hold.kind == "support":
            lines.append(hatched(_support(layout, factor, edge, hold.gap), away))
        elif hold.kind == "spring":
            wall = edge[0, 0] + WALL * away[0] + shift[0]
            lines.append(_spring(feet[int(hold.side == "right")], float(wall), away))
    return lines


def hatched(edge: Array, away: Array) -> Array:
    """A line, (n, 2), and strokes behind it."""
    steps = np.hypot(*np.diff(edge, axis=0).T)
    arc = np.concatenate([[0.0], np.cumsum(steps)])
    places = np.arange(0.5 * SPACING, arc[-1], SPACING)
    points = np.stack([np.interp(places, arc, values) for values in edge.T], axis=1)
    along = np.array([-away[1], away[0]])
    ends = points + DEPTH * (0.8 * away - 0.6 * np.abs(along))
    return np.concatenate(
        [gapped(edge[None]), gapped(np.stack([points, ends], axis=1))]
    )


def _support(layout: Layout, factor: float, edge: Array, gap: Array | None) -> Array:
    if layout.description.height is None:
        below = (PITCH - THICKNESS) * layout.description.length * layout.scale[1]
        return np.asarray(edge - [0.0, max(below, BAND + 1.0)])
    if gap is not None:
        # It is magnified as displacements are.
        depth = np.minimum(gap * factor * layout.scale[1], layout.deepest)
        edge = np.stack([np.linspace(*edge[:, 0], len(depth)), -depth], axis=1)
    beyond = np.array([[-3.0 * BEYOND, 0.0], [3.0 * BEYOND, 0.0]]) + edge[[0, -1]]
    return np.concatenate([beyond[:1], edge, beyond[1:]]) - [0.0, 0.5 * BAND + 1.5]


def _rollers(edge: Array, away: Array) -> Array:
    count = max(int(np.hypot(*(edge[1] - edge[0])) / 30.0), 2)
    shares = (np.arange(count) + 0.5) / count
    centres = edge[0] + shares[:, None] * (edge[1] - edge[0]) + RADIUS * away
    behind = edge + 2.0 * RADIUS * away
    return np.concatenate(
        [gapped(centres[:, None] + RADIUS * RING), gapped(behind[None])]
    )


def _spring(foot: Array, wall: float, away: Array) -> Array:
    """A coil from the foot to its wall."""
    y = foot[1] + 12.0
    coils = 6
    x = np.linspace(foot[0] + 8.0 * away[0], wall - 6.0 * away[0], 2 * coils)
    swing = np.where(np.arange(2 * coils) % 2 == 0, 6.0, -6.0)
    coil = np.stack([x, y + swing], axis=1)
    line = np.concatenate([[[foot[0], y]], coil, [[wall, y]]])
    upright = np.array([[wall, y - 16.0], [wall, y + 18.0]])
    return np.concatenate([gapped(line[None]), hatched(upright, away)])
