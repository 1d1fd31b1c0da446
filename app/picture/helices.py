"""From a strand that is bent to how it looks from the side: the wires in front of its outer layer.

One looks across the plane of bending, onto a cylinder that the outer wires share: each has its
strip of it, and half of them are hidden behind it at any place.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from app.picture.portrait import Portrait, Pose
from app.picture.shown import Bytes, Floats, Mesh, MeshField, floats
from solver.arrays import Array
from solver.discrete.rope.rope import Rope
from solver.latin import Iterate

A_TURN, FEWEST, MOST = 28, 48, 200
"""Steps along the strand for each turn of an outer wire, and their number in any case."""
ROUGH = 2
"""Steps between the points of a wire by which a tap on it is known."""


@dataclass(frozen=True, eq=False)
class _Strips:
    """Parts of the strips that are in front: their wire and step, shape (n,), and both sides.

    The sides are angles at both ends of the step, shape (n, 4), in the order of a quadrilateral.
    """

    wires: NDArray[np.intp]
    steps: NDArray[np.intp]
    corners: Array


class HelixGeometry:
    """A strand as its portraits see it.

    Parameters
    ----------
    rope
        What is drawn.
    """

    def __init__(self, rope: Rope) -> None:
        described = rope.described()
        assert described.height is not None
        self._rope = rope
        outer = max(wire.layer for wire in rope.wires)
        wires = [wire for wire in rope.wires if wire.layer == outer]
        self._helix = helix = wires[0].helix
        self._count = sum(wire.stands_for for wire in wires)
        self._numbers: Array = np.arange(self._count, dtype=np.float64)
        self._first = len(rope.wires) - len(wires)
        self._radius = 0.5 * described.height
        turns = described.length * np.tan(abs(helix.lay)) / (2.0 * np.pi * helix.radius)
        count = int(np.clip(A_TURN * turns, FEWEST, MOST))
        self._z = np.linspace(0.0, described.length, count + 1)
        strips = self._strips()
        mesh = self._mesh(strips)
        self._points, self._sides = self._nearest(strips)
        places, chains = self._lines()
        self.portrait = Portrait(
            replace(described, bodies=1), mesh, floats(places), chains, self._seams()
        )
        self._up, self._slope = self._bent()
        self._largest = float(np.abs(self._up).max())

    def pose(self, iterate: Iterate, column: int, bodies: MeshField | None) -> Pose:
        """Show where the strand has gone at one instant, and what slips."""
        nodes, places = self.portrait.mesh.nodes, self.portrait.places
        status = iterate.status[self._points, column] * self._sides
        return Pose(
            displacement=self._moved(nodes, column),
            largest=self._largest,
            slid=self._moved(places, column),
            status=np.zeros(len(places), dtype=np.int8),
            colors=status.astype(np.int8),
            seams=self._moved(self.portrait.seams, column),
        )

    def _angle(self, wire: Array, place: Array) -> Array:
        """Give the polar angle of outer wires by their number, halves for what is between them."""
        turned = place * np.tan(self._helix.lay) / self._helix.radius
        return np.asarray(2.0 * np.pi * wire / self._count + turned)

    def _height(self, angle: Array) -> Array:
        """Give the height of the outermost surface at an angle; the outermost fibre is below."""
        return np.asarray(self._radius * (1.0 - np.cos(angle)))

    def _strips(self) -> _Strips:
        """Find what is in front, at angles from 0 to pi: its two sides are cut off there."""
        half = np.pi / self._count
        middle = self._angle(self._numbers[:, None], self._z[None, :])
        first = np.remainder(middle[:, :-1] + half, 2.0 * np.pi) - half
        sides = [first - half, first + half]
        sides += [one + np.diff(middle, axis=1) for one in sides[::-1]]
        # Low, low, high, high around the quadrilateral; what lies behind has no height left.
        low, high, high_next, low_next = sides
        corners = np.clip(np.stack([low, low_next, high_next, high], axis=-1), 0.0, np.pi)
        wires, steps = np.nonzero(np.ptp(corners, axis=-1) > 1e-9)
        return _Strips(wires, steps, corners[wires, steps])

    def _mesh(self, strips: _Strips) -> Mesh:
        """Give the strips as quadrilaterals that share their corners."""
        rows = strips.steps[:, None] + np.array([0, 1, 1, 0])
        keys = np.stack([rows.ravel(), np.round(1e6 * strips.corners.ravel()).astype(int)], axis=1)
        _, first, place = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        heights = self._height(strips.corners.ravel())[first]
        nodes = np.stack([self._z[rows.ravel()[first]], heights], axis=1)
        quads = place.reshape(-1, 4).astype(np.int32)
        return Mesh(floats(nodes), quads, np.zeros(len(quads), dtype=np.intp))

    def _nearest(self, strips: _Strips) -> tuple[NDArray[np.intp], Bytes]:
        """Give the point of contact nearest to each, and which way its slip is seen."""
        rope, points = self._rope, self._rope.elements - 1
        middle = 0.5 * (self._z[strips.steps] + self._z[strips.steps + 1])
        wires, sides = self._first + strips.wires, np.ones(len(middle), dtype=np.int8)
        share = middle / self._z[-1]
        if not rope.is_clamped:
            turned = np.sign(self._helix.lay) * self._angle(self._numbers[strips.wires], middle)
            wires = np.full(len(middle), self._first)
            share = np.arccos(np.cos(turned)) / np.pi
            sides = np.where(np.sin(turned) < 0.0, -1, 1).astype(np.int8)
        node = np.clip(np.round(share * rope.elements).astype(np.intp), 1, max(points, 1))
        return wires * points + node - 1, sides

    def _lines(self) -> tuple[Array, NDArray[np.intp]]:
        """Give lines along the wires in front, of each its own, and the interfaces that they are.

        Under a uniform curvature all of them are one.
        """
        if not self._rope.is_clamped:
            return np.zeros((0, 2)), np.zeros(0, dtype=np.intp)
        lines = self._in_front(0.0, slice(None, None, ROUGH))
        chains = [np.full(len(one), self._first + number) for number, one in enumerate(lines)]
        return np.concatenate(lines), np.concatenate(chains)

    def _seams(self) -> Floats:
        """Give lines between the wires in front."""
        return floats(np.concatenate(self._in_front(0.5, slice(None))))

    def _in_front(self, beside: float, steps: slice) -> list[Array]:
        """Give a line along every wire, broken by NaN where it is hidden, shape (n, 2) each.

        It lies so many wires beside their middles.
        """
        z = self._z[steps]
        angle = self._angle(self._numbers[:, None] + beside, z[None, :])
        angle = np.remainder(angle, 2.0 * np.pi)
        heights = np.where(angle <= np.pi, self._height(angle), np.nan)
        found = []
        for own in heights:
            line = np.append(np.stack([z, own], axis=1), [[np.nan, np.nan]], axis=0)
            is_seen = np.isfinite(line[:, 1])
            # One NaN is enough between two stretches.
            found.append(line[is_seen | np.append(True, is_seen[:-1])])
        return found

    def _bent(self) -> tuple[Array, Array]:
        """Integrate the curvature: give height and slope of the axis, (n_places, n_instants).

        From the clamp, or about the middle.
        """
        wire = self._rope.wires[self._first]
        share = np.interp(self._z, wire.along, np.arange(len(wire.along), dtype=float))
        low = np.minimum(share.astype(np.intp), len(wire.along) - 2)
        part = (share - low)[:, None]
        curvature = (1.0 - part) * wire.curvature[low] + part * wire.curvature[low + 1]
        if not self._rope.is_clamped:
            curvature = np.broadcast_to(self._rope.curvature, (len(self._z), curvature.shape[1]))
        step = float(self._z[1])
        summed = np.cumsum(0.5 * step * (curvature[1:] + curvature[:-1]), axis=0)
        slope = np.concatenate([np.zeros((1, summed.shape[1])), summed])
        summed = np.cumsum(0.5 * step * (slope[1:] + slope[:-1]), axis=0)
        up = np.concatenate([np.zeros((1, summed.shape[1])), summed])
        if not self._rope.is_clamped:
            middle = len(self._z) // 2
            up = up - up[middle] - slope[middle] * (self._z - self._z[middle])[:, None]
            slope = slope - slope[middle]
        return up, slope

    def _moved(self, places: Floats, column: int) -> Floats:
        """Give the displacement of places: sections stay plane, and at right angles to the axis."""
        x, y = places.T
        up = np.interp(x, self._z, self._up[:, column])
        slope = np.interp(x, self._z, self._slope[:, column])
        return floats(np.stack([-slope * (y - self._radius), up], axis=1))
