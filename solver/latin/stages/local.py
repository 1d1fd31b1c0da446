"""The local stage: all interface laws at all points and instants (paper, problem 2.1)."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array, space_time
from solver.discrete.problem import Problem
from solver.latin.stages.blocks import ALL, Blocks
from solver.latin.stages.sliding_body import slide_of


class LocalStage:
    """Interface laws along the search direction E+, ready for one problem and one k, (n_rows,).

    It reads z = W - F/k of the linear stage alone, and its result is read as W^ + F^/k
    = 2 W^ - z (solver/README.md, 2). Laws of one kind are applied together, and what is
    local in time block by block of instants.

    A call leaves W^ as `displacement`, a new field (n_rows, n_instants), and as
    `incoming` the z with which it obeyed: as read, but for the shift of a body that
    slides, along a `motion` of its rows, (n_rows,), or None.
    """

    def __init__(self, problem: Problem, k: Array, blocks: Blocks) -> None:
        shape = problem.n_rows, problem.n_instants
        self._blocks = blocks
        self.displacement = self.incoming = space_time(*shape)
        self._outgoing = space_time(*shape)
        self._slide = slide_of(problem, k)
        if self._slide is None:
            self.motion = None
        else:
            self.motion = self._slide.motion
        laws = problem.laws
        n_instants = problem.n_instants
        self._remembering = [law.rule(k, n_instants) for law in laws if law.remembers]
        self._instant = [law.rule(k, n_instants) for law in laws if not law.remembers]

    def __call__(self, incoming: Array) -> Array:
        """W^ + F^/k that obey all laws, from z = W - F/k; the next call overwrites them."""
        if self._slide is not None:
            incoming = self._slide.balanced(incoming)
        self.incoming = incoming
        displacement = self.displacement = np.empty_like(self._outgoing)
        for rule in self._remembering:
            rule(incoming, displacement, ALL)
        self._blocks.each(lambda instants: self._at(incoming[:, instants], instants))
        return self._outgoing

    def _at(self, incoming: Array, instants: slice) -> None:
        """Obey the laws that are local in time, at some instants, and reflect."""
        displacement = self.displacement[:, instants]
        outgoing = self._outgoing[:, instants]
        for rule in self._instant:
            rule(incoming, displacement, instants)
        np.multiply(displacement, 2.0, out=outgoing)
        np.subtract(outgoing, incoming, out=outgoing)
