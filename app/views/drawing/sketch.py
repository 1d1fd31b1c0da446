"""Strokes of which a picture of a scene is made: arrows, hatches, rollers, a spring; and its words.

A stroke is a polyline, shape (n, 4), in which NaN interrupts the line. Every point is a place, m,
and how many pixels right of and above it the point lies: what only means something has one size
however large the bodies are drawn.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike

from app.picture.units import minus, rounded
from solver.arrays import Array

BREAK = np.full((1, 4), np.nan)
HEAD, LARGEST_HEAD = 0.45, 10.0
"""Of an arrow, as a share of its length, and in pixels at most."""
BOWED = 0.35
"""How far a bent arrow goes aside, as a share of its length."""
DEPTH = 12.0
"""Of a hatch, px."""
COILS = 4


def joined(strokes: Iterable[Array]) -> Array:
    """Put polylines into one."""
    found = [part for stroke in strokes for part in (stroke, BREAK)]
    return np.concatenate(found) if found else BREAK


def line(places: ArrayLike, shifts: ArrayLike = (0.0, 0.0)) -> Array:
    """Give a line through places, shape (n, 2), m, each or all of them shifted, px."""
    at = np.asarray(places, dtype=np.float64)
    return np.concatenate([at, np.broadcast_to(np.asarray(shifts, float), at.shape)], axis=1)


def arrow(place: Array, tail: Array, head: Array) -> Array:
    """Give an arrow at a place, m, whose ends are shifted, px."""
    along = head - tail
    length = float(np.hypot(*along))
    if length == 0.0:
        return BREAK
    back = -along / length * min(HEAD * length, LARGEST_HEAD)
    side = 0.5 * np.array([-back[1], back[0]])
    shifts = np.stack([tail, head, head + back + side, head, head + back - side])
    return line(np.tile(place, (5, 1)), shifts)


def bow(place: Array, tail: Array, head: Array) -> Array:
    """Give an arrow that is bent to the right of its upward way, as what bends has it."""
    along = head - tail
    length = float(np.hypot(*along))
    if length == 0.0:
        return BREAK
    angle = np.linspace(-1.0, 1.0, 13)[:, None]
    aside = np.array([abs(along[1]), 0.0])
    shifts = 0.5 * (tail + head) + 0.5 * np.sin(0.5 * np.pi * angle) * along
    shifts = shifts + BOWED * np.cos(0.5 * np.pi * angle) * aside
    end = arrow(place, shifts[-3], shifts[-1])
    return joined([line(np.tile(place, (13, 1)), shifts), end])


def hatched(edge: Array, count: int, behind: float = -1.0) -> Array:
    """Give a stroke and so many slanted ones behind it, on its right (-1) or its left (1)."""
    whole = edge[-1] - edge[0]
    along = whole[:2] if np.any(whole[:2]) else whole[2:]
    along = along / np.hypot(*along)
    steps = np.hypot(*np.diff(edge[:, :2], axis=0).T)
    places = np.concatenate([[0.0], np.cumsum(steps if np.any(steps) else np.ones(len(steps)))])
    at = (np.arange(count) + 0.5) / count * places[-1]
    feet = np.stack([np.interp(at, places, one) for one in edge.T], axis=1)
    deep = DEPTH * (behind * np.array([-along[1], along[0]]) - 0.6 * along)
    ends = feet + np.concatenate([np.zeros(2), deep])
    strokes = np.stack([feet, ends, np.full_like(feet, np.nan)], axis=1).reshape(-1, 4)
    return np.concatenate([edge, BREAK, strokes])


def rollers(ends: Array, outward: Array) -> Array:
    """Give four circles along a line, shape (2, 2), m, on its outer side."""
    angle, radius = np.linspace(0.0, 2.0 * np.pi, 17), 0.5 * DEPTH
    circle = radius * (np.stack([np.cos(angle), np.sin(angle)], axis=1) + outward)
    first, last = ends
    centres = first + np.linspace(0.0, 1.0, 4)[:, None] * (last - first)
    return joined(line(np.tile(one, (17, 1)), circle) for one in centres)


def spring(ends: Array, height: float) -> Array:
    """Give a zigzag between two places, (2, 2), m, so many pixels above them."""
    at = np.linspace(0.0, 1.0, 2 * COILS + 1)[:, None]
    along = (ends[1] - ends[0]) / max(float(np.hypot(*(ends[1] - ends[0]))), 1e-300)
    aside = np.where(np.arange(2 * COILS + 1) % 2, 0.5 * DEPTH, -0.5 * DEPTH)
    aside[[0, -1]] = 0.0
    shifts = aside[:, None] * [-along[1], along[0]] + [0.0, height]
    return line(ends[0] + at * (ends[1] - ends[0]), shifts)


def stretches(places: Array, chosen: Array) -> list[Array]:
    """Give the places of every run of chosen points, which reaches halfway to its neighbours."""
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
    """Turn points, or strokes, about the origin, counter-clockwise, rad."""
    if angle == 0.0:
        return points
    cos, sin = np.cos(angle), np.sin(angle)
    pairs = points.reshape(*points.shape[:-1], -1, 2)
    return np.asarray(pairs @ np.array([[cos, sin], [-sin, cos]])).reshape(points.shape)


def plain(value: float) -> str:
    """Write a number with three digits at most, and zero without a sign."""
    return minus(rounded(value)) if abs(value) > 1e-9 else "0"
