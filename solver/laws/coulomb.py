"""Coulomb's law of friction, as a structure chooses it."""

from __future__ import annotations

from dataclasses import dataclass

from solver.arrays import Array
from solver.laws.friction_law import FrictionLaw
from solver.laws.sliders import Sliders
from solver.laws.tangential import Tangential


@dataclass(frozen=True)
class Coulomb(FrictionLaw):
    """Coulomb's law."""

    words = "a point sticks until the friction force reaches its bound."

    def on(self, sliders: Sliders, weights: Array, length: float) -> Tangential:
        """Give the law at pairs, as `FrictionLaw.on`: it is theirs."""
        return sliders
