"""The LATIN iteration as a generator (paper, Fig. 1; solver/README.md, 2)."""

from __future__ import annotations

import time
from collections.abc import Iterator
from itertools import count
from math import inf

from numpy.linalg import LinAlgError

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.blocks import Blocks, one_blas_thread
from solver.latin.iterate import Checkpoint, Iterate, read_only
from solver.latin.linear_stage import LinearStage
from solver.latin.local_stage import LocalStage
from solver.latin.method import Latin
from solver.refusal import RefusedError

STARTING = 0.5
"""Share of the time that a run may take which its start may take."""


def iterations(
    problem: Problem,
    latin: Latin,
    start: Checkpoint | None = None,
    *,
    resumable: bool = True,
) -> Iterator[Iterate]:
    """Iterate between the local and the linear stage, without end.

    Parameters
    ----------
    problem, latin
        What to solve, and the method.
    start
        Where to go on from; without one the method says where to start, and a body that contact
        alone holds where it comes to rest.
    resumable
        Whether iterates shall have checkpoints: what an acceleration remembers is kept for them,
        as much again as it holds itself.

    Yields
    ------
    Snapshots, one per iteration; their seconds stand still while the consumer has one.
    """
    began, seconds = time.perf_counter(), start.seconds if start else 0.0
    with one_blas_thread():
        iteration = Iteration(problem, latin, start)
    for number in count(start.number + 1 if start else 1):
        with one_blas_thread():
            iteration.choose_direction()
            iteration.local_stage()
            iteration.linear_stage()
        seconds += time.perf_counter() - began
        yield iteration.snapshot(number, seconds, resumable=resumable)
        began = time.perf_counter()


class Iteration:
    """Both stages of the method on a problem, in turn, and what passes between them.

    Parameters
    ----------
    problem, latin, start
        As for `iterations`.

    Attributes
    ----------
    k
        Search direction of the rows, shape (n_rows,), scaled, read-only.
    incoming
        W - F/k of the linear stage, shape (n_rows, n_instants); read-only, and new after every
        linear stage.
    outgoing
        W + F/k of the linear stage, likewise.
    """

    def __init__(self, problem: Problem, latin: Latin, start: Checkpoint | None = None) -> None:
        self._problem, self._latin = problem, latin
        self._course = latin.direction.begin(problem, start)
        self._assemble()
        if start is None:
            start = _first_state(problem, latin, self.k)
        self._go_to(start)
        if start is not None:
            self._recall(start)
        self._history = list(start.history) if start else []
        self._before = self.outgoing
        self._read = self.incoming

    def _assemble(self) -> None:
        """Assemble the parts for one search direction; the linear stage is factored.

        Raises
        ------
        RefusedError
            If k is so far from the stiffness that a factor breaks down.
        """
        problem, latin, self.k = self._problem, self._latin, self._course.k
        blocks = Blocks(problem.n_rows, problem.n_instants, latin.threads)
        try:
            self.linear = LinearStage(
                problem, self.k, latin.linear, blocks, multiscale=latin.multiscale
            )
        except (LinAlgError, RuntimeError):  # of a dense factor, and of a sparse one
            raise RefusedError(
                "k_scale",
                latin.direction.scale,
                "a k that holds every substructure in the digits of a number",
                "bring the factors on k nearer to 1, or the sides of the elements to each other",
            ) from None
        self.local = LocalStage(problem, self.k, blocks)
        mix = latin.acceleration
        self._mixture = mix.begin(problem, self.linear, self.local.motion, blocks) if mix else None

    def _go_to(self, start: Checkpoint | None) -> None:
        """Go to the state of a checkpoint, or to that in which all is zero."""
        self.linear.go_to(start)
        self._show()

    def _show(self) -> None:
        self.incoming = read_only(self.linear.incoming())
        self.outgoing = read_only(self.linear.outgoing())

    def _recall(self, start: Checkpoint) -> None:
        """Restore what an acceleration remembers, from a checkpoint of the same run."""
        mix = self._mixture
        if start.memory is None or mix is None:
            return
        _, differences, _ = start.memory
        mix.restore((0, max(differences - len(start.history) + 1, 0), inf))
        for outgoing in start.history:
            self._go_to(Checkpoint(0, 0.0, outgoing))
            self.linear.read(self.local(self.incoming))
            self.linear_stage(mixes=False)
        mix.restore(start.memory)
        self._go_to(start)

    def choose_direction(self) -> None:
        """Change k if it is time to; W and F stay, or go back to earlier ones."""
        direction = self._latin.direction
        if not direction.is_due(self._course):
            return
        displacement = 0.5 * (self.outgoing + self.incoming)
        force = self.k[:, None] * (self.outgoing - displacement)
        fields = displacement, force
        self._course, kept = direction.update(self._problem, self._course, fields)
        if kept is None:
            return
        self._assemble()
        displacement, force = kept
        self._go_to(Checkpoint(0, 0.0, displacement + force / self.k[:, None]))
        self._history = []

    def local_stage(self) -> None:
        """Obey the laws along E+ (paper, problem 2.1)."""
        self.linear.read(self.local(self.incoming))
        self._read = read_only(self.local.incoming)
        self._course = self._latin.direction.observe(
            self._problem, self._course, self.local.displacement, self._read
        )

    def linear_stage(self, *, mixes: bool = True) -> None:
        """Solve elasticity along E- (paper, problem 2.2), relax, accelerate unless told not to."""
        mix, self._before = self._mixture, self.outgoing
        if mix is not None:
            mix.start()
        self.linear.advance(float(self._latin.relaxation))
        if mix is not None and mix.observe() and mixes:
            mix.mix()
        self._show()

    def snapshot(self, number: int, seconds: float, *, resumable: bool = True) -> Iterate:
        """The iterate of this number, after so many seconds."""
        mix = self._mixture
        remembered = mix.remembered if mix else 0
        if resumable and remembered:
            self._history = [*self._history, self._before][-remembered:]
        return Iterate(
            number=number,
            seconds=seconds,
            problem=self._problem,
            k=self.k,
            outgoing=self.outgoing,
            incoming=self.incoming,
            local_displacement=read_only(self.local.displacement),
            local_incoming=self._read,
            reduction=self.linear.reduction(),
            history=tuple(self._history) if resumable and remembered else (),
            memory=mix.memory if mix else None,
            course=self._course,
        )


def _first_state(problem: Problem, latin: Latin, k: Array) -> Checkpoint | None:
    """The start of the method's own choice; None is zero fields."""
    if problem.rest is not None:
        return Checkpoint(0, 0.0, problem.rest[problem.row_dofs])
    return latin.start.of(problem, k, STARTING * latin.stop.seconds) if latin.start else None
