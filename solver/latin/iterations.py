"""The LATIN iteration as a generator (paper, Fig. 1; theory.md, 2)."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

from solver.discrete.problem import Array, Problem, space_time
from solver.latin.direction import search_direction
from solver.latin.iterate import Checkpoint, Iterate
from solver.latin.linear import FullLinearStage, LinearStage
from solver.latin.local import LocalStage
from solver.reduction.pgd import ReducedLinearStage
from solver.settings import Settings


def iterations(
    problem: Problem, settings: Settings, start: Checkpoint | None = None
) -> Iterator[Iterate]:
    """Iterate between the local and the linear stage, without end.

    Parameters
    ----------
    problem, settings
        What to solve, and the options of the method.
    start
        Where to go on from; zero fields without one.

    Yields
    ------
    Snapshots, one per iteration; the clock stands still while the consumer has one.
    """
    clock = _Clock(start.seconds if start else 0.0)
    k = search_direction(problem, settings)
    k.flags.writeable = False
    local_stage = LocalStage(problem, k)
    linear_stage = _linear_stage(problem, k, settings)
    state = linear_stage.start(start)
    incoming = linear_stage.incoming(state, space_time(problem.n_rows, problem.n_instants))
    number = start.number if start else 0
    clock.stop()
    read = _frozen(incoming)
    while True:
        clock.go_on()
        target = local_stage(incoming)
        linear_stage.advance(state, target, settings.relaxation)
        linear_stage.incoming(state, incoming)
        number += 1
        clock.stop()
        given = _frozen(incoming)
        yield Iterate(
            number=number,
            seconds=clock.seconds,
            problem=problem,
            k=k,
            outgoing=_frozen(linear_stage.to_boundary(state)),
            incoming=given,
            local_displacement=_frozen(local_stage.displacement),
            local_incoming=read,
            reduction=linear_stage.reduction(state),
        )
        read = given


def _linear_stage(problem: Problem, k: Array, settings: Settings) -> LinearStage[Any]:
    if settings.linear_stage == "pgd":
        return ReducedLinearStage(problem, k, settings)
    return FullLinearStage(problem, k, multiscale=settings.multiscale)


class _Clock:
    """Time that the method takes; it runs from birth until stopped."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.go_on()

    def go_on(self) -> None:
        self._since = time.perf_counter()

    def stop(self) -> None:
        self.seconds += time.perf_counter() - self._since


def _frozen(field: Array) -> Array:
    copy = field.copy(order="F")
    copy.flags.writeable = False
    return copy
