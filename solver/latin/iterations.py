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
from solver.latin.reduced_linear import ReducedLinearStage
from solver.latin.reduced_local import ReducedLocalStage
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
    sampled = _reduced_local_stage(problem, k, settings, linear_stage)
    state = linear_stage.start(start)
    if sampled is not None and start is not None and start.references is not None:
        sampled.adopt(start.references, state)
    incoming = linear_stage.incoming(state, space_time(problem.n_rows, problem.n_instants))
    number = start.number if start else 0
    clock.stop()
    read = _frozen(incoming)
    while True:
        clock.go_on()
        number += 1
        local_error = 0.0
        if sampled is not None and sampled.is_reduced(number):
            sampled(state)
            clock.stop()
            # What the laws say everywhere is for those who look, and for the error of the few.
            local_error = linear_stage.distance_of_target(local_stage(incoming))
            clock.go_on()
        else:
            linear_stage.read(local_stage(incoming))
        linear_stage.advance(state, settings.relaxation)
        if sampled is not None:
            sampled.keep_up(number, state)
            if sampled.is_reduced(number + 1):
                # Read by the full local stage alone.
                clock.stop()
        linear_stage.incoming(state, incoming)
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
            references=sampled.references if sampled else None,
            local_error=local_error,
        )
        read = given


def _linear_stage(problem: Problem, k: Array, settings: Settings) -> LinearStage[Any]:
    if settings.linear_stage == "pgd":
        return ReducedLinearStage(problem, k, settings)
    return FullLinearStage(problem, k, multiscale=settings.multiscale)


def _reduced_local_stage(
    problem: Problem, k: Array, settings: Settings, linear_stage: LinearStage[Any]
) -> ReducedLocalStage | None:
    if settings.local_stage == "full" or not isinstance(linear_stage, ReducedLinearStage):
        return None
    return ReducedLocalStage(problem, k, settings, linear_stage)


class _Clock:
    """Time that the method takes; it runs from birth until stopped."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.go_on()

    def go_on(self) -> None:
        self._since: float | None = time.perf_counter()

    def stop(self) -> None:
        if self._since is not None:
            self.seconds += time.perf_counter() - self._since
        self._since = None


def _frozen(field: Array) -> Array:
    copy = field.copy(order="F")
    copy.flags.writeable = False
    return copy
