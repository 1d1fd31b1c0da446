"""A law of friction as a choice: a value of a few numbers, before anything is known of a mesh."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

from solver.arrays import Array
from solver.laws.sliders import Sliders
from solver.laws.tangential import Tangential


class FrictionLaw(ABC):
    """A law of friction, before anything is known of a mesh."""

    words: ClassVar[str]
    """What it is, for who chooses it."""

    @abstractmethod
    def on(self, sliders: Sliders, weights: Array, length: float) -> Tangential:
        """Give the law at pairs.

        Parameters
        ----------
        sliders
            What they would be with Coulomb's law.
        weights
            Tributary length or area of each pair, shape (n_pairs,), m or m^2.
        length
            Unit of lengths, m.
        """
