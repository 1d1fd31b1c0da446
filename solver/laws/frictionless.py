"""No friction: nothing is said along the interface."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from solver.arrays import Array
from solver.laws.interface import Component
from solver.laws.springs import Springs
from solver.laws.tangential import Tangential, TangentialRule


@dataclass(frozen=True, kw_only=True)
class Frictionless(Tangential):
    """Pairs that slide freely."""

    component: Component
    bound: Array = field(init=False)
    friction: Array = field(init=False)

    def __post_init__(self) -> None:
        none = np.zeros(len(self.component.above))
        object.__setattr__(self, "bound", none[:, None])
        object.__setattr__(self, "friction", none)

    def begun(self, start: Array) -> Frictionless:
        """Remember nothing."""
        return self

    def rule(self, k: Array, n_instants: int) -> TangentialRule:
        """Let the jump be what it is."""
        springs = Springs(self.component, k)

        def slide(
            incoming: Array, displacement: Array, _some: slice, _pressing: Array | None = None
        ) -> None:
            jump = springs.jump(incoming)
            springs.close(incoming, jump, jump, displacement)

        return slide
