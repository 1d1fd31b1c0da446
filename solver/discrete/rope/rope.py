"""A strand of helical wires that is bent, as a structure."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from solver.discrete.loops import Loop
from solver.discrete.probes import Probe, constant
from solver.discrete.problem import Problem
from solver.discrete.rope.data import RopeData
from solver.discrete.rope.problem import discretise_rope
from solver.discrete.structure import OUTWARD, Act, Description, Hold


class Rope(RopeData):
    """Helical wires as a structure; the attributes are those of `RopeData`."""

    def discretise(self) -> Problem:
        """Make the discrete problem."""
        return discretise_rope(self)

    def moment(self) -> Probe:
        """Give the bending moment of the strand, N m, from what its wires slip.

        At the clamp, or the mean along the strand, which is that of every section; with the wires
        bent each about their own axis.
        """
        weights, stuck = [], self.section.slipping_bending * self.curvature
        for wire in self.wires:
            helix, arc = wire.helix, wire.arc
            find = helix.levers_at_beginning if self.is_clamped else helix.mean_levers
            levers = wire.stands_for * find(arc)
            spring = helix.stiffness * levers / np.diff(arc)
            weights.append(np.concatenate([[0.0], spring]) - np.concatenate([spring, [0.0]]))
            force = helix.stuck_force(arc, wire.curvature)
            stuck = stuck + levers @ (0.5 * (force[1:] + force[:-1]))
        together = np.concatenate(weights)
        dofs = np.flatnonzero(together)
        return Probe(dofs, together[dofs], stuck)

    def loop(self, problem: Problem) -> Loop:
        """Give the moment over the curvature, which drives it."""
        moment = self.moment()
        across = "Curvature at the clamp" if self.is_clamped else "Curvature"
        return Loop(
            (across, "1/m"),
            ("Moment", "N·m"),
            constant(self.curvature),
            lambda fields: moment(fields.displacement),
        )

    def described(self) -> Description:
        """Say what there is, for whoever draws it."""
        return Description(
            bodies=1,
            length=self.seen_length,
            height=self.section.diameter,
            instants=self.instants,
            acts=tuple(act for act in self._acts() if np.any(act.values)),
            holds=tuple(self._holds()),
        )

    def _holds(self) -> Iterator[Hold]:
        """Give the clamp; beside it wires move, unlike a bar, as far as anywhere."""
        if self.is_clamped:
            yield Hold("clamp", "left", moved=np.zeros(len(self.instants)))

    def _acts(self) -> Iterator[Act]:
        end = np.array([[1.0, 0.5]])
        right, up = OUTWARD["right"], OUTWARD["top"]
        yield Act("right y", "κ", end, up, right, self.curvature, "1/m")
        yield Act("right x", "T", end, right, right, self.tension, "N")
