"""The LATIN iteration as a generator (paper, Fig. 1; MATHEMATICS.md, 2)."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from itertools import count

from numpy.linalg import LinAlgError

from solver.arrays import Array, read_only
from solver.checks import InstanceOf, Numbers, check_value
from solver.discrete.problem import Problem
from solver.latin.anderson import AndersonState
from solver.latin.iterate import Checkpoint, Iterate
from solver.latin.method import Latin
from solver.latin.stages.blocks import Blocks, one_blas_thread
from solver.latin.stages.linear import LinearStage
from solver.latin.stages.local import LocalStage
from solver.latin.stages.rigid_bodies import RigidBodies, moves_rigidly
from solver.latin.start import prolong, wrong_waves
from solver.refusal import RefusedError

STARTING = 0.5
"""Largest share of the run's time limit that the start may use."""


def iterations(
    problem: Problem,
    latin: Latin,
    start: Checkpoint | None = None,
) -> Iterator[Iterate]:
    """Iterate between the local and the linear stage, without end.

    Parameters
    ----------
    problem, latin
        What to solve, and the method.
    start
        State from which the run continues. Without one the method has its own start,
        and a body that contact alone holds starts where it comes to rest.

    Yields
    ------
    Snapshots, one per iteration; their seconds stand still while the consumer has one.

    Raises
    ------
    RefusedError
        For objects that are no problem, method or start, and a start of another shape.
    """
    check_value("problem", problem, InstanceOf(Problem))
    check_value("latin", latin, InstanceOf(Latin))
    if start is not None:
        shape = problem.n_rows, problem.n_instants
        check_value("start", start, InstanceOf(Checkpoint))
        check_value("start.outgoing", start.outgoing, Numbers((shape,)))
    began = time.perf_counter()
    seconds = 0.0
    first = 1
    if start is not None:
        seconds = start.seconds
        first = start.number + 1
    with one_blas_thread:
        iteration = Iteration(problem, latin, start)
    for number in count(first):
        with one_blas_thread:
            iteration.local_stage()
            iteration.linear_stage()
            iteration.choose_direction()
        # The clock stands while the consumer has the iterate.
        seconds += time.perf_counter() - began
        iterate = iteration.snapshot(number, seconds)
        yield iterate
        began = time.perf_counter()
        if iteration.has_new_k:
            with one_blas_thread:
                iteration = Iteration(problem, latin, iterate.checkpoint)


class Iteration:
    """Both stages of the method on a problem, in turn, with one k.

    Attributes
    ----------
    k
        Search direction of the rows, shape (n_rows,), scaled.
    linear, local
        The two stages.
    incoming, outgoing
        W - F/k and W + F/k of the linear stage, shape (n_rows, n_instants), scaled,
        read-only, and new after every linear stage.
    """

    def __init__(
        self, problem: Problem, latin: Latin, start: Checkpoint | None = None
    ) -> None:
        self._problem = problem
        self._latin = latin
        coarse = None
        if start is None and latin.start is not None:
            coarse = latin.start.of(problem, STARTING * latin.stop.seconds)
        if start is not None and start.k_state is not None:
            self._k_state = start.k_state
        else:
            waves = math.inf
            if coarse is not None:
                waves = wrong_waves(coarse)
            self._k_state = latin.direction.begin(
                problem, start, waves, multiscale=latin.multiscale
            )
        self.k = self._k_state.k
        blocks = Blocks(problem.n_rows, problem.n_instants, latin.threads)
        self.linear = _linear_stage(problem, self.k, latin, blocks)
        self.local = LocalStage(
            problem, self.k, blocks, self._rigid_bodies(latin, start)
        )
        self._mixture: AndersonState | None = None
        if latin.acceleration is not None and self.linear.is_full:
            self._mixture = AndersonState(
                problem, self.linear, self.local.motion, blocks
            )
        if coarse is not None:
            start = Checkpoint(0, 0.0, prolong(coarse, problem, self.k))
        elif start is None and problem.rest is not None:
            # A body that nothing else holds would have to travel there iteration by
            # iteration.
            start = Checkpoint(0, 0.0, problem.rest[problem.row_dofs])
        self.linear.restore(start)
        self._read_fields()

    def _rigid_bodies(
        self, latin: Latin, start: Checkpoint | None
    ) -> RigidBodies | None:
        """Shifts of rigid bodies in the local stage: a part of the coarse problem.

        Truncated bases would not hold what little of their fields is deformation.
        """
        if latin.may_shift and moves_rigidly(self._problem):
            return RigidBodies(self._problem, self.k, from_rest=start is None)
        return None

    def _read_fields(self) -> None:
        """Read the fields of the linear stage."""
        self.incoming = read_only(self.linear.incoming())
        self.outgoing = read_only(self.linear.outgoing())

    def local_stage(self) -> None:
        """Apply the interface laws along E+ (paper, problem 2.1)."""
        self.linear.read(self.local(self.incoming))

    def linear_stage(self) -> None:
        """Solve elasticity along E- (paper, problem 2.2), relax, accelerate."""
        mix = self._mixture
        if mix is not None:
            mix.start()
        self.linear.advance(float(self._latin.relaxation))
        if mix is not None:
            mix.mix()
        self._read_fields()

    def choose_direction(self) -> None:
        """Choose the k of the next iteration."""
        # A k that stays needs no snapshot of the fields.
        if not self._k_state.is_final:
            self._k_state = self._latin.direction.follow(self.snapshot(), self._k_state)

    @property
    def has_new_k(self) -> bool:
        """Check whether the next iteration has another k, and so needs new stages."""
        return self._k_state.k is not self.k

    def snapshot(self, number: int = 0, seconds: float = 0.0) -> Iterate:
        """Iterate with a number and a time in seconds."""
        return Iterate(
            number=number,
            seconds=seconds,
            problem=self._problem,
            k=self.k,
            outgoing=self.outgoing,
            incoming=self.incoming,
            local_displacement=read_only(self.local.displacement),
            local_incoming=read_only(self.local.incoming),
            bases=self.linear.bases(),
            k_state=self._k_state,
        )


def _linear_stage(
    problem: Problem, k: Array, latin: Latin, blocks: Blocks
) -> LinearStage:
    """Linear stage of a method with a k of shape (n_rows,), scaled.

    Raises
    ------
    RefusedError
        If k is so far from the stiffness that a substructure becomes singular.
    """
    try:
        return LinearStage(
            problem, k, latin.linear, blocks, multiscale=latin.multiscale
        )
    except LinAlgError:
        raise RefusedError(
            "k_scale",
            latin.direction.scale,
            "a k that holds every substructure in the digits of a number",
            "bring the factors on k nearer to 1, or the sides of the elements to each "
            "other",
        ) from None
