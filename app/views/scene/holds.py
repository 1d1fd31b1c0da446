"""Strokes of what holds the bodies: supports, an image, clamps, rollers, a spring."""

from __future__ import annotations

import numpy as np

from app.views.scene.layout import BAND, DEEPEST, WALL, Layout
from app.worker.geometry import PITCH, THICKNESS
from solver.arrays import Array
from solver.discrete.structure import OUTWARD, Description, Hold, ends_of

DEPTH, SPACING, BEYOND = 9.0, 11.0, 7.0
"""Of hatching, between its strokes, and by which clamps go on beyond bodies, px."""
RADIUS = 4.0
"""Of rollers, px."""
RING = np.stack([f(np.linspace(0.0, 2.0 * np.pi, 13)) for f in (np.cos, np.sin)], axis=1)


def strokes_of(
    description: Description, layout: Layout, factor: float, column: int, foot: Array
) -> list[Array]:
    """Lines of what holds the bodies at an instant, px from the middle of their foot.

    `column` is that of the instant in the description's values; `foot` is where the right end of
    the foot has gone, to which a spring is fixed.
    """
    lines: list[Array] = []
    for hold in description.holds:
        first, last = layout.local(ends_of(hold.side) * np.array([layout.length, layout.top]))
        edge = np.array([first + share * (last - first) for share in hold.stretch])
        away = np.array(OUTWARD[hold.side])
        if hold.kind == "clamp":
            along = (last - first) / np.hypot(*(last - first)) * BEYOND
            moved = 0.0 if hold.moved is None else hold.moved[column]
            edge = edge + layout.shift(np.array([moved, 0.0]), factor) + [-along, along]
            lines += hatched(edge, away)
        elif hold.kind == "rollers":
            lines += _rollers(edge, away)
        elif hold.kind == "support":
            lines += hatched(_support(description, hold, layout, factor, edge), away)
        elif hold.kind == "spring":
            lines += _spring(foot, edge[0, 0] + WALL)
    return lines


def hatched(edge: Array, away: Array) -> list[Array]:
    """A line, (n, 2), and strokes behind it."""
    steps = np.hypot(*np.diff(edge, axis=0).T)
    arc = np.concatenate([[0.0], np.cumsum(steps)])
    places = np.arange(0.5 * SPACING, arc[-1], SPACING)
    points = np.stack([np.interp(places, arc, values) for values in edge.T], axis=1)
    along = np.array([-away[1], away[0]])
    ends = points + DEPTH * (0.8 * away - 0.6 * np.abs(along))
    return [edge, *np.stack([points, ends], axis=1)]


def gap_of(description: Description, layout: Layout, factor: float) -> Array | None:
    """The gap below the bodies as it is drawn, (n, 2) from the middle of their foot, px.

    It is magnified as displacements are, and at most so deep.
    """
    for hold in description.holds:
        if hold.gap is not None:
            depth = np.minimum(hold.gap * factor * layout.scale[1], DEEPEST)
            x = (np.linspace(0.0, 1.0, len(depth)) - 0.5) * layout.size[0]
            return np.stack([x, -depth], axis=1)
    return None


def _support(
    description: Description, hold: Hold, layout: Layout, factor: float, edge: Array
) -> Array:
    if description.height is None:
        below = (PITCH - THICKNESS) * layout.length * layout.scale[1]
        return np.asarray(edge - [0.0, max(below, BAND + 1.0)])
    gap = gap_of(description, layout, factor)
    if hold.gap is not None and gap is not None:
        edge = gap
    beyond = np.array([[-3.0 * BEYOND, 0.0], [3.0 * BEYOND, 0.0]]) + edge[[0, -1]]
    return np.concatenate([beyond[:1], edge, beyond[1:]]) - [0.0, 0.5 * BAND + 1.5]


def _rollers(edge: Array, away: Array) -> list[Array]:
    count = max(int(np.hypot(*(edge[1] - edge[0])) / 30.0), 2)
    shares = (np.arange(count) + 0.5) / count
    centres = edge[0] + shares[:, None] * (edge[1] - edge[0]) + RADIUS * away
    behind = edge + 2.0 * RADIUS * away
    return [*(centre + RADIUS * RING for centre in centres), *hatched(behind, away)[:1]]


def _spring(foot: Array, wall: float) -> list[Array]:
    """A coil from the foot to its wall."""
    y, coils = foot[1] + 12.0, 6
    x = np.linspace(foot[0] + 8.0, wall - 6.0, 2 * coils)
    swing = np.where(np.arange(2 * coils) % 2 == 0, 6.0, -6.0)
    coil = np.stack([x, y + swing], axis=1)
    line = np.concatenate([[[foot[0], y]], coil, [[wall, y]]])
    upright = np.array([[wall, y - 16.0], [wall, y + 18.0]])
    return [line, *hatched(upright, np.array([1.0, 0.0]))]
