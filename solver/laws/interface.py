"""What interfaces of every law have: components, search directions, rules, gaps."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, Self, cast

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices, as_slice, in_rows
from solver.refusal import RefusedError

if TYPE_CHECKING:
    from solver.laws.contact import Contact


class Component(NamedTuple):
    """Rows of one component of the jump, (n_pairs,): of the body above, and of that below.

    Each is opposite its partner; there are none below on a rigid support.
    """

    above: Indices
    below: Indices | None = None

    def jump(self, field: Array) -> Array:
        """A row field above minus that below, shape (n_pairs, ...)."""
        above: Array = field[self.above]
        if self.below is None:
            return above
        return above - field[self.below]

    @property
    def sides(self) -> tuple[Indices, ...]:
        """Rows of both sides, or of the one there is."""
        if self.below is None:
            return (self.above,)
        return (self.above, self.below)


class Springs:
    """Search directions of a component, springs of both sides: 1/k in all `soft`, (n_pairs, 1)."""

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
        if self._below is None:
            return above
        return above - incoming[self._below]

    def close(
        self, incoming: Array, jump: Array, held: Array, displacement: Array
    ) -> None:
        """Write W^ of both sides, with which the jump is `held` instead of `jump`."""
        if self._share_below is None:
            displacement[self._above] = held
            return
        moved = held - jump
        under = self._share_below * moved
        displacement[self._below] = incoming[self._below] - under
        displacement[self._above] = incoming[self._above] + (moved - under)


class MacroPart(NamedTuple):
    """Rows (n,) of both sides whose macro forces are in equilibrium (paper, eq. 1).

    With their basis, (n, n_macro), and the macro force from outside, (n_macro,
    n_instants); None is zero.
    """

    rows: Indices
    basis: Array | sparse.coo_array
    load: Array | None = None


Rule = Callable[[Array, Array, slice], None]
"""A law that is ready for one k, in the local stage (paper, problem 2.1): from z = W -
F/k of all rows, (n_rows, n), it writes W^ of the interface's rows alone into the
second, of the same shape. The last says which n instants these are; all of them where
the law remembers."""


class Gaps(NamedTuple):
    """What is missing to continuity and to balance: sums of squares, scaled."""

    displacement: float = 0.0
    force: float = 0.0


class Given(NamedTuple):
    """Values that are given at rows, (n_rows,): shape (n_rows, n_instants), scaled."""

    rows: Indices
    values: Array


class Glued(NamedTuple):
    """Rows that move as one, opposite each other, (n_pairs,) each."""

    first: Indices
    second: Indices


@dataclass(frozen=True, kw_only=True)
class IncrementalForm:
    """Form in which a law enters the incremental problem: all that its solvers read of it.

    With nothing given the interface is free.

    Attributes
    ----------
    force, displacement
        What is prescribed at rows.
    glued
        Rows that share their degrees of freedom.
    contact
        The law itself, where it is one of contact.
    """

    force: Given | None = None
    displacement: Given | None = None
    glued: Glued | None = None
    contact: Contact | None = None


class Interface(ABC):
    """An interface of substructures with each other or with the outside.

    A law of one's own needs `rows` and a `rule`. LATIN solves it; a reference and a
    certificate it has where its class says its `incremental_form`. A class inherits
    nothing of `OF_ONE_LAW` from another law unless it says that form, as its local
    stage may be a different one.

    Attributes
    ----------
    rows
        All its rows.
    remembers
        Whether its law ties the instants to each other.
    """

    rows: Indices
    remembers = False

    def __init_subclass__(cls, **options: Any) -> None:
        """Begin anew where a class does not say that what is known of its base holds for it."""
        super().__init_subclass__(**options)
        if "incremental_form" in vars(cls):
            return
        for name in OF_ONE_LAW:
            if name not in vars(cls):
                setattr(cls, name, vars(Interface)[name])

    def incremental_form(self) -> IncrementalForm | None:
        """The form in which the law enters the incremental problem; None where it has none."""
        return None

    @property
    def n_instants(self) -> int | None:
        """Number of instants that its values are for; None where they are for any."""
        return None

    @classmethod
    def together(cls, laws: Sequence[Self]) -> list[Self]:
        """Join interfaces of one law that may be treated as one: points know none."""
        return list(laws)

    @abstractmethod
    def rule(self, k: Array, n_instants: int) -> Rule:
        """Prepare the law for one k and so many instants."""

    def gaps(self, displacement: Array, force: Array, noise: float, k: Array) -> Gaps:
        """How much W and F of all rows, (n_rows, n_instants), miss continuity and balance by.

        What is less than `noise` is rounding. By the local stage itself, unless a law
        knows better: from W - F/k it finds W and F again if they obey the law, whatever
        k of the rows, (n_rows,), it is.
        """
        return gaps_of_rule(self, displacement, force, noise, k)

    def during(self, instants: slice) -> Self:
        """Law of some instants alone; where bodies stand before them is another matter.

        Raises
        ------
        RefusedError
            If the law does not say what it is then.
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


OF_ONE_LAW = "incremental_form", "together", "gaps", "during", "macro_parts"
"""Methods that belong to one local stage, and to no other that a subclass may have."""


def gaps_of_rule(
    law: Interface, displacement: Array, force: Array, noise: float, k: Array
) -> Gaps:
    """Gaps of W and F to the law by its local stage along k; parameters as `Interface.gaps`."""
    incoming = displacement - force / k[:, None]
    local = displacement.copy(order="F")
    law.rule(k, displacement.shape[1])(incoming, local, slice(None))
    stiffness = k[law.rows, None]
    # Rounding of W and of F both move the place from which the local stage starts.
    apart = beyond(
        local[law.rows] - displacement[law.rows], noise * (1.0 + 1.0 / stiffness)
    )
    return Gaps(displacement=squared(apart), force=squared(stiffness * apart))


def joined(parts: Sequence[Any]) -> Any:
    """Laws of one kind as one: arrays of pairs one after the other, all else as in the first."""
    first = parts[0]
    kind = cast(Any, type(parts[0]))
    if isinstance(first, np.ndarray):
        return in_rows(parts)
    if isinstance(first, Component):
        return Component(*map(joined, zip(*parts, strict=True)))
    if not is_dataclass(first):
        return first
    names = [field.name for field in fields(first)]
    return kind(**{n: joined([getattr(part, n) for part in parts]) for n in names})


def beyond(field: Array, noise: float | Array) -> Array:
    """A field in which what may be rounding is zero."""
    return np.where(np.abs(field) > noise, field, 0.0)


def squared(field: Array) -> float:
    """Sum of the squares of a field."""
    numbers = field.ravel(order="K")  # without a copy, however it lies in memory
    return float(np.dot(numbers, numbers))
