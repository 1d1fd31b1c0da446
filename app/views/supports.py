"""Strokes of supports: hatchings, rollers, springs, and the ground below bodies."""

from __future__ import annotations

import numpy as np

from app.views.layout import BAND, WALL, Layout
from app.views.parts import gapped
from app.worker.geometry import PITCH, THICKNESS
from solver.arrays import Array
from solver.discrete.structure import OUTWARD, Footing, on_side

DEPTH = 9.0
SPACING = 11.0
BEYOND = 7.0
"""Depth of hatching, spacing of its strokes, and length of a clamp beyond a body,
px."""
FEWEST = 3
"""Least number of strokes of a hatching."""
RADIUS = 4.0
"""Radius of rollers, px."""
ANGLES = np.linspace(0.0, 2.0 * np.pi, 13)
RING = np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=1)
"""Points of a circle of radius 1, shape (13, 2)."""


def strokes_of(layout: Layout, factor: float, column: int, feet: Array) -> list[Array]:
    """Strokes of the supports of the bodies at an instant, shape (n, 2) each.

    They are in px from the middle of the foot, with NaN behind each line. `column` is
    the index of the instant in the description's values; `feet` are the moved left and
    right ends of the foot, to which a spring is fixed, shape (2, 2), px.
    """
    lines: list[Array] = []
    for hold in layout.description.holds:
        first, last = layout.local(on_side(hold.side, [0.0, 1.0]) * layout.size)
        moved = 0.0
        if hold.moved is not None:
            moved = hold.moved[column]
        shift = np.array([moved * factor * layout.scale[0], 0.0])
        edge = np.array([first + share * (last - first) for share in hold.stretch])
        away = np.array(OUTWARD[hold.side])
        match hold.kind:
            case "clamp":
                along = (last - first) / np.hypot(*(last - first)) * BEYOND
                lines.append(hatched(edge + shift + [-along, along], away))
            case "rollers":
                lines.append(_rollers(edge, away))
            case "support" if not layout.canvas.has_ground:
                lines.append(hatched(_support(layout, factor, edge, hold.gap), away))
            case "spring":
                wall = edge[0, 0] + WALL * away[0] + shift[0]
                foot = feet[int(hold.side == "right")]
                lines.append(_spring(foot, float(wall), away))
    return lines


def ground_edge(layout: Layout, factor: float) -> Array:
    """Line, (n, 2), px, along which bodies touch the ground of a case below them."""
    gap = None
    for hold in layout.description.holds:
        if hold.kind == "support":
            gap = hold.gap
    foot = layout.local(on_side("bottom", [0.0, 1.0]) * layout.size)
    edge = _support(layout, factor, foot, gap)
    surroundings = layout.canvas.surroundings
    if surroundings is None or surroundings.place == "around":
        return edge
    # Bodies that move stay on what is below them.
    beyond = 3.0 * BEYOND + layout.motion[0]
    return edge + np.outer(np.linspace(-1.0, 1.0, len(edge)), [beyond, 0.0])


def footing_strokes(
    footing: Footing, points: Array, layout: Layout, factor: float
) -> Array:
    """Strokes of a footing at moved points, (n, 2), px, with NaN after each line."""
    outward = footing.outward
    if footing.gap is not None:
        # The gap is magnified as displacements are.
        gap = np.maximum(footing.gap, 0.0) * factor * layout.scale[1]
        depth = np.minimum(gap, layout.deepest) + 0.5 * BAND + 1.5
        points = points + depth[:, None] * outward
    if len(points) == 1:
        across = BEYOND * outward[:, ::-1] * [-1.0, 1.0]
        points = np.concatenate([points - across, points + across])
        outward = np.repeat(outward, 2, axis=0)
    if footing.kind == "rollers":
        away = outward.mean(axis=0)
        return _rollers(points[[0, -1]], away / (np.hypot(*away) or 1.0))
    return hatched(points, outward)


def hatched(edge: Array, away: Array) -> Array:
    """A hatched line, (n, 2), px: line and strokes with NaN after each, (n_all, 2).

    `away` points behind the line, (2,), or at each of its points, (n, 2).
    """
    steps = np.hypot(*np.diff(edge, axis=0).T)
    arc = np.concatenate([[0.0], np.cumsum(steps)])
    spacing = min(SPACING, max(arc[-1] / FEWEST, 1.0))
    starts = np.arange(0.5 * spacing, arc[-1], spacing)
    points = np.stack([np.interp(starts, arc, values) for values in edge.T], axis=1)
    behind = np.broadcast_to(away, edge.shape)
    behind = np.stack([np.interp(starts, arc, each) for each in behind.T], axis=1)
    along = behind[:, ::-1] * [-1.0, 1.0]
    # All lean to one side, on level and upright lines to the lower left.
    along *= np.copysign(1.0, along.sum())
    ends = points + DEPTH * (0.8 * behind - 0.6 * along)
    return np.concatenate(
        [gapped(edge[None]), gapped(np.stack([points, ends], axis=1))]
    )


def _support(layout: Layout, factor: float, edge: Array, gap: Array | None) -> Array:
    """Line, (n, 2), px, of a support below an edge, (2, 2), px.

    A support with a gap, (n_gaps,), m, stands away from the edge.
    """
    if layout.description.height is None:
        below = (PITCH - THICKNESS) * layout.description.length * layout.scale[1]
        return np.asarray(edge - [0.0, max(below, BAND + 1.0)])
    if gap is not None:
        # The gap is magnified as displacements are.
        depth = np.minimum(gap * factor * layout.scale[1], layout.deepest)
        edge = np.stack([np.linspace(*edge[:, 0], len(depth)), -depth], axis=1)
    beyond = np.array([[-3.0 * BEYOND, 0.0], [3.0 * BEYOND, 0.0]]) + edge[[0, -1]]
    return np.concatenate([beyond[:1], edge, beyond[1:]]) - [0.0, 0.5 * BAND + 1.5]


def _rollers(edge: Array, away: Array) -> Array:
    """Rollers at an edge, (2, 2), and a line behind them, px; NaN between, (n, 2)."""
    count = max(int(np.hypot(*(edge[1] - edge[0])) / 30.0), 2)
    shares = (np.arange(count) + 0.5) / count
    centres = edge[0] + shares[:, None] * (edge[1] - edge[0]) + RADIUS * away
    circles = centres[:, None] + RADIUS * RING
    behind = edge + 2.0 * RADIUS * away
    return np.concatenate([gapped(circles), gapped(behind[None])])


def _spring(foot: Array, wall: float, away: Array) -> Array:
    """A coil from a foot, (2,), to a wall at x, px; NaN after each line, (n, 2)."""
    y = foot[1] + 12.0
    coils = 6
    x = np.linspace(foot[0] + 8.0 * away[0], wall - 6.0 * away[0], 2 * coils)
    swing = np.where(np.arange(2 * coils) % 2 == 0, 6.0, -6.0)
    coil = np.stack([x, y + swing], axis=1)
    line = np.concatenate([[[foot[0], y]], coil, [[wall, y]]])
    upright = np.array([[wall, y - 16.0], [wall, y + 18.0]])
    return np.concatenate([gapped(line[None]), hatched(upright, away)])
