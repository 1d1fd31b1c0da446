"""Friction in the local stage, along E+ (paper, problem 2.1; solver/README.md, 2).

With z of the jump and the compliances 1/k of both sides added, both components are scalar: contact
presses where the bodies would overlap, friction is the play operator.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array, Indices
from solver.laws.interface import Component, Region
from solver.laws.play import Play


class Springs:
    """The search directions of one component: a spring 1/k on either side, in series.

    Attributes
    ----------
    soft
        Both added, shape (n_pairs, 1), scaled.
    share_below
        Share of the side below in them; None on a rigid support.
    """

    def __init__(self, component: Component, region: Region) -> None:
        self._above = region.of(component.above)
        self._below: slice | Indices | None = None
        self.soft = 1.0 / region.k[component.above, None]
        self.share_below: Array | None = None
        if component.below is not None:
            self._below = region.of(component.below)
            soft_below = 1.0 / region.k[component.below, None]
            self.soft = self.soft + soft_below
            self.share_below = soft_below / self.soft

    def jump(self, incoming: Array) -> Array:
        """Give z of the jump."""
        above: Array = incoming[self._above]
        return above if self._below is None else above - incoming[self._below]

    def close(self, incoming: Array, jump: Array, held: Array, displacement: Array) -> None:
        """Write W^ of both sides, with which the jump is `held` instead of `jump`."""
        if self.share_below is None:
            displacement[self._above] = held
            return
        moved = held - jump
        under = self.share_below * moved
        displacement[self._below] = incoming[self._below] - under
        displacement[self._above] = incoming[self._above] + (moved - under)


class FrictionRule:
    """The tangential component.

    Attributes
    ----------
    springs
        Its search directions.
    reach, grows
        How far the jump may stay behind z, shape (n_pairs, 1), and by how much more per pressing
        force.

    Parameters
    ----------
    tangent, bound, friction
        As of `Friction`.
    region
        Where.
    """

    def __init__(self, tangent: Component, bound: Array, friction: Array, region: Region) -> None:
        self.springs = Springs(tangent, region)
        self.reach = bound[:, None] * self.springs.soft
        self.grows = friction[:, None] * self.springs.soft
        self._play = Play(len(bound), len(region.instants))

    def __call__(
        self, incoming: Array, displacement: Array, some: slice, pressing: Array | None = None
    ) -> None:
        """Let the jump follow, within reach; `pressing` is N of the pairs where it varies."""
        jump = self.springs.jump(incoming)
        reach = self.reach if pressing is None else self.reach + self.grows * pressing
        self.springs.close(incoming, jump, self.held(jump, reach), displacement)

    def held(self, jump: Array, reach: Array) -> Array:
        """Give the jump that the law allows, (n_pairs, n_instants); the next call overwrites it."""
        return self._play(jump, reach)


class ContactRule:
    """The normal component, and friction after it.

    Parameters
    ----------
    normal, gap
        As of `Friction`.
    friction
        The rule of the tangential component.
    region
        Where.
    """

    def __init__(
        self, normal: Component, gap: Array, friction: FrictionRule, region: Region
    ) -> None:
        self._springs = Springs(normal, region)
        self._closed = -gap[:, None]
        self._friction = friction

    def __call__(self, incoming: Array, displacement: Array, some: slice) -> None:
        """Press where the sides would overlap."""
        jump = self._springs.jump(incoming)
        held = self.held(jump)
        self._springs.close(incoming, jump, held, displacement)
        self._friction(incoming, displacement, some, (held - jump) / self._springs.soft)

    def held(self, jump: Array) -> Array:
        """Give the jump that the law allows, (n_pairs, n_instants)."""
        return np.asarray(np.maximum(jump, self._closed))
