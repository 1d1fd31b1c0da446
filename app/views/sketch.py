"""Strokes of which a picture of a scene is made, arrows, hatches, rollers, a spring, and its words.

A stroke is a polyline, shape (n, 2), in which NaN interrupts the line.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from solver.arrays import Array

BREAK = np.full((1, 2), np.nan)
HEAD = 0.35
"""Of an arrow, as a share of its length, at most `LARGEST_HEAD` of the picture's size."""
LARGEST_HEAD = 0.022
COILS = 6


def joined(strokes: Iterable[Array]) -> Array:
    """Put polylines into one."""
    found = [part for stroke in strokes for part in (stroke, BREAK)]
    return np.concatenate(found) if found else BREAK


def line(*points: Sequence[float]) -> Array:
    """Give a line through points."""
    return np.array(points, dtype=np.float64)


def arrow(tail: Array, head: Array, size: float) -> Array:
    """Give an arrow in a picture of a size."""
    along = head - tail
    length = float(np.hypot(*along))
    if length == 0.0:
        return BREAK
    back = -along / length * min(HEAD * length, LARGEST_HEAD * size)
    side = 0.6 * np.array([-back[1], back[0]])
    return np.stack([tail, head, head + back + side, head, head + back - side])


def hatched(edge: Array, depth: float, behind: float = -1.0) -> Array:
    """Give a line and slanted strokes behind it, on its right (-1) or its left (1)."""
    steps = np.hypot(*np.diff(edge, axis=0).T)
    places = np.concatenate([[0.0], np.cumsum(steps)])
    count = max(int(places[-1] / (0.8 * depth)), 2)
    at = np.linspace(0.0, places[-1], count, endpoint=False) + 0.5 * places[-1] / count
    feet = np.stack([np.interp(at, places, edge[:, axis]) for axis in (0, 1)], axis=1)
    along = (edge[-1] - edge[0]) / max(float(np.hypot(*(edge[-1] - edge[0]))), 1e-300)
    normal = behind * np.array([-along[1], along[0]])
    strokes = [feet, feet + depth * (normal - 0.6 * along), np.full_like(feet, np.nan)]
    return np.concatenate([edge, BREAK, np.stack(strokes, axis=1).reshape(-1, 2)])


def rollers(first: Array, last: Array, radius: float) -> Array:
    """Give four circles along a line."""
    angle = np.linspace(0.0, 2.0 * np.pi, 17)
    circle = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    centres = first + np.linspace(0.0, 1.0, 4)[:, None] * (last - first)
    return joined(centre + circle for centre in centres)


def spring(first: Array, last: Array, width: float) -> Array:
    """Give a zigzag between two points."""
    at = np.linspace(0.0, 1.0, 2 * COILS + 1)[:, None]
    along = (last - first) / max(float(np.hypot(*(last - first))), 1e-300)
    aside = np.where(np.arange(2 * COILS + 1) % 2, 1.0, -1.0)
    aside[[0, -1]] = 0.0
    return np.asarray(first + at * (last - first) + width * aside[:, None] * [-along[1], along[0]])


def stretches(places: Array, chosen: Array) -> list[Array]:
    """Give a line over every run of chosen points, which reaches halfway to its neighbours."""
    if len(places) == 1:
        return []
    middles = 0.5 * (places[1:] + places[:-1])
    ends = np.concatenate([places[:1], middles, places[-1:]])
    edges = np.flatnonzero(np.diff(np.concatenate([[0], chosen.astype(np.int8), [0]])))
    return [
        np.concatenate([ends[[first]], places[first:last], ends[[last]]])
        for first, last in edges.reshape(-1, 2)
    ]


def turned(points: Array, angle: float) -> Array:
    """Turn points about the origin, counter-clockwise, rad."""
    if angle == 0.0:
        return points
    cos, sin = np.cos(angle), np.sin(angle)
    return np.asarray(points @ np.array([[cos, sin], [-sin, cos]]))


def aligned(away: tuple[float, float]) -> tuple[str, str]:
    """Say how words stand beside what points away from a body: across and up."""
    across = {1.0: "left", -1.0: "right"}.get(away[0], "center")
    return across, {1.0: "bottom", -1.0: "top"}.get(away[1], "middle")


def plain(value: float) -> str:
    """Write a number with three digits at most, and zero without a sign."""
    return f"{value:.3g}".replace("-", "−") if abs(value) > 1e-9 else "0"
