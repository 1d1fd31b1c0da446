"""Stick and slip over space and time."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.picture.frames import Stand
from app.picture.shown import Bytes
from app.views.drawing.colors import (
    BACKWARD,
    FORWARD,
    FRONT,
    GREEN,
    GREY,
    OPEN,
    PURPLE,
    STICK,
    VERMILION,
)
from app.views.drawing.drawing import POSITION, TIME, Curve, Drawing, Image, Plot, View
from app.views.drawing.legend import Key
from app.views.drawing.scales import across, along, over_time, upright
from app.views.scene import Scene
from solver.arrays import Array

KEYS = (
    Key(BACKWARD, "square", "slip −"),
    Key(STICK, "square", "stick"),
    Key(FORWARD, "square", "slip +"),
)
CHOSEN = Key(VERMILION, "line", "chosen instant")
CHANGED = Key(PURPLE, "line", "changed status")
OPENED = (Key(OPEN, "square", "open"), Key(VERMILION, "line", "instant"))


def draw(scene: Scene, _kept: Any) -> Drawing:
    """Draw the contact status, the cuts, and the chosen instant."""
    begun, places, instants = scene.run.stand, scene.run.stand.positions, scene.run.stand.instants
    half_x, half_t = 0.5 * _step(places), 0.5 * _step(instants)
    first_x, last_x = float(places[0]), float(places[-1])
    first_t, last_t = float(instants[0]), float(instants[-1])
    x = along(0.0, scene.length)
    y = over_time(*_ends(scene, first_t - half_t, last_t + half_t))
    image = Image(
        np.ascontiguousarray((scene.frame.fields.status + 1).astype(np.uint8).T),
        left=first_x - half_x,
        low=first_t - half_t,
        width=last_x - first_x + 2 * half_x,
        height=last_t - first_t + 2 * half_t,
    )
    curves = [
        upright(begun.cuts, y, color=GREY, width=1),
        across([float(instants[scene.instant])], x, color=VERMILION, width=3),
    ]
    ghosts = []
    for exact in begun.known("front"):
        curves.append(Curve(exact.across, exact.up, GREEN, 3))
        ghosts.append(Key(GREEN, "line", "closed form"))
    if (changes := scene.frame.changes) is not None and changes[1].any():
        curves.append(_outlines(begun, changes[1], scene.length))
        ghosts.append(CHANGED)
    if scene.ghost is not None:
        before, fields, _ = scene.ghost
        curves.insert(0, _fronts(before.stand, fields.status, scene.length))
        ghosts.append(Key(FRONT, "front", scene.ghost_name))
    can_open = begun.coefficient is not None
    keys = (*KEYS, *OPENED) if can_open else (*KEYS, CHOSEN)
    return Drawing(x, y, curves, image=image, keys=(*keys, *ghosts))


def _ends(scene: Scene, low: float, high: float) -> tuple[float, float]:
    """Give the ends of all instants of a map, s, and of those of the ghost."""
    if scene.ghost is None:
        return low, high
    times = _edges(scene.ghost[0].stand.instants)
    return min(low, float(times[0])), max(high, float(times[-1]))


def _outlines(stand: Stand, marked: NDArray[np.bool_], length: float) -> Curve:
    """Give the lines around points and instants that are marked."""
    x, t = _edges(stand.positions).clip(0.0, length), _edges(stand.instants)
    around = np.pad(marked, 1)
    i, j = np.nonzero(around[1:, 1:-1] != around[:-1, 1:-1])
    sides = (x[i], x[i], t[j], t[j + 1])
    i, j = np.nonzero(around[1:-1, 1:] != around[1:-1, :-1])
    return _strokes(np.concatenate([sides, (x[i], x[i + 1], t[j], t[j])], axis=1), PURPLE, 1.5)


def _strokes(ends: Array, color: str, width: float) -> Curve:
    """Give lines from x to x and from t to t, (4, n_lines), as one curve."""
    first, last, low, high = ends
    gap = np.full(len(first), np.nan)
    xs, ts = np.stack([first, last, gap], axis=1), np.stack([low, high, gap], axis=1)
    return Curve(xs.ravel(), ts.ravel(), color, width)


def _fronts(stand: Stand, status: Bytes, length: float) -> Curve:
    """Give the lines between points and instants of different status."""
    x, t = _edges(stand.positions).clip(0.0, length), _edges(stand.instants)
    i, j = np.nonzero(status[1:] != status[:-1])
    vertical = (x[i + 1], x[i + 1], t[j], t[j + 1])
    i, j = np.nonzero(status[:, 1:] != status[:, :-1])
    level = (x[i], x[i + 1], t[j + 1], t[j + 1])
    return _strokes(np.concatenate([vertical, level], axis=1), FRONT, 1)


def _edges(axis: np.ndarray) -> np.ndarray:
    half = 0.5 * _step(axis)
    return np.concatenate([axis - half, axis[-1:] + half])


def _step(axis: np.ndarray) -> float:
    return float(axis[-1] - axis[0]) / (len(axis) - 1) if len(axis) > 1 else 1.0


VIEW = View(
    "Stick and slip",
    Plot(POSITION, TIME, palette=(BACKWARD, STICK, FORWARD, OPEN), chooses="instant"),
    draw,
)
