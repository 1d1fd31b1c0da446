"""Compliant friction: a spring in series with the slider, Jenkins' element (solver/README.md, 8).

Asperities, or the part of a joint that no mesh shows, give way before they slip. The slider stands
at p = w + f / k_t, where w is the tangential jump and f the friction force on the body above; it
obeys Coulomb's law. So along the search direction it is again the play operator, whose reach is
longer by the bound over k_t. An infinite k_t is Coulomb's friction.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any, ClassVar

import numpy as np

from solver.arrays import Array
from solver.laws.friction import Friction
from solver.laws.interface import Region
from solver.laws.obeying import FrictionRule


@dataclass(frozen=True)
class CompliantFriction(Friction):
    """An interface whose pairs give way before they slip.

    Attributes
    ----------
    softness
        1 / k_t of each pair, shape (n_pairs,), scaled, positive.
    """

    softness: Array = field(default_factory=lambda: np.zeros(0))

    of_pairs: ClassVar[tuple[str, ...]] = (*Friction.of_pairs, "softness")

    @classmethod
    def of(cls, law: Friction, stiffness: float, length: float) -> CompliantFriction:
        """Make a law compliant.

        Parameters
        ----------
        law
            Any friction.
        stiffness
            k_t per length or area, over ES / L^2 of a rod or E / L of a body; positive.
        length
            L, m: the unit of lengths, that of forces being ES, or E L per thickness.
        """
        values: dict[str, Any] = {one.name: getattr(law, one.name) for one in fields(law)}
        return cls(**values, softness=length / (stiffness * law.weights))

    @property
    def compliance(self) -> Array:
        """Tangential displacement before slip, per friction force, of every point, scaled."""
        return np.asarray(1.0 / self.by_point(1.0 / self.softness))

    @property
    def shares(self) -> Array:
        """Share of each pair in the force of its point: of its stiffness."""
        stiffness = 1.0 / self.softness
        return np.asarray(stiffness / self.by_point(stiffness)[self.points])

    def slider(self, displacement: Array, force: Array | None) -> Array:
        """Give where the slider of every pair stands, as `Friction.slider`."""
        found = self.tangent.jump(displacement)
        if force is None:
            return found
        return np.asarray(found + self.softness[:, None] * force[self.tangent.above])

    def friction_rule(self, region: Region) -> FrictionRule:
        """Prepare the tangential part of the law for a region."""
        return CompliantRule(self, region)


class CompliantRule(FrictionRule):
    """Friction with a spring beside that of the search direction."""

    def __init__(self, law: CompliantFriction, region: Region) -> None:
        super().__init__(law.tangent, law.bound, law.friction, region)
        longer = 1.0 + law.softness[:, None] / self.springs.soft
        self.reach, self.grows = longer * self.reach, longer * self.grows
        self._share = 1.0 / longer

    def held(self, jump: Array, reach: Array) -> Array:
        """Give the jump that slider and spring allow, (n_pairs, n_instants)."""
        return np.asarray(jump + self._share * (super().held(jump, reach) - jump))
