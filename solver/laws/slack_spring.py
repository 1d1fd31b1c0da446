"""A spring that is slack at first: a stop that gives way, without friction.

It is unilateral contact with a compliance in series, as `solver.laws.compliant` has it along the
interface: of the opening g and the pressing force N, g + N / k_s >= 0, N >= 0, and one of them is
zero. So along the search direction the two springs share what is missing.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from solver.arrays import Array
from solver.laws.friction import Friction
from solver.laws.interface import Region
from solver.laws.obeying import ContactRule, FrictionRule
from solver.laws.rules import Rules


@dataclass(frozen=True)
class SlackSpring(Friction):
    """An interface that pushes in proportion once its gap is closed.

    Attributes
    ----------
    softness
        1 / k_s of each pair, shape (n_pairs,), scaled, positive.
    """

    softness: Array = field(default_factory=lambda: np.zeros(0))

    def opening(self, displacement: Array, force: Array) -> Array:
        """Give the distance of the two ends, the spring's own compression added."""
        found = super().opening(displacement, force)
        assert self.normal is not None
        return np.asarray(found + self.softness[:, None] * force[self.normal.above])

    def contact_rule(self, friction: FrictionRule, region: Region) -> ContactRule:
        """Prepare the normal part of the law for a region."""
        return SpringRule(self, friction, region)

    def rules(self, first: int) -> list[Rules]:
        """Say what the jumps of the points obey, each with the spring in series.

        Along the interface there is no force that it could change.
        """
        softness = 1.0 / self.by_point(1.0 / self.softness)
        return [replace(one, compliance=softness) for one in super().rules(first)]


class SpringRule(ContactRule):
    """Contact with a spring beside that of the search direction."""

    def __init__(self, law: SlackSpring, friction: FrictionRule, region: Region) -> None:
        assert law.normal is not None
        super().__init__(law.normal, law.gap, friction, region)
        soft = self._springs.soft
        self._share = soft / (soft + law.softness[:, None])

    def held(self, jump: Array) -> Array:
        """Give the jump that the spring allows, (n_pairs, n_instants)."""
        return np.asarray(jump + self._share * (super().held(jump) - jump))
