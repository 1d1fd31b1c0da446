"""The search directions of one component of a jump (solver/README.md, 2)."""

from __future__ import annotations

from solver.arrays import Array, Indices, as_slice
from solver.laws.interface import Component


class Springs:
    """The search directions of one component: a spring 1/k on either side, in series.

    Attributes
    ----------
    soft
        Both added, shape (n_pairs, 1), scaled.
    """

    def __init__(self, component: Component, k: Array) -> None:
        self._above = as_slice(component.above)
        self._below: slice | Indices | None = None
        self.soft = 1.0 / k[component.above, None]
        self._share_below: Array | None = None
        if component.below is not None:
            self._below = as_slice(component.below)
            soft_below = 1.0 / k[component.below, None]
            self.soft = self.soft + soft_below
            self._share_below = soft_below / self.soft

    def jump(self, incoming: Array) -> Array:
        """Z of the jump, shape (n_pairs, n_instants)."""
        above: Array = incoming[self._above]
        return above if self._below is None else above - incoming[self._below]

    def close(self, incoming: Array, jump: Array, held: Array, displacement: Array) -> None:
        """Write W^ of both sides, with which the jump is `held` instead of `jump`."""
        if self._share_below is None:
            displacement[self._above] = held
            return
        moved = held - jump
        under = self._share_below * moved
        displacement[self._below] = incoming[self._below] - under
        displacement[self._above] = incoming[self._above] + (moved - under)
