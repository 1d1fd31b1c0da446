"""One LATIN iteration: the local stage and the linear stage in turn (paper, Fig. 1)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.acceleration.mixing import Mixing
from solver.latin.iterate import Checkpoint
from solver.latin.linear.stage import LinearStage
from solver.latin.local.stage import LocalStage

State = list[Any]
"""What a linear stage holds, group by group."""


@dataclass(frozen=True, eq=False)
class Parts:
    """What the method is plugged together from, for one search direction.

    Attributes
    ----------
    k
        Search direction of the rows, shape (n_rows,), scaled, read-only.
    local
        The laws of all interfaces.
    linear
        Elasticity, in full or on separated bases, with the coarse problem if there is one.
    acceleration
        What mixes states, or None.
    relaxation
        Share of the new state, the rest being the old one.
    """

    k: Array
    local: LocalStage
    linear: LinearStage[Any]
    acceleration: Mixing | None
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

    def local_stage(self) -> None:
        """Obey the laws along E+ (paper, problem 2.1)."""
        self.parts.linear.read(self.parts.local(self.incoming))

    def linear_stage(self, *, mixes: bool = True) -> None:
        """Solve elasticity along E- (paper, problem 2.2), relax, accelerate unless told not to."""
        parts, state, mix = self.parts, self.state, self.parts.acceleration
        if mix is not None:
            mix.start(state)
        parts.linear.advance(state, parts.relaxation)
        if mix is not None and mixes:
            mix(state)
        elif mix is not None:
            mix.observe(state)
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
