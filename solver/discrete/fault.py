"""A fault in a body under uniform shear, of which one quarter is enough.

The body above the fault, to the right of its middle. Below lies its image turned by half a turn, so
that no pressure changes on the fault and its strength is known; to the left lies the other image,
which moves along as much and across the other way round. The fault slips by twice what this
quarter moves along it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.discrete.probes import Probe
from solver.discrete.problem import Problem
from solver.discrete.stack import Given, Side, Stack
from solver.discrete.structure import OUTWARD, Act, Description, Hold, Loop


@dataclass(frozen=True, eq=False)
class Fault:
    """A fault as a structure.

    Attributes
    ----------
    body
        The quarter, on a support of known bound; its sides as `sheared` gives them.
    stress
        Shear stress far from the fault, Pa.
    fluid
        Pressure over time of a fluid that is let in at the middle, shape (n_instants,), Pa, for
        whoever draws it: the bound is less by what it takes already.
    """

    body: Stack
    stress: float
    fluid: Array

    def discretise(self) -> Problem:
        """Make the discrete problem."""
        return self.body.discretise()

    def loop(self, problem: Problem) -> Loop:
        """Friction of the quarter over how far it has moved at the middle."""
        law = problem.rubbing["support"]
        return Loop(
            ("Displacement at the well", "m"),
            ("Friction force", "N"),
            Probe(problem.row_dofs[law.tangential.component.above[:1]], np.ones(1)),
            lambda fields: -fields.contact("support").tangential_force.sum(axis=0),
        )

    def described(self) -> Description:
        """What there is, for whoever draws it."""
        body = self.body
        return Description(
            bodies=1,
            length=body.length,
            height=body.height,
            instants=body.instants,
            acts=tuple(self._acts()),
            holds=(Hold("image", "bottom"), Hold("rollers", "top")),
        )

    def _acts(self) -> Iterator[Act]:
        along = (1.0, 0.0)
        stress = np.full_like(self.fluid, self.stress)
        yield Act("top x", "τ", np.array([[0.5, 1.0]]), along, OUTWARD["top"], stress, "Pa")
        yield Act("left x", "p", np.zeros((1, 2)), along, OUTWARD["left"], self.fluid, "Pa")


def sheared(stress: float, modulus: float, height: float, count: int) -> dict[str, Side]:
    """What is prescribed along the sides of the quarter, of a height, m, over so many instants.

    The top is moved as far as the shear stress takes, with the shear modulus, Pa both, and holds
    the body where all of the fault slips.
    """
    none, whole = np.zeros(count), np.ones(count)
    level, free = Given(True, none), Given(False, none)
    return {
        "left": Side(free, level),
        "right": Side(free, Given(False, stress * whole)),
        "top": Side(Given(True, stress / modulus * height * whole), level),
    }
