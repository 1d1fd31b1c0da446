"""Local stage: all interface laws at all points and instants (paper, problem 2.1)."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array, space_time
from solver.discrete.problem import Problem
from solver.latin.stages.blocks import ALL, Blocks
from solver.latin.stages.rigid_bodies import RigidBodies
from solver.latin.stages.sliding_body import slide_of


class LocalStage:
    """Interface laws along the search direction E+, ready for one problem and one k.

    The local stage reads z = W - F/k of the linear stage alone, and its result is W^ +
    F^/k = 2 W^ - z (MATHEMATICS.md, 2). Laws of one kind are applied together. Laws
    that are local in time are applied block by block of instants.

    Parameters
    ----------
    problem
        The problem to be solved.
    k
        Search direction of the rows, shape (n_rows,), scaled.
    blocks
        Blocks of instants.
    bodies
        Shifts of all bodies as rigid ones; None where these are not shifted.

    Attributes
    ----------
    displacement
        W^ of the last call, a new field of shape (n_rows, n_instants), scaled.
    incoming
        W^ - F^/k of the last call, same shape: z as read, plus the shift of bodies that
        move as a whole.
    motion
        Motion of the rows in a slide of one body, shape (n_rows,), whose residuals
        count for nothing; None without such a slide.
    """

    def __init__(
        self,
        problem: Problem,
        k: Array,
        blocks: Blocks,
        bodies: RigidBodies | None = None,
    ) -> None:
        shape = problem.n_rows, problem.n_instants
        self._blocks = blocks
        self.displacement = space_time(*shape)
        self.incoming = self.displacement
        self._outgoing = space_time(*shape)
        self._slide = bodies or slide_of(problem, k)
        self.motion = None
        if self._slide is not None:
            self.motion = self._slide.motion
        self._remembering = []
        self._instantaneous = []
        for law in problem.laws:
            rule = law.rule(k, problem.n_instants)
            if law.remembers:
                self._remembering.append(rule)
            else:
                self._instantaneous.append(rule)

    def __call__(self, incoming: Array) -> Array:
        """W^ + F^/k that obeys all laws, from z = W - F/k; the next call overwrites it.

        Both have shape (n_rows, n_instants), scaled.
        """
        if self._slide is not None:
            incoming = self._slide.balanced(incoming)
        self.incoming = incoming
        # A new field, as iterates keep that of their own iteration.
        displacement = np.empty_like(self._outgoing)
        self.displacement = displacement
        # Laws that remember walk through all instants, before these are divided in
        # blocks.
        for rule in self._remembering:
            rule(incoming, displacement, ALL)
        self._blocks.each(lambda instants: self._at(incoming[:, instants], instants))
        return self._outgoing

    def _at(self, incoming: Array, instants: slice) -> None:
        """Apply the laws that are local in time, and make W^ + F^/k, at some instants.

        `incoming` is z at these instants, shape (n_rows, n_some), scaled.
        """
        displacement = self.displacement[:, instants]
        outgoing = self._outgoing[:, instants]
        for rule in self._instantaneous:
            rule(incoming, displacement, instants)
        np.multiply(displacement, 2.0, out=outgoing)
        np.subtract(outgoing, incoming, out=outgoing)
