"""One LATIN iteration: the local stage and the linear stage in turn (paper, Fig. 1)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.iterate import Checkpoint
from solver.latin.linear import LinearStage
from solver.latin.local import LocalStage
from solver.reduction.basis import ReferencePoints

State = list[Any]
"""What a linear stage holds, group by group."""


class LocalPart(Protocol):
    """Where a local stage obeys the laws.

    Attributes
    ----------
    stage
        The laws at all points and instants.
    """

    stage: LocalStage

    @property
    def references(self) -> ReferencePoints | None:
        """Reference points and instants, if any."""

    def obey(self, number: int, incoming: Array, state: State) -> float:
        """Obey the laws, and bring what they say to the linear stage.

        Parameters
        ----------
        number
            Of the iteration.
        incoming, state
            W - F/k of the linear stage, and its state.

        Returns
        -------
        The error of laws that are evaluated at a few points alone, as in `Iterate`.
        """

    def keep_up(self, number: int, state: State) -> None:
        """Follow the linear stage, which has found a new state."""

    def recall(self, start: Checkpoint, state: State) -> None:
        """Bring back what a checkpoint of the same run remembers, in its state."""


class Everywhere:
    """The laws at all points and instants."""

    references: ReferencePoints | None = None

    def __init__(self, stage: LocalStage, linear: LinearStage[Any]) -> None:
        self.stage, self._linear = stage, linear

    def obey(self, number: int, incoming: Array, state: State) -> float:
        """Obey the laws, as `LocalPart` says."""
        self._linear.read(self.stage(incoming))
        return 0.0

    def keep_up(self, number: int, state: State) -> None:
        """Nothing depends on the state."""

    def recall(self, start: Checkpoint, state: State) -> None:
        """Nothing is remembered."""


class Acceleration(Protocol):
    """What makes the next state of the last ones."""

    @property
    def memory(self) -> tuple[int, int, float] | None:
        """What it counts, as in `Checkpoint`; None if it remembers nothing."""

    @property
    def remembered(self) -> int:
        """States before the present one that shape the next."""

    def restore(self, memory: tuple[int, int, float]) -> None:
        """Count on from there."""

    def start(self, state: State) -> None:
        """Take in y, before the iteration that makes g(y) of it."""

    def observe(self, state: State) -> bool:
        """Take in g(y); tell whether to mix."""

    def __call__(self, state: State, /) -> None:
        """Replace g(y) by the mixture, in place."""


class Unaccelerated:
    """The plain iteration."""

    remembered = 0
    memory: tuple[int, int, float] | None = None

    def restore(self, memory: tuple[int, int, float]) -> None:
        """Nothing is counted."""

    def start(self, state: State) -> None:
        """Nothing is to be remembered."""

    def observe(self, state: State) -> bool:
        """Nothing is to be mixed."""
        return False

    def __call__(self, state: State) -> None:
        """Leave the state as it is."""


@dataclass(frozen=True, eq=False)
class Parts:
    """What the method is plugged together from, for one search direction.

    Attributes
    ----------
    k
        Search direction of the rows, shape (n_rows,), scaled, read-only.
    local
        Where the laws are obeyed.
    linear
        Elasticity, in full or on separated bases, with the coarse problem if there is one.
    acceleration
        What mixes states.
    relaxation
        Share of the new state, the rest being the old one.
    """

    k: Array
    local: LocalPart
    linear: LinearStage[Any]
    acceleration: Acceleration
    relaxation: float


class Cycle:
    """Both stages of some parts at work on one state.

    Attributes
    ----------
    parts
        As given.
    state
        Of the linear stage; changed in place.
    incoming
        W - F/k of the linear stage, shape (n_rows, n_instants); read-only, and new after every
        linear stage.
    """

    def __init__(self, problem: Problem, parts: Parts, start: Checkpoint | None) -> None:
        self._shape = problem.n_rows, problem.n_instants
        self.parts = parts
        self.put(start)

    def put(self, start: Checkpoint | None) -> None:
        """Go to the state of a checkpoint, or to that in which all is zero."""
        self.state: State = self.parts.linear.start(start)
        self.incoming = self._reflected()

    def local_stage(self, number: int = 0) -> float:
        """Obey the laws along E+ (paper, problem 2.1); give the error of reference points."""
        return self.parts.local.obey(number, self.incoming, self.state)

    def linear_stage(self, number: int = 0, *, mixes: bool = True) -> None:
        """Solve elasticity along E- (paper, problem 2.2), relax, accelerate unless told not to."""
        parts, state = self.parts, self.state
        parts.acceleration.start(state)
        parts.linear.advance(state, parts.relaxation)
        if mixes:
            parts.acceleration(state)
        else:
            parts.acceleration.observe(state)
        parts.local.keep_up(number, state)
        self.incoming = self._reflected()

    @property
    def outgoing(self) -> Array:
        """W + F/k of the linear stage, shape (n_rows, n_instants), read-only; new at every call."""
        return read_only(self.parts.linear.to_boundary(self.state))

    def _reflected(self) -> Array:
        return read_only(self.parts.linear.incoming(self.state, np.empty(self._shape, order="F")))


def read_only(field: Array) -> Array:
    """Forbid that anybody changes a field."""
    field.flags.writeable = False
    return field
