"""Base of interface laws: components, search directions, rules, gaps."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, NamedTuple, Self, cast

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices, as_slice, in_rows
from solver.refusal import RefusedError


class Component(NamedTuple):
    """Rows of one component of the jump, (n_pairs,) on each side.

    Each row of the body above is opposite one of the body below; a rigid support below
    has no rows (None).
    """

    above: Indices
    below: Indices | None = None

    def jump(self, field: Array) -> Array:
        """Jump of a field, (n_rows, ...): above minus below, shape (n_pairs, ...)."""
        above: Array = field[self.above]
        if self.below is None:
            return above
        return above - field[self.below]

    @property
    def sides(self) -> tuple[Indices, ...]:
        """Rows of both sides, or of the side above on a support, (n_pairs,) each."""
        if self.below is None:
            return (self.above,)
        return (self.above, self.below)


class Springs:
    """Search directions of a component: springs on both sides, in series.

    Their compliance together is `soft`, (n_pairs, 1), from k of all rows, (n_rows,).
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
        """Jump of z, shape (n_pairs, n_instants), scaled, from z of all rows."""
        above: Array = incoming[self._above]
        if self._below is None:
            return above
        return above - incoming[self._below]

    def close(
        self, incoming: Array, jump: Array, held: Array, displacement: Array
    ) -> None:
        """Write W^ of both sides such that the jump is `held` instead of `jump`.

        Fields of all rows are (n_rows, n_instants), jumps (n_pairs, n_instants),
        scaled.
        """
        if self._share_below is None:
            displacement[self._above] = held
            return
        # Both sides carry the same force, so each takes the share of its compliance.
        moved = held - jump
        under = self._share_below * moved
        displacement[self._below] = incoming[self._below] - under
        displacement[self._above] = incoming[self._above] + (moved - under)


class MacroPart(NamedTuple):
    """Macro forces in equilibrium on rows of both sides (paper, eq. 1).

    Attributes
    ----------
    rows, basis
        Rows, (n,), and their macro basis, (n, n_macro).
    load
        Macro force from outside, (n_macro, n_instants), scaled; None is zero.
    """

    rows: Indices
    basis: Array | sparse.coo_array
    load: Array | None = None


Rule = Callable[[Array, Array, slice], None]
"""Local stage of a law for one k (paper, problem 2.1). The first argument is z of all
rows, W - F/k, (n_rows, n); the rule writes W^ of the interface's rows into the second,
of the same shape. The third is the range of these n instants: all instants where the
law remembers."""


class Gaps(NamedTuple):
    """Violations of continuity and of balance: sums of squares, scaled."""

    displacement: float = 0.0
    force: float = 0.0


class PrescribedRows(NamedTuple):
    """Values prescribed at rows, (n_rows,): shape (n_rows, n_instants), scaled."""

    rows: Indices
    values: Array


class Glued(NamedTuple):
    """Pairs of opposite rows with equal displacement, (n_pairs,) each."""

    first: Indices
    second: Indices


@dataclass(frozen=True, kw_only=True)
class IncrementalForm:
    """Form in which a law enters the incremental problem.

    Without any of these the interface is free.

    Attributes
    ----------
    force, displacement
        Values prescribed at rows.
    glued
        Rows that share their degrees of freedom.
    contact
        The law itself, where it is one of contact.
    """

    force: PrescribedRows | None = None
    displacement: PrescribedRows | None = None
    glued: Glued | None = None
    contact: Interface | None = None


