"""One instant of a scene, in the axes of its bodies, and how these lie on the page."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from app.picture.portrait import PITCH, THICKNESS, Portrait, Pose
from app.views.drawing import sketch
from app.views.drawing.drawing import Curve
from app.views.drawing.handles import choices
from solver.arrays import Array
from solver.discrete.structure import Description

DEEPEST = 0.2
"""Gap below a body that is drawn at most, as a share of the size."""
SLENDER = 5.0
"""Length over height of a body that is called long, at least."""
BESIDE = 4.0
"""Pixels from a contact to what is drawn beside it."""


class Posed:
    """What is where at one instant; `placed` turns it as the bodies lie.

    Attributes
    ----------
    described, size, length, height, nodes
        Of the bodies, m: the larger of their length and height, both, and their nodes as they are
        drawn, shape (n_nodes, 2).
    is_long
        Whether they are much longer than high, or several: then heights are not to scale.
    is_strand
        Whether it is one of helical wires, low beside its length: words stand in one line.
    factor
        On displacements.
    """

    def __init__(self, portrait: Portrait, pose: Pose, factor: float, time: float) -> None:
        self._portrait, self._pose, self._time = portrait, pose, time
        self.described: Description = portrait.described
        self.factor = factor
        self.length, self.height = portrait.size
        self.size = max(portrait.size)
        is_stacked = self.described.bodies > 1
        self.is_long = is_stacked or self.length > SLENDER * self.height
        self.is_strand = len(portrait.seams) > 0
        tilt = self.described.tilt
        self.tilts: Array = np.zeros(1) if tilt is None else tilt
        self._tilt = float(self.now(tilt)) if tilt is not None else 0.0
        self.nodes: Array = portrait.mesh.nodes + np.float32(factor) * pose.displacement

    def placed(self, points: Array) -> Array:
        """Give places, or strokes, on the page."""
        return self.turned(np.asarray(points, dtype=np.float64), self._tilt)

    def turned(self, points: Array, angle: float) -> Array:
        """Turn places, or strokes, about the middle of the bodies' foot, rad."""
        middle = np.zeros(points.shape[-1])
        middle[0] = 0.5 * self.length
        return sketch.turned(points - middle, angle) + middle

    def curve(self, stroke: Array, color: str, width: float, dash: str = "solid") -> Curve:
        """Give a stroke, or places alone, as a curve on the page."""
        found = self.placed(stroke).T
        dx, dy = found[2:] if len(found) == 4 else (0.0, 0.0)
        return Curve(found[0], found[1], color, width, dash, dx=dx, dy=dy)

    def band(self, status: int, color: str, width: float) -> Curve:
        """Give the stretches of all contacts that have a status, beside a single body."""
        places, chains = self._contacts(), self._portrait.chains
        is_straight = self.described.height is None
        found = [np.full((1, 2), np.nan)]
        for chain in range(int(chains.max()) + 1):
            own = chains == chain
            for one in sketch.stretches(places[own], self._pose.status[own] == status):
                found += [one[[0, -1]] if is_straight else one, found[0]]
        x, y = self.placed(np.concatenate(found[1:] or found)).T
        beside = (0.0, -BESIDE if self.described.bodies == 1 else 0.0)
        dx, dy = sketch.turned(np.array(beside), self._tilt)
        return Curve(x, y, color, width, dx=dx, dy=dy)

    def outlines(self) -> Iterator[Array]:
        """Give the undeformed bodies."""
        nodes = self._portrait.mesh.nodes[self._portrait.mesh.quads]
        for body in nodes.reshape(self.described.bodies, -1, 2):
            (left, low), (right, high) = body.min(axis=0), body.max(axis=0)
            yield np.array([[left, low], [right, low], [right, high], [left, high], [left, low]])

    def outline_of(self, part: int) -> Array:
        """Give the deformed edge of a substructure: sides that only one of its quads has."""
        quads = self._portrait.mesh.quads[self._portrait.mesh.parts == part]
        sides = np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2)
        _, first, counts = np.unique(
            np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True
        )
        return sketch.joined(sketch.line(one) for one in self.nodes[sides[first[counts == 1]]])

    def across(self, place: float) -> Array:
        """Give a line through all bodies at a place along them, m."""
        return self.moved(np.array([[place, 0.0], [place, self.height]]))

    def broken(self) -> Iterator[Array]:
        """Give both ends of a broken wire."""
        if self.described.broken is None:
            return
        body, x = self.described.broken
        low = PITCH * self.length * body
        ends = np.array([[x, low], [x, low + THICKNESS * self.length]])
        nodes = self._portrait.mesh.nodes
        on = np.abs(nodes - ends[0]).max(axis=1) < 1e-4 * self.length
        for moved in self.nodes[on, 0]:
            yield sketch.line([(moved, ends[0, 1]), (moved, ends[1, 1])], [[0.0, -2.0], [0.0, 2.0]])

    def seams(self) -> Array:
        """Give the lines on the bodies, shape (n, 2), m; none of most."""
        moved, seams = self._pose.seams, self._portrait.seams
        return np.asarray(seams if moved is None else seams + np.float32(self.factor) * moved)

    def line_of(self, number: int) -> Array:
        """Give where an interface lies, by its number, shape (n, 2), m."""
        return np.asarray(self._contacts()[self._portrait.chains == number])

    def contacts(self, names: Sequence[str]) -> dict[str, Array]:
        """Give where interfaces lie on the page, as far as there are several to choose from."""
        places, chains = self._contacts(), self._portrait.chains
        found = {name: places[chains == number] for number, name in enumerate(names)}
        return {name: self.placed(one) for name, one in choices(found).items()}

    def _contacts(self) -> Array:
        """Give where contact points are; those of wires lie between them."""
        found = self._portrait.places + np.float32(self.factor) * self._pose.slid
        if self.described.height is None and self.described.bodies > 1:
            return np.asarray(found - [0.0, 0.5 * (PITCH - THICKNESS) * self.length])
        return found

    def gap(self) -> Array | None:
        """Give the gap as it is drawn: magnified as displacements are, and at most so deep."""
        gaps = [hold.gap for hold in self.described.holds if hold.gap is not None]
        return np.minimum(self.factor * gaps[0], DEEPEST * self.size) if gaps else None

    def moved(self, places: Array) -> Array:
        """Give where the nodes nearest to undeformed places have gone, as seen from there."""
        nodes = self._portrait.mesh.nodes
        nearest = [int(np.argmin(np.sum((nodes - place) ** 2, axis=1))) for place in places]
        return np.asarray(places + self.factor * self._pose.displacement[nearest])

    def now(self, values: Array) -> Array:
        """Give values over time at the chosen instant."""
        instants = self.described.instants
        flat = np.atleast_2d(values)
        found = np.array([np.interp(self._time, instants, one) for one in flat])
        return found if values.ndim > 1 else found[0]
