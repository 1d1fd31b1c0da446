"""A start from coarser meshes: what is global is found where an iteration is cheap."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.acceleration.anderson import Anderson
from solver.latin.cycle import Cycle, Parts
from solver.latin.direction.rules import automatic
from solver.latin.iterate import Checkpoint
from solver.latin.linear.full import FullLinearStage
from solver.latin.local.stage import LocalStage
from solver.latin.start.prolong import prolong

RELAXATION = 0.8
"""On coarse meshes, which are monoscale: there the method need not converge with 1."""
FACTOR = 0.7
"""On the automatic k of friction points: what a coarse mesh is to give is global."""
MOST = 40
"""Iterations on a coarse mesh at most. 1 % of the friction force takes 17 iterations of the run
with 20, 40 and 80, 20 with 10 and 37 with 5 (bar); on 400 elements 13 with 40, 12 with 80 and more
than 60 with 20 (measured)."""
RESIDUAL = 0.05
"""Relative residual of one iteration, over (h/L)^2, at which a coarse mesh has given what it can:
its own error is of that order. Measured from 50 to 800 elements and at peaks of 300 to 2400 N:
0.03 saves iterations on the mesh of the run at 2400 N alone, with 0.1 that takes more than 30."""


@dataclass(frozen=True)
class Nested:
    """A start from the same structure on coarser meshes.

    Attributes
    ----------
    coarser
        These problems, uncut, the finest first; or what makes them, when a run begins.
    """

    coarser: Sequence[Problem] | Callable[[], Sequence[Problem]]

    def at_work(self, problem: Problem, k: Array, seconds: float = math.inf) -> Checkpoint | None:
        """Give where a problem starts with a search direction; None if there is no coarser mesh.

        After so many seconds every mesh that is left has one iteration.
        """
        deadline = time.perf_counter() + seconds
        coarser = self.coarser() if callable(self.coarser) else self.coarser
        return nested_start(list(coarser), problem, k, deadline)


def nested_start(
    coarser: list[Problem], problem: Problem, k: Array, deadline: float = math.inf
) -> Checkpoint | None:
    """Iterate on the coarsest mesh, carry the result over to the next finer one, and so on.

    The coarse meshes are uncut, on the automatic search direction, with Anderson acceleration,
    whatever the run does: only its start is wanted of them.

    Parameters
    ----------
    coarser
        The same structure on coarser meshes, the finest first.
    problem, k
        Where the run starts, and its search direction.
    deadline
        After which every mesh has one iteration, by `time.perf_counter`.

    Returns
    -------
    None if there is no coarser mesh.
    """
    start: Checkpoint | None = None
    for coarse, finer in reversed(list(zip(coarser, [problem, *coarser], strict=False))):
        own = _direction(coarse)
        linear = FullLinearStage(coarse, own, multiscale=True)
        mix = Anderson().at_work(coarse, linear)
        assert mix is not None
        parts = Parts(own, LocalStage(coarse, own), linear, mix, RELAXATION)
        cycle = Cycle(coarse, parts, start)
        points = max(len(law.positions) for law in coarse.rubbing.values())
        enough = RESIDUAL / (points - 1) ** 2
        for _ in range(MOST):
            cycle.local_stage()
            cycle.linear_stage()
            if mix.relative_residual <= enough or time.perf_counter() > deadline:
                break
        outgoing, incoming = cycle.outgoing, cycle.incoming
        displacement = 0.5 * (outgoing + incoming)
        force = 0.5 * own[:, None] * (outgoing - incoming)
        wanted = k if finer is problem else _direction(finer)
        start = Checkpoint(0, 0.0, prolong(coarse, displacement, force, finer, wanted))
    return start


def _direction(coarse: Problem) -> Array:
    k = automatic(coarse)
    for law in coarse.rubbing.values():
        for rows in law.tangent.sides:
            k[rows] *= FACTOR
    return k
