"""What holds the bodies of a scene: supports, their own image, clamps, rollers, a spring."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from app.views.bodies.posed import Posed
from app.views.drawing import sketch
from app.views.drawing.sketch import DEPTH
from solver.arrays import Array
from solver.discrete.structure import OUTWARD, Hold, ends_of

BEYOND = 6.0
"""Pixels by which clamps and supports go on beyond bodies."""
LONG, SHORT = 40, 18
"""Strokes behind an edge as long as bodies that are long, or not."""
WALL = 0.18
"""Distance of a spring's wall, as a share of the size."""


def held(posed: Posed) -> Iterator[Array]:
    """Give a stroke of each."""
    draws = {
        "clamp": _clamp,
        "rollers": _rollers,
        "support": _support,
        "image": _image,
        "spring": _spring,
    }
    for hold in posed.described.holds:
        yield draws[hold.kind](posed, hold)


def room_of(hold: Hold) -> float:
    """Give the pixels that it takes beside the bodies."""
    return DEPTH if hold.kind in ("support", "image") else DEPTH + BEYOND


def _ends(posed: Posed, hold: Hold) -> Array:
    """Give both ends of the part of a side that is held, undeformed, shape (2, 2), m."""
    first, last = ends_of(hold.side) * [posed.length, posed.height]
    return np.array([first + share * (last - first) for share in hold.stretch])


def _count(posed: Posed, edge: Array) -> int:
    """Give the number of strokes behind an edge; heights of rods are not to scale."""
    if posed.described.height is None and edge[0, 0] == edge[-1, 0]:
        return 4 + posed.described.bodies
    share = float(np.hypot(*(edge[-1] - edge[0]))) / posed.size
    return max(round(share * (LONG if posed.is_long else SHORT)), 4)


def _clamp(posed: Posed, hold: Hold) -> Array:
    ends = _ends(posed, hold)
    along = np.where(ends[1] > ends[0], BEYOND, 0.0)
    count = _count(posed, ends)
    if hold.moved is not None:
        ends[:, 0] += posed.factor * float(posed.now(hold.moved))
    behind = 1.0 if hold.side in ("left", "top") else -1.0
    return sketch.hatched(sketch.line(ends, [-along, along]), count, behind)


def _rollers(posed: Posed, hold: Hold) -> Array:
    return sketch.rollers(_ends(posed, hold), np.array(OUTWARD[hold.side]))


def _support(posed: Posed, hold: Hold) -> Array:
    edge, gap = _ends(posed, hold), posed.gap()
    if gap is None:
        return sketch.hatched(sketch.line(edge), _count(posed, edge))
    x = np.linspace(0.0, posed.length, len(gap))
    whole = sketch.line(np.stack([x, -gap], axis=1))
    ends = whole[[0, -1]] + [[0.0, 0.0, -2.0 * BEYOND, 0.0], [0.0, 0.0, 2.0 * BEYOND, 0.0]]
    return sketch.hatched(np.concatenate([ends[:1], whole, ends[1:]]), _count(posed, edge))


def _image(posed: Posed, hold: Hold) -> Array:
    """Draw the other side, which moves the other way."""
    edge = _ends(posed, hold)
    middle = edge.mean(axis=0)
    away = sketch.arrow(middle, np.array([DEPTH, -DEPTH]), np.array([-DEPTH, -DEPTH]))
    return sketch.joined([sketch.line(edge), away])


def _spring(posed: Posed, hold: Hold) -> Array:
    foot = _ends(posed, hold)[:1]
    wall = foot[0] + [WALL * posed.size, 0.0]
    coil = sketch.spring(np.stack([posed.moved(foot)[0], wall]), DEPTH)
    upright = sketch.line([wall, wall], [[0.0, 0.0], [0.0, 2.0 * DEPTH]])
    return np.concatenate([coil, sketch.BREAK, sketch.hatched(upright, 3)])
