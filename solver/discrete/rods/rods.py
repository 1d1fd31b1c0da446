"""Elastic rods that rub on a support, or on each other."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from solver.discrete.loops import Loop, loop_of_ends
from solver.discrete.problem import Problem
from solver.discrete.rods.data import RodsData
from solver.discrete.rods.problem import discretise_rods
from solver.discrete.structure import OUTWARD, Act, Description, Hold

ACTED = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
"""Where a body force that changes along the rods is shown."""
PRESSED = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
"""Where the pressure is shown, as far as anything rubs there."""
SEVERAL = 8
"""Wires up to which the load of each is shown."""


class Rods(RodsData):
    """Rods as a structure; the attributes are those of `RodsData`."""

    def discretise(self) -> Problem:
        """Make the discrete problem."""
        return discretise_rods(self)

    def loop(self, problem: Problem) -> Loop:
        """Give the force on the loaded ends over their displacement."""
        return loop_of_ends(problem, "Force" if self.wires == 1 else "Tension")

    def described(self) -> Description:
        """Say what there is, for whoever draws it."""
        broken = self.broken and (self.broken[0] - 1, float(self.nodes[self.broken[1]]))
        return Description(
            bodies=self.wires,
            length=self.length,
            height=None,
            instants=self.instants,
            acts=tuple(act for act in self._acts() if np.any(act.values)),
            holds=tuple(self._holds()),
            broken=broken,
        )

    def _acts(self) -> Iterator[Act]:
        start, pulled = np.array([[0.0, 0.5]]), self.wires if self.wires <= SEVERAL else 1
        heights = (np.arange(pulled) + 0.5) / pulled
        end = np.stack([np.ones(pulled), heights], axis=1)
        right = OUTWARD["right"]
        if self.rigid_grip:
            moved = self.load * self.length / self.stiffness
            yield Act("right x", "u", end, right, right, moved, "m")
        else:
            yield Act("right x", "F", end, right, right, self.load, "N")
        if self.support is not None:
            yield Act("left x", "u", start, right, OUTWARD["left"], self.support, "m")
        if self.body_force is not None:
            x = np.array([0.5]) if self.body_force.ndim == 1 else ACTED
            middle = np.stack([x, np.full(len(x), 0.5)], axis=1)
            nearest = np.rint(x * self.elements).astype(np.intp)
            values = self.body_force if self.body_force.ndim == 1 else self.body_force[nearest]
            yield Act("body", "b", middle, right, right, values, "N/m")
        most = self.bounds.max(axis=1)
        x = PRESSED[np.interp(PRESSED, self.nodes / self.length, most) > 0.0]
        if self.pressure is not None and len(x):
            places = np.stack([x, np.ones_like(x)], axis=1)
            ways = OUTWARD["bottom"], OUTWARD["top"]
            yield Act("top y", "p", places, *ways, self.pressure, "N/m")

    def _holds(self) -> Iterator[Hold]:
        yield Hold("clamp", "left", moved=self.support)
        if self.wires > 1:
            return
        rubs = np.flatnonzero(self.bounds.any(axis=1))
        for run in np.split(rubs, np.flatnonzero(np.diff(rubs) > 1) + 1):
            if len(run) > 1:
                first, last = run[[0, -1]] / self.elements
                yield Hold("support", "bottom", (float(first), float(last)))
