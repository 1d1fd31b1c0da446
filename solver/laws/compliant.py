"""Compliant friction: a spring in series with the slider, Jenkins' element (solver/README.md, 8).

Asperities, or the part of a joint that no mesh shows, give way before they slip. The slider stands
at p = w + f / k_t, where w is the tangential jump and f the friction force on the body above; it
obeys Coulomb's law. So along the search direction it is again the play operator, whose reach is
longer by the bound over k_t. An infinite k_t is Coulomb's friction.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from solver.arrays import Array
from solver.laws.friction_law import FrictionLaw
from solver.laws.sliders import SliderRule, Sliders
from solver.laws.tangential import Tangential, TangentialRule
from solver.refusal import check_range


@dataclass(frozen=True)
class Compliant(FrictionLaw):
    """Friction that gives way before it slips.

    Attributes
    ----------
    contact_stiffness
        k_t per length or area, over ES / L^2 of a rod or E / L of a body; positive.

    Raises
    ------
    RefusedError
        For a stiffness that is not above zero.
    """

    contact_stiffness: float

    words = (
        "it gives way like a spring before it slips (Jenkins' element), as in joints and fretting."
    )

    def __post_init__(self) -> None:
        check_range(self, "contact_stiffness", 0.0, np.inf, above=True)

    def on(self, sliders: Sliders, weights: Array, length: float) -> Tangential:
        """Give the law at pairs, as `FrictionLaw.on`."""
        return CompliantSliders(
            component=sliders.component,
            bound=sliders.bound,
            friction=sliders.friction,
            softness=length / (self.contact_stiffness * weights),
        )


@dataclass(frozen=True, kw_only=True)
class CompliantSliders(Sliders):
    """Pairs that give way before they slip.

    Attributes
    ----------
    softness
        1 / k_t of each pair, shape (n_pairs,), scaled, positive.
    """

    softness: Array = field()

    of_pairs: ClassVar[tuple[str, ...]] = (*Sliders.of_pairs, "softness")

    @property
    def divided_by(self) -> tuple[Array, ...]:
        """The stiffness."""
        return (1.0 / self.softness,)

    def slider(self, displacement: Array, force: Array | None) -> Array:
        """Give where the slider of every pair stands, as `Tangential.slider`."""
        found = self.component.jump(displacement)
        if force is None:
            return found
        return np.asarray(found + self.softness[:, None] * force[self.component.above])

    def rule(self, k: Array, n_instants: int) -> TangentialRule:
        """Prepare the law for one k and so many instants."""
        return CompliantRule(self, k, n_instants)


class CompliantRule(SliderRule):
    """Friction with a spring beside that of the search direction."""

    def __init__(self, law: CompliantSliders, k: Array, n_instants: int) -> None:
        super().__init__(law, k, n_instants)
        longer = 1.0 + law.softness[:, None] / self.springs.soft
        self.reach, self.grows = longer * self.reach, longer * self.grows
        self._share = 1.0 / longer

    def held(self, jump: Array, reach: Array) -> Array:
        """Give the jump that slider and spring allow, (n_pairs, n_instants)."""
        return np.asarray(jump + self._share * (super().held(jump, reach) - jump))
