"""A start from the solution of the run before, where that is better than the method's own."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.indicators import behaviour_indicator
from solver.latin.iterate import Checkpoint, Iterate
from solver.latin.iterations import iterations
from solver.latin.method import Latin
from solver.latin.start.prolong import prolong

CLEARLY = 0.25
"""Share of the other's indicator up to which the previous solution is taken. Between this and 1
its fields are nearer at first, but undoing what is wrong in them costs more than zero does. Of 76
changes of a setting that were tried, it took more iterations to 1 % of friction force in 2 of the
37 below this share, and in 17 of the 22 between."""


@dataclass(frozen=True)
class StartChoice:
    """Which start was taken, and why.

    Attributes
    ----------
    previous, own
        The k-free indicator after one iteration from the previous solution, and from the
        method's own start.
    """

    previous: float
    own: float

    @property
    def is_previous(self) -> bool:
        """Whether the previous solution was taken."""
        return math.isfinite(self.previous) and not self.previous > CLEARLY * self.own


@dataclass(frozen=True, eq=False)
class Start:
    """A start that was chosen, from which the run can be repeated exactly.

    Attributes
    ----------
    checkpoint
        The previous solution; None is the method's own start.
    seconds
        What was spent before the run: the other first iteration, and the choice.
    """

    choice: StartChoice
    checkpoint: Checkpoint | None
    seconds: float


def choose_start(
    problem: Problem, latin: Latin, previous: Iterate
) -> tuple[Start, Iterator[Iterate]]:
    """Do one iteration from each start, and go on from that with the lower k-free indicator.

    The LATIN indicator compares the two stages of one search direction; the k-free one compares
    with the laws, and so is the same measure for any two fields. The previous solution has to be
    `CLEARLY` better.

    Parameters
    ----------
    problem, latin
        What to solve, and the method.
    previous
        The last iterate of another run, of the same scene.

    Returns
    -------
    The start, and the run from iteration 1 on, on whose clock are both first iterations.
    """
    own = iterations(problem, latin)
    first = next(own)
    began = time.perf_counter()
    outgoing = carry(previous, problem, first.k)
    outgoing.flags.writeable = False
    carrying = time.perf_counter() - began
    checkpoint = Checkpoint(0, 0.0, outgoing)
    warm = iterations(problem, latin, checkpoint)
    second = next(warm)
    began = time.perf_counter()
    choice = StartChoice(behaviour_indicator(second), behaviour_indicator(first))
    choosing = carrying + time.perf_counter() - began
    if choice.is_previous:
        start = Start(choice, checkpoint, choosing + first.seconds)
        return start, _billed(chain([second], warm), start.seconds)
    start = Start(choice, None, choosing + second.seconds)
    return start, _billed(chain([first], own), start.seconds)


def iterations_from(
    problem: Problem, latin: Latin, start: Start | None, checkpoint: Checkpoint | None
) -> Iterator[Iterate]:
    """Go on from a checkpoint of a run, or repeat it from its start; None is the method's own."""
    if checkpoint is not None or start is None:
        return iterations(problem, latin, checkpoint)
    return _billed(iterations(problem, latin, start.checkpoint), start.seconds)


def carry(previous: Iterate, problem: Problem, k: Array) -> Array:
    """Give the fields of an iterate as a start for another problem.

    Row by row where the two problems are cut alike; otherwise linear in time, as a share of the
    whole, and then in space.

    Parameters
    ----------
    previous
        An iterate of any problem.
    problem, k
        The problem to start, and its search direction, shape (n_rows,).

    Returns
    -------
    W + F/k, shape (n_rows, n_instants), scaled as `problem` is.
    """
    old = previous.problem
    displacement = previous.boundary_displacement * (
        old.scales.displacement / problem.scales.displacement
    )
    force = previous.boundary_force * (old.scales.force / problem.scales.force)
    displacement, force = (
        _at_instants(field, old.instants, problem.instants) for field in (displacement, force)
    )
    if np.array_equal(old.row_dofs, problem.row_dofs):
        return np.asfortranarray(displacement + force / k[:, None])
    return prolong(old, displacement, force, problem, k)


def _at_instants(field: Array, old: Array, new: Array) -> Array:
    """Interpolate in time, linear between the old instants, both scaled to their last one."""
    if len(old) == len(new):
        return field
    if len(old) == 1:
        return np.repeat(field, len(new), axis=1)
    old, new = old / old[-1], new / new[-1]
    right = np.clip(np.searchsorted(old, new), 1, len(old) - 1)
    share = np.clip((new - old[right - 1]) / (old[right] - old[right - 1]), 0.0, 1.0)
    return np.asarray(field[:, right - 1] * (1.0 - share) + field[:, right] * share)


def _billed(iterates: Iterator[Iterate], seconds: float) -> Iterator[Iterate]:
    """Put on the clock of an iteration what was spent beside it."""
    for iterate in iterates:
        yield replace(iterate, seconds=iterate.seconds + seconds)


def fits(previous: Iterate | None, problem: Problem) -> bool:
    """Tell whether a run may start from another's iterate.

    Row by row it always may; fields that have to be carried to another mesh must be those of wires
    that rub where these do.
    """
    if previous is None:
        return False
    old = previous.problem
    if np.array_equal(old.row_dofs, problem.row_dofs):
        return True
    wires = old.positions.ndim == problem.positions.ndim == 1
    return wires and set(problem.rubbing) <= set(old.rubbing)
