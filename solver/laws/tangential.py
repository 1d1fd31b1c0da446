"""What is said along an interface: its tangential law, at the pairs of a mesh and as a choice.

A structure chooses a `FrictionLaw`, a value of a few numbers; on a mesh that becomes a `Tangential`
with an array for all that differs from pair to pair. In the local stage the jump along E+ is scalar
(paper, problem 2.1; solver/README.md, 2).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, ClassVar, Protocol, Self

import numpy as np

from solver.arrays import Array, in_rows
from solver.laws.interface import Component
from solver.refusal import RefusedError


class TangentialRule(Protocol):
    """A tangential law that is ready for one k."""

    def __call__(
        self, incoming: Array, displacement: Array, some: slice, pressing: Array | None = None, /
    ) -> None:
        """Write W^ of its rows, as `Rule`; `pressing` is N of the pairs where it varies."""


class Tangential(ABC):
    """A tangential law at the pairs of an interface.

    Attributes
    ----------
    component
        Rows of the pairs.
    bound
        r, the friction force of each pair that needs no pressing one, non-negative: shape
        (n_pairs, n_instants), or (n_pairs, 1) where it stays the same.
    friction
        Coefficient mu of each pair, shape (n_pairs,), non-negative; 0 where the pressure is known.
    softness
        Displacement before slip per friction force, (n_pairs,), scaled; None if there is none.
    ratio, slip_length
        Factor on the bound, in the end, and the accumulated slip, scaled, on the way to which it
        grows from 1 in proportion; (n_pairs,) each, None where slip changes nothing.
    start
        Where every slider stands before the first instant, (n_pairs,), scaled; None is zero.
    """

    component: Component
    bound: Array
    friction: Array
    softness: Array | None = None
    ratio: Array | None = None
    slip_length: Array | None = None
    start: Array | None = None

    of_pairs: ClassVar[tuple[str, ...]] = ()
    """Attributes of its dataclass that have a row a pair."""

    @abstractmethod
    def rule(self, k: Array, n_instants: int) -> TangentialRule:
        """Prepare the law for one k and so many instants."""

    @property
    def divided_by(self) -> tuple[Array, ...]:
        """What the pairs of a point divide their force by, if it is positive; (n_pairs,) each."""
        return (self.most,)

    def slider(self, displacement: Array, force: Array | None) -> Array:
        """Give the slip of every pair up to every instant, shape (n_pairs, n_instants), scaled.

        Parameters
        ----------
        displacement, force
            W and F of all rows, shape (n_rows, n_instants); F may be None where nobody reads it.
        """
        return self.component.jump(displacement)

    def begun(self, start: Array) -> Tangential:
        """Give the law whose sliders stand elsewhere before the first instant.

        Parameters
        ----------
        start
            Where, as `slider` gives it, shape (n_pairs,), scaled.

        Raises
        ------
        RefusedError
            If it remembers more than that.
        """
        if self.slip_length is not None:
            raise RefusedError(
                "friction_law",
                "slip-dependent",
                "a law that remembers nothing but where its sliders stand",
                "solve the whole interval at once, or take Coulomb's friction",
            )
        return self._with(start=start)

    def allowed(self, pressing: Array | None, slip: Array) -> Array:
        """Give the largest friction force, shape (n_pairs, n_instants).

        Parameters
        ----------
        pressing
            Force that presses, same shape; None where the pressure is known.
        slip
            Increments, same shape.
        """
        bound = self.bound
        if pressing is not None:
            bound = bound + self.friction[:, None] * np.maximum(pressing, 0.0)
        return np.broadcast_to(bound, slip.shape)

    @property
    def most(self) -> Array:
        """Largest value that the bound r ever has, shape (n_pairs,)."""
        return np.asarray(self.highest.max(axis=1))

    @property
    def highest(self) -> Array:
        """Largest value that slip may give the bound, of its shape."""
        return self.bound

    @property
    def softens(self) -> bool:
        """Whether the bound falls with slip anywhere."""
        return self.ratio is not None and bool(np.any(self.ratio < 1.0))

    @property
    def steepest_fall(self) -> Array:
        """Largest force by which a known bound falls per slip, shape (n_pairs,)."""
        if self.ratio is None or self.slip_length is None:
            return np.zeros(len(self.bound))
        return np.asarray(self.most * np.maximum(1.0 - self.ratio, 0.0) / self.slip_length)

    def during(self, some: slice) -> Self:
        """Give the law of some instants alone."""
        return self if self.bound.shape[1] == 1 else self._with(bound=self.bound[:, some])

    @classmethod
    def joined(cls, laws: Sequence[Self]) -> Self:
        """Put the pairs of laws one after the other, of all on supports, or of none."""
        values: dict[str, Any] = {
            name: in_rows([getattr(law, name) for law in laws])
            for name in cls.of_pairs
            if getattr(laws[0], name) is not None
        }
        below = [law.component.below for law in laws if law.component.below is not None]
        component = Component(
            np.concatenate([law.component.above for law in laws]),
            np.concatenate(below) if below else None,
        )
        return laws[0]._with(component=component, **values)

    def _with(self, **changes: Any) -> Self:
        return replace(self, **changes)  # type: ignore[type-var]  # all of its kind are dataclasses
