"""Arrows of loads and motions, and footings, of bodies of any shape for drawings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.plane.beams import Beam
from solver.discrete.plane.body import Body, Held, Load
from solver.discrete.plane.joint import Joint
from solver.discrete.structure import (
    MOVED,
    Act,
    Direction,
    Footing,
    act_of_weight,
    directed,
)

STRAIGHT = 1e-9
"""Motion aside, over the largest motion, of displacements along one direction."""


class DrawnBodies:
    """Arrows and footings of bodies, at shares of the box around them.

    Parameters
    ----------
    bodies, held
        Bodies, and holds of their nodes.
    box
        Lower left corner of all bodies, and their size, shape (2,) both, m.
    """

    def __init__(
        self,
        bodies: Sequence[Body],
        held: Sequence[Held],
        box: tuple[Array, Array],
    ) -> None:
        self._bodies = bodies
        self._held = held
        self._box = box

    def acts(self, loads: Sequence[Load], weights: Array) -> Iterator[Act]:
        """Yield loads, prescribed displacements, and the weight.

        `weights` is that of all bodies together, shape (2, n_instants), N.
        """
        for alike in self._held_by_nodes():
            yield from self._acts_of_held(alike)
        for held in self._held:
            if held.axis == 2:
                yield self._act(held, "φ", (0.0, 1.0), held.mean, "rad")
        for load in loads:
            directions, sizes = directed(load.force.sum(axis=0))
            pressure = load.pressure
            if pressure is None:
                yield self._act(load, "F", directions, sizes, "N")
            else:
                symbol = "p" if pressure.min() >= 0.0 else "σ"
                yield self._act(load, symbol, directions, np.abs(pressure), "Pa")
        yield act_of_weight(weights)

    def _held_by_nodes(self) -> list[list[Held]]:
        """Holds, grouped with those of the same nodes along the other axis."""
        axes = dict[tuple[int, bytes], list[Held]]()
        for held in self._held:
            if held.axis < 2:
                axes.setdefault((held.body, held.nodes.tobytes()), []).append(held)
        return list(axes.values())

    def _acts_of_held(self, alike: Sequence[Held]) -> Iterator[Act]:
        """Arrows of displacements of the same nodes: one if their path is straight."""
        moved = [held for held in alike if np.any(held.mean)]
        if len(moved) == 2:
            motion = np.zeros((2, len(moved[0].mean)))
            for held in moved:
                motion[held.axis] = held.mean
            directions, sizes = directed(motion)
            towards = directions[:, sizes.argmax()]
            values = towards @ motion
            aside = motion - np.outer(towards, values)
            if np.abs(aside).max() <= STRAIGHT * sizes.max():
                yield self._act(moved[0], "u", towards, values, "m")
                return
        for held in moved:
            towards = np.eye(2)[held.axis]
            yield self._act(held, MOVED[held.axis], towards, held.mean, "m")

    def _act(
        self,
        given: Held | Load,
        symbol: str,
        towards: Direction | Array,
        values: Array,
        unit: str,
    ) -> Act:
        """Arrow of a hold or a load, at the middle one of its nodes."""
        along = np.asarray(towards)
        if along.ndim > 1:
            along = along[:, np.abs(values).argmax()]
        # Of several sides the one that is farthest in the direction of positive values.
        lines = self._lines(given)
        nodes, outward = max(lines, key=lambda line: along @ line[1].mean(axis=0))
        middle = len(nodes) // 2
        points = self.as_shares(self._bodies[given.body].nodes[nodes[[middle]]])
        away = outward[middle]
        if not self._chains_of(given):
            # At a point without a normal there is room along the load.
            away = np.copysign(1.0, along @ away) * along
        x, y = away.tolist()
        return Act(given.name, symbol, points, towards, values, unit, (x, y))

    def _chains_of(self, given: Held | Load) -> list[Indices]:
        """Chains of edges along the nodes of a hold or load; [] for single nodes."""
        shape = self._bodies[given.body].shape
        if isinstance(shape, Beam):
            return []
        return shape.chains_of(given.nodes)

    def _lines(self, given: Held | Load) -> list[tuple[Indices, Array]]:
        """Nodes of a hold or load in order along lines, (n,), and unit vectors outward.

        The vectors point out of the body, (n, 2): those of its edges, or where the
        nodes are no chains of edges all the way from its middle to theirs.
        """
        body = self._bodies[given.body]
        chains = self._chains_of(given)
        if chains:
            return [(chain, body.outward(chain)) for chain in chains]
        places = body.nodes[given.nodes]
        order = np.argsort(places[:, int(np.ptp(places, axis=0).argmax())])
        beyond = places.mean(axis=0) - body.nodes.mean(axis=0)
        size = float(np.hypot(*beyond))
        outward = np.array([0.0, -1.0])
        if size > 0.0:
            outward = beyond / size
        return [(given.nodes[order], np.tile(outward, (len(order), 1)))]

    def footings(self, joints: Sequence[Joint]) -> Iterator[Footing]:
        """Yield rigid supports, and nodes that are held, moved or not."""
        for joint in joints:
            if joint.below is None:
                points = self._bodies[joint.above].nodes[joint.nodes]
                gap = np.broadcast_to(joint.gap, len(points))
                yield Footing("support", self.as_shares(points), -joint.normals, gap)
        # Nodes that are held along both axes are clamped.
        for alike in self._held_by_nodes():
            kind: Literal["clamp", "rollers"] = "rollers"
            if len(alike) > 1:
                kind = "clamp"
            for nodes, outward in self._lines(alike[0]):
                points = self.as_shares(self._bodies[alike[0].body].nodes[nodes])
                yield Footing(kind, points, outward)

    def as_shares(self, points: Array) -> Array:
        """Points, (n, 2, ...), m, as shares of the length and height of all bodies."""
        corner, size = self._box
        axes = (2,) + (1,) * (points.ndim - 2)
        size = np.where(size > 0.0, size, 1.0).reshape(axes)
        return np.asarray((points - corner.reshape(axes)) / size)
