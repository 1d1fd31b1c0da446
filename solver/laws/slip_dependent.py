"""Friction that hardens or softens with accumulated slip (solver/README.md, 14).

Surfaces run in, or polish each other: the bound is that of Coulomb's law times a factor that goes
from 1 to its last value in proportion to the slip s that has gone by, whichever way, until s
reaches the slip length. Time steps are backward Euler in s as in all else.
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
class SlipDependent(FrictionLaw):
    """Friction that changes as it slips.

    Attributes
    ----------
    friction_ratio
        Last coefficient of friction over the first; above 1 it hardens, below it softens.
    slip_length
        Accumulated slip at which it is reached, m; positive.

    Raises
    ------
    RefusedError
        For a negative ratio, or a slip length that is not above zero.
    """

    friction_ratio: float
    slip_length: float

    words = "its bound grows or falls with the slip that has gone by, as when surfaces run in."

    def __post_init__(self) -> None:
        check_range(self, "friction_ratio", 0.0, np.inf)
        check_range(self, "slip_length", 0.0, np.inf, above=True)

    def on(self, sliders: Sliders, weights: Array, length: float) -> Tangential:
        """Give the law at pairs, as `FrictionLaw.on`."""
        every = np.ones(len(weights))
        return SlipDependentSliders(
            component=sliders.component,
            bound=sliders.bound,
            friction=sliders.friction,
            ratio=self.friction_ratio * every,
            slip_length=self.slip_length / length * every,
        )


@dataclass(frozen=True, kw_only=True)
class SlipDependentSliders(Sliders):
    """Pairs whose bound changes with accumulated slip; attributes as of `Tangential`."""

    ratio: Array = field()
    slip_length: Array = field()

    of_pairs: ClassVar[tuple[str, ...]] = (*Sliders.of_pairs, "ratio", "slip_length")

    def factor(self, gone: Array) -> Array:
        """Give the factor on the bound after slip, of shape (n_pairs, ...)."""
        shape = -1, *[1] * (gone.ndim - 1)
        share = np.minimum(gone / self.slip_length.reshape(shape), 1.0)
        return np.asarray(1.0 + (self.ratio.reshape(shape) - 1.0) * share)

    def allowed(self, pressing: Array | None, slip: Array) -> Array:
        """Give the largest friction force, as `Tangential.allowed`."""
        gone = np.cumsum(np.abs(slip), axis=1)
        return np.asarray(super().allowed(pressing, slip) * self.factor(gone))

    @property
    def highest(self) -> Array:
        """Largest value that slip may give the bound, of its shape."""
        return np.asarray(self.bound * np.maximum(self.ratio, 1.0)[:, None])

    def rule(self, k: Array, n_instants: int) -> TangentialRule:
        """Prepare the law for one k and so many instants."""
        return SlipDependentRule(self, k, n_instants)


class SlipDependentRule(SliderRule):
    """The play operator whose reach follows the slip."""

    def __init__(self, law: SlipDependentSliders, k: Array, n_instants: int) -> None:
        super().__init__(law, k, n_instants)
        self._law = law

    def held(self, jump: Array, reach: Array) -> Array:
        """Give the jump that the law allows, (n_pairs, n_instants)."""
        found = np.empty_like(jump)
        position, gone = np.zeros((2, len(jump)))
        for after, target, own in zip(
            found.T, jump.T, np.broadcast_to(reach, jump.shape).T, strict=True
        ):
            away = target - position
            slip = self._slip(np.abs(away), own, gone)
            position = position + np.sign(away) * slip
            gone = gone + slip
            after[:] = position
        return found

    def _slip(self, distance: Array, reach: Array, gone: Array) -> Array:
        """Solve a + reach factor(gone + a) = distance for the slip a >= 0 of one instant.

        The left side is linear in a on either side of the slip length. Where it falls with a, as
        friction softens faster than the search direction unloads, and the distance is within reach,
        there are three solutions: the point sticks, which is the one of them that it is at already.
        """
        law = self._law
        missing = distance - reach * law.factor(gone)
        rises = 1.0 + reach * (law.ratio - 1.0) / law.slip_length
        early = np.divide(missing, rises, out=np.full_like(missing, np.inf), where=rises > 0.0)
        late = distance - reach * law.ratio
        slip = np.where(gone + early < law.slip_length, early, late)
        return np.asarray(np.where(missing > 0.0, slip, 0.0))