class Interface(ABC):
    """An interface of substructures with each other or with the outside.

    A user's law needs `rows` and a `rule`: then LATIN solves it. The problem has a
    reference and a certificate only where the class defines `incremental_form`. A class
    inherits the methods `OF_ONE_LAW` from another law only if it defines that form, as
    its local stage may be a different one.

    Attributes
    ----------
    rows
        All rows of the interface, (n,).
    remembers
        Whether its law ties the instants to each other.
    """

    rows: Indices
    remembers = False

    def __init_subclass__(cls, **options: Any) -> None:
        """Reset the methods `OF_ONE_LAW` in a subclass without an incremental form."""
        super().__init_subclass__(**options)
        # A class that says its incremental form knows what it inherits.
        if "incremental_form" in vars(cls):
            return
        for name in OF_ONE_LAW:
            if name not in vars(cls):
                setattr(cls, name, vars(Interface)[name])

    def incremental_form(self) -> IncrementalForm | None:
        """Form in which the law enters the incremental problem, or None."""
        return None

    @property
    def n_instants(self) -> int | None:
        """Number of instants of the law's values; None for constant values."""
        return None

    @classmethod
    def join(cls, laws: Sequence[Self]) -> list[Self]:
        """Join interfaces of one law to one, without macro bases, if possible."""
        return list(laws)

    @abstractmethod
    def rule(self, k: Array, n_instants: int) -> Rule:
        """Make the local stage for k of all rows, (n_rows,), scaled."""

    def gaps(self, displacement: Array, force: Array, noise: float, k: Array) -> Gaps:
        """Violations of continuity and balance by W and F, (n_rows, n_instants).

        Values up to `noise` are rounding. By default the local stage finds violations:
        from W - F/k it gives W and F again if they obey the law, for any k, (n_rows,).
        """
        # W - F/k is z, from which the local stage starts (paper, problem 2.1).
        incoming = displacement - force / k[:, None]
        local = displacement.copy(order="F")
        self.rule(k, displacement.shape[1])(incoming, local, slice(None))
        stiffness = k[self.rows, None]
        # Rounding of W and of F both move the z from which the local stage starts.
        rounding = noise * (1.0 + 1.0 / stiffness)
        apart = beyond(local[self.rows] - displacement[self.rows], rounding)
        return Gaps(displacement=squared(apart), force=squared(stiffness * apart))

    def during(self, instants: slice) -> Self:
        """The law restricted to a range of instants (initial sliders are not set).

        Raises
        ------
        RefusedError
            If the law does not define it.
        """
        raise RefusedError(
            f"{type(self).__name__}.during",
            "not defined",
            "laws that say what they are at some instants alone",
            "solve the whole interval at once, or define it",
        )

    def macro_parts(self) -> Iterator[MacroPart]:
        """Macro forces that are in equilibrium in the coarse problem."""
        return iter(())


OF_ONE_LAW = "incremental_form", "join", "gaps", "during", "macro_parts"
"""Methods that depend on the local stage, and may be wrong for that of a subclass."""


def joined(parts: Sequence[Any]) -> Any:
    """Concatenate laws of one kind, or their fields.

    Arrays, (n_pairs, ...), follow each other; other values are those of the first.
    """
    return _with_arrays(parts, in_rows)


def restricted(whole: Any, pairs: slice) -> Any:
    """A law, or a field of it, restricted to a range of pairs.

    Arrays, (n_pairs, ...), are cut; other values stay as they are.
    """
    return _with_arrays([whole], lambda arrays: arrays[0][pairs])


def _with_arrays(parts: Sequence[Any], of_arrays: Callable[[Any], Any]) -> Any:
    """A law whose arrays are a function of those of some laws of one kind.

    `parts` are laws, or values of one of their fields; values that are no arrays are
    those of the first.
    """
    first = parts[0]
    if isinstance(first, np.ndarray):
        return of_arrays(parts)
    if isinstance(first, Component):
        sides = [_with_arrays(side, of_arrays) for side in zip(*parts, strict=True)]
        return Component(*sides)
    if not is_dataclass(first):
        return first
    values = dict[str, Any]()
    for field in fields(first):
        of_parts = [getattr(part, field.name) for part in parts]
        values[field.name] = _with_arrays(of_parts, of_arrays)
    return cast(Any, type(first))(**values)


def beyond(field: Array, noise: float | Array) -> Array:
    """A field less its noise: values up to `noise` become zero, of the same shape."""
    return np.where(np.abs(field) > noise, field, 0.0)


def squared(field: Array) -> float:
    """Sum of the squares of a field of any shape."""
    numbers = field.ravel(order="K")  # without a copy, however it lies in memory
    return float(np.dot(numbers, numbers))
