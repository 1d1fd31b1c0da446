"""Unilateral contact: the sides press where they would overlap, and open where they would pull."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.laws.interface import Component, Rule
from solver.laws.springs import Springs
from solver.laws.tangential import TangentialRule


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
        """Give the distance of the two sides, shape (n_pairs, n_instants), from W and F."""
        return np.asarray(self.component.jump(displacement) + self.gap[:, None])

    def rule(self, friction: TangentialRule, k: Array) -> Rule:
        """Prepare the law for one k; it tells friction what presses."""
        return ContactRule(self, friction, k)


class ContactRule:
    """The normal component, and friction after it: only contact says what friction can carry."""

    def __init__(self, law: Unilateral, friction: TangentialRule, k: Array) -> None:
        self.springs = Springs(law.component, k)
        self._closed = -law.gap[:, None]
        self._friction = friction

    def __call__(self, incoming: Array, displacement: Array, some: slice) -> None:
        """Press where the sides would overlap."""
        jump = self.springs.jump(incoming)
        held = self.held(jump)
        self.springs.close(incoming, jump, held, displacement)
        self._friction(incoming, displacement, some, (held - jump) / self.springs.soft)

    def held(self, jump: Array) -> Array:
        """Give the jump that the law allows, (n_pairs, n_instants)."""
        return np.asarray(np.maximum(jump, self._closed))
