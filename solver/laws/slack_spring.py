"""A spring that is slack at first: a stop that gives way.

It is unilateral contact with a compliance in series, as `solver.laws.compliant` has it along the
interface: of the opening g and the pressing force N, g + N / k_s >= 0, N >= 0, and one of them is
zero. So along the search direction the two springs share what is missing.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from solver.arrays import Array
from solver.laws.interface import Rule
from solver.laws.tangential import TangentialRule
from solver.laws.unilateral import ContactRule, Unilateral


@dataclass(frozen=True, kw_only=True)
class SlackSpring(Unilateral):
    """Pairs that push in proportion once their gap is closed.

    Attributes
    ----------
    softness
        1 / k_s of each pair, shape (n_pairs,), scaled, positive.
    """

    softness: Array = field()

    def opening(self, displacement: Array, force: Array) -> Array:
        """Give the distance of the two ends, the spring's own compression added."""
        found = super().opening(displacement, force)
        return np.asarray(found + self.softness[:, None] * force[self.component.above])

    def rule(self, friction: TangentialRule, k: Array) -> Rule:
        """Prepare the law for one k; it tells friction what presses."""
        return SpringRule(self, friction, k)


class SpringRule(ContactRule):
    """Contact with a spring beside that of the search direction."""

    def __init__(self, law: SlackSpring, friction: TangentialRule, k: Array) -> None:
        super().__init__(law, friction, k)
        soft = self.springs.soft
        self._share = soft / (soft + law.softness[:, None])

    def held(self, jump: Array) -> Array:
        """Give the jump that the spring allows, (n_pairs, n_instants)."""
        return np.asarray(jump + self._share * (super().held(jump) - jump))
