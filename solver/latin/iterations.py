"""The LATIN iteration as a generator (paper, Fig. 1; theory.md, 2)."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.linalg import LinAlgError

from solver.arrays import Array
from solver.definitions import SettingError
from solver.discrete.problem import Problem
from solver.latin.acceleration import Anderson, anderson
from solver.latin.blocks import Blocks
from solver.latin.direction import search_direction
from solver.latin.direction_update import DirectionUpdate
from solver.latin.iterate import Checkpoint, Course, Iterate
from solver.latin.linear import FullLinearStage, LinearStage
from solver.latin.local import LocalStage
from solver.latin.nested import nested_start
from solver.latin.reduced_linear import ReducedLinearStage
from solver.latin.reduced_local import ReducedLocalStage
from solver.reduction.basis import Reduction, References
from solver.scenes import coarser_problems
from solver.settings import Settings


def iterations(
    problem: Problem,
    settings: Settings,
    start: Checkpoint | None = None,
    *,
    resumable: bool = True,
) -> Iterator[Iterate]:
    """Iterate between the local and the linear stage, without end.

    Parameters
    ----------
    problem, settings
        What to solve, and the options of the method.
    start
        Where to go on from; without one the settings say where to start, and a body that contact
        alone holds where it comes to rest.
    resumable
        Whether iterates shall have checkpoints: what an acceleration remembers is kept for them,
        as much again as it holds itself.

    Yields
    ------
    Snapshots, one per iteration; the clock bills them too, and stands still while the consumer has
    one.
    """
    clock = Clock(start.seconds if start else 0.0)
    engine = Engine(problem, settings, start)
    number = start.number if start else 0
    read, outgoing = engine.incoming, engine.outgoing
    history = list(start.history) if start and resumable else []
    while True:
        number += 1
        if engine.turn():
            read, outgoing, history = engine.incoming, engine.outgoing, []
        local_error = engine.step(number, clock)
        if resumable:
            history = [*history, outgoing][-engine.remembered :] if engine.remembered else []
        outgoing = engine.outgoing
        clock.stop()
        yield Iterate(
            number=number,
            seconds=clock.seconds,
            problem=problem,
            k=engine.k,
            outgoing=outgoing,
            incoming=engine.incoming,
            local_displacement=engine.local_displacement,
            local_incoming=read,
            reduction=engine.reduction,
            references=engine.references,
            local_error=local_error,
            history=tuple(history),
            memory=engine.memory,
            course=engine.course,
        )
        clock.go_on()
        read = engine.incoming


def _start(problem: Problem, settings: Settings, k: Array) -> Checkpoint | None:
    """Give the start of the settings' own choice; None is zero fields."""
    if problem.rest is not None:
        return Checkpoint(0, 0.0, problem.rest[problem.row_dofs])
    if settings.start == "nested":
        return nested_start(coarser_problems(settings), settings, problem, k)
    return None


