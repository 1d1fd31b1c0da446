"""Coulomb's and Tresca's friction: a point sticks until its friction force reaches r + mu N.

Where the pressure is known N is part of r. Along the search direction it is the play operator.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from solver.arrays import Array
from solver.laws.interface import Component
from solver.laws.play import Play
from solver.laws.springs import Springs
from solver.laws.tangential import Tangential, TangentialRule


@dataclass(frozen=True, kw_only=True)
class Sliders(Tangential):
    """Pairs that stick and slip; attributes as of `Tangential`."""

    component: Component
    bound: Array
    friction: Array
    start: Array | None = None

    of_pairs: ClassVar[tuple[str, ...]] = ("bound", "friction", "start")

    @classmethod
    def of_known_bound(cls, component: Component, bound: Array) -> Self:
        """Make those whose friction force is at most r, (n_pairs,) or also (..., n_instants)."""
        own = bound.reshape(len(bound), -1)
        return cls(component=component, bound=own, friction=np.zeros(len(bound)))

    @classmethod
    def of_contact(cls, component: Component, friction: Array) -> Self:
        """Make those whose friction force is at most mu N."""
        return cls(component=component, bound=np.zeros((len(friction), 1)), friction=friction)

    def rule(self, k: Array, n_instants: int) -> TangentialRule:
        """Prepare the law for one k and so many instants."""
        return SliderRule(self, k, n_instants)


class SliderRule:
    """The tangential component in the local stage.

    Attributes
    ----------
    springs
        Its search directions.
    reach, grows
        How far the jump may stay behind z, of the shape of the bound, and by how much more per
        pressing force, shape (n_pairs, 1).
    """

    def __init__(self, law: Sliders, k: Array, n_instants: int) -> None:
        self.springs = Springs(law.component, k)
        self.reach = law.bound * self.springs.soft
        self.grows = law.friction[:, None] * self.springs.soft
        self._play = Play(len(law.bound), n_instants, law.start)

    def __call__(
        self, incoming: Array, displacement: Array, some: slice, pressing: Array | None = None
    ) -> None:
        """Let the jump follow, within reach, as `TangentialRule`."""
        jump = self.springs.jump(incoming)
        reach = self.reach if pressing is None else self.reach + self.grows * pressing
        self.springs.close(incoming, jump, self.held(jump, reach), displacement)

    def held(self, jump: Array, reach: Array) -> Array:
        """Give the jump that the law allows, (n_pairs, n_instants); the next call overwrites it."""
        return self._play(jump, reach)
