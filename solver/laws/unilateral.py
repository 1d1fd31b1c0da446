"""Unilateral contact: the sides press where they would overlap, and open where they would pull.

A compliance 1 / k_n may be in series: of the opening g and the pressing force N, g + N / k_n >= 0,
N >= 0, and one of them is zero; so along the search direction both springs share what is missing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.laws.friction import FrictionRule
from solver.laws.interface import Component, Springs


@dataclass(frozen=True, kw_only=True)
class Unilateral:
    """The normal law at the pairs of an interface.

    Attributes
    ----------
    component
        Rows of the pairs.
    gap
        Opening between the undeformed bodies, shape (n_pairs,), scaled; negative where they
        overlap.
    softness
        Compression per pressing force of each pair, shape (n_pairs,), scaled; None if there is
        none.
    """

    component: Component
    gap: Array
    softness: Array | None = None

    def opening(self, displacement: Array, force: Array) -> Array:
        """Distance of the two sides, the spring's compression added, from W and F of all rows.

        Returns
        -------
        Shape (n_pairs, n_instants), scaled.
        """
        opening = self.component.jump(displacement) + self.gap[:, None]
        if self.softness is not None:
            opening = opening + self.softness[:, None] * force[self.component.above]
        return np.asarray(opening)

    @classmethod
    def concatenated(cls, laws: Sequence[Unilateral]) -> Unilateral:
        """Laws put one after the other, all on supports, or none; all with a spring, or none."""
        softness = [law.softness for law in laws if law.softness is not None]
        return cls(
            component=Component.concatenated([law.component for law in laws]),
            gap=np.concatenate([law.gap for law in laws]),
            softness=np.concatenate(softness) if softness else None,
        )


class ContactRule:
    """The normal component, and friction after it: only contact says what friction can carry."""

    def __init__(self, law: Unilateral, friction: FrictionRule, k: Array, *, bonds: bool) -> None:
        self._springs = Springs(law.component, k)
        self._closed = -law.gap[:, None]
        self._friction, self._bonds = friction, bonds
        soft = self._springs.soft
        self._share = None if law.softness is None else soft / (soft + law.softness[:, None])

    def __call__(self, incoming: Array, displacement: Array, instants: slice) -> None:
        """Press where the sides would overlap; write W^ of all rows, as `Rule`."""
        jump = self._springs.jump(incoming)
        held = np.maximum(jump, self._closed)
        opening = held - self._closed if self._bonds else None
        if self._share is not None:
            held = jump + self._share * (held - jump)
        self._springs.close(incoming, jump, held, displacement)
        pressing = (held - jump) / self._springs.soft
        self._friction(incoming, displacement, instants, pressing, opening)