class Engine:
    """Both stages at work, with what the options add to them.

    Attributes
    ----------
    k
        Search direction of the rows, shape (n_rows,), scaled.
    incoming
        W - F/k of the linear stage, shape (n_rows, n_instants); read-only, and new at every step.
    """

    def __init__(self, problem: Problem, settings: Settings, start: Checkpoint | None) -> None:
        self._problem, self._settings = problem, settings
        # A setting takes longer to read than the law of friction to obey.
        self._relaxation: float = settings.relaxation
        k = search_direction(problem, settings)
        k.flags.writeable = False
        self._update: DirectionUpdate | None = None
        if settings.k_update == "status" and settings.linear_stage == "full":
            self._update = DirectionUpdate(problem, k, start.course if start else None)
            k = self._update.course.k
        self._make_stages(k)
        if start is None:
            start = _start(problem, settings, self.k)
        stage: LinearStage[Any] = self._linear_stage
        self._state = stage.start(start)
        self.incoming = self._reflected()
        if start is not None:
            self._recall(start)

    def _make_stages(self, k: Array) -> None:
        try:
            self._factored(k)
        except (LinAlgError, RuntimeError):  # of a dense factor, and of a sparse one
            raise SettingError(
                "k_scale",
                self._settings.k_scale,
                "a k that holds every substructure in the digits of a number",
                "bring the factors on k nearer to 1, or the sides of the elements to each other",
            ) from None

    def _factored(self, k: Array) -> None:
        """Make both stages for a k; the linear one is factored."""
        problem, settings = self._problem, self._settings
        self.k = k
        blocks = Blocks(problem.n_rows, problem.n_instants, settings.threads)
        self._local_stage = LocalStage(problem, self.k, blocks=blocks)
        self._sampled: ReducedLocalStage | None = None
        self._anderson: Anderson | None = None
        self._linear_stage: LinearStage[Any]
        if settings.is_reduced:
            reduced = ReducedLinearStage(problem, self.k, settings)
            if settings.local_stage == "reduced":
                self._sampled = ReducedLocalStage(problem, self.k, settings, reduced)
            self._linear_stage = reduced
        else:
            full = FullLinearStage(problem, self.k, multiscale=settings.multiscale, blocks=blocks)
            if settings.acceleration == "anderson":
                self._anderson = anderson(problem, full, settings.anderson_memory, blocks)
            self._linear_stage = full

    def turn(self) -> bool:
        """Change k if it is time to, and say so; W and F stay, or go back to earlier ones."""
        if self._update is None or not self._update.is_due:
            return False
        outgoing = self.outgoing
        displacement = 0.5 * (outgoing + self.incoming)
        found = self._update.turn(displacement, self.k[:, None] * (outgoing - displacement))
        if found is None:
            return False
        displacement, force = found
        self._make_stages(self._update.course.k)
        outgoing = displacement + force / self.k[:, None]
        self._state = self._linear_stage.start(Checkpoint(0, 0.0, outgoing))
        self.incoming = self._reflected()
        return True

    def step(self, number: int, clock: Clock) -> float:
        """Do one iteration; give the error of a reduced local stage, or 0."""
        local_error = 0.0
        if self._sampled is not None and self._sampled.is_reduced(number):
            self._sampled(self._state)
            clock.stop()
            # What the laws say everywhere is for those who look, and for the error of the few.
            everywhere = self._local_stage(self.incoming)
            local_error = self._linear_stage.distance_of_target(everywhere)
            clock.go_on()
        else:
            self._linear_stage.read(self._local_stage(self.incoming))
        if self._update is not None:
            self._update.see(self.local_displacement)
        self._advance()
        if self._sampled is not None:
            self._sampled.keep_up(number, self._state)
        self.incoming = self._reflected()
        return local_error

    def _reflected(self) -> Array:
        field = np.empty((self._problem.n_rows, self._problem.n_instants), order="F")
        return _read_only(self._linear_stage.incoming(self._state, field))

    @property
    def outgoing(self) -> Array:
        """W + F/k of the linear stage, shape (n_rows, n_instants); new at every call."""
        return _read_only(self._linear_stage.to_boundary(self._state))

    @property
    def local_displacement(self) -> Array:
        """W^ of the local stage, shape (n_rows, n_instants); new at every step."""
        return _read_only(self._local_stage.displacement)

    @property
    def reduction(self) -> Reduction | None:
        """The separated bases, if any."""
        return self._linear_stage.reduction(self._state)

    @property
    def references(self) -> References | None:
        """Reference points and instants, if any."""
        return self._sampled.references if self._sampled else None

    @property
    def remembered(self) -> int:
        """States before the present one that shape the next."""
        return self._anderson.remembered if self._anderson else 0

    @property
    def memory(self) -> tuple[int, int, float] | None:
        """What the acceleration counts."""
        found = self._anderson
        return (found.seen, found.count, found.smallest) if found else None

    @property
    def course(self) -> Course | None:
        """How far the update of k has come."""
        return self._update.course if self._update else None

    def _advance(self) -> None:
        if self._anderson is None:
            self._linear_stage.advance(self._state, self._relaxation)
            return
        self._anderson.start(self._state)
        self._linear_stage.advance(self._state, self._relaxation)
        self._anderson(self._state)

    def _recall(self, start: Checkpoint) -> None:
        """Bring back what the options remember, from a checkpoint of the same run."""
        if self._sampled is not None and start.references is not None:
            self._sampled.adopt(start.references, self._state)
        if self._anderson is None or start.memory is None:
            return
        seen, count, smallest = start.memory
        self._anderson.count = max(count - len(start.history) + 1, 0)
        for outgoing in start.history:
            state = self._linear_stage.start(Checkpoint(0, 0.0, outgoing))
            self._anderson.start(state)
            incoming = self._linear_stage.incoming(state, np.empty_like(self.incoming))
            self._linear_stage.read(self._local_stage(incoming))
            self._linear_stage.advance(state, self._relaxation)
            self._anderson.observe(state)
        self._anderson.seen, self._anderson.count = seen, count
        self._anderson.smallest = smallest


class Clock:
    """Time that the method takes; it runs from birth until stopped."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.go_on()

    def go_on(self) -> None:
        """Run again."""
        self._since: float | None = time.perf_counter()

    def stop(self) -> None:
        """Stand still."""
        if self._since is not None:
            self.seconds += time.perf_counter() - self._since
        self._since = None


def _read_only(field: Array) -> Array:
    field.flags.writeable = False
    return field
