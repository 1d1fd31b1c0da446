"""A run in the worker process: its pieces of work when they are due, and its frames."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace

from app.frame import Frame
from app.messages import WHOLE, Needs, Start
from app.worker.references import ReferenceCache, has_reference
from app.worker.sampling import Sampler
from solver.latin import Ending, Iterate, Record, Status, judged, record
from solver.latin.end.cost import RunCost, run_cost
from solver.latin.end.status import collapses
from solver.reference.assembly import Interrupted
from solver.reference.distance import Distance, distance_to
from solver.scenes import discretise
from solver.scenes.method import method_of

HURRY = 0.1
"""Seconds that a run which follows a dragged slider has to end before it is shown."""
WHOLE_LASTS = 3.0
FIRST = 0.25
"""Seconds that a search takes at the pace `WHOLE`, and those before its second iterate.
Intervals shrink by one ratio: each of the first iterates is seen, and a hundred last as
long as thirty."""
LATE = 0.1
"""Seconds that iterations may be behind and catch up: pictures are painted in
between."""


class Pacing:
    """The pace of a run, as in `Start`, and the steps that were asked for."""

    def __init__(self, pace: float, steps: int = 0) -> None:
        self._pace = pace
        self._steps = steps
        self._done = 0
        self._due = time.monotonic()

    def change(self, pace: float) -> None:
        """Go on at another pace."""
        self._pace = pace
        self._steps = 0
        self._due = min(self._due, time.monotonic() + self._interval())

    def step(self) -> None:
        """Do one more iteration, and wait."""
        self._pace = 0.0
        self._steps += 1

    def count(self, number: int) -> None:
        """Count the iteration that was done."""
        self._done = number
        self._steps = max(self._steps - 1, 0)
        self._due = max(self._due, time.monotonic() - LATE) + self._interval()

    def rest(self) -> float | None:
        """Seconds until the next iteration is due; None waits for an order."""
        if self._steps:
            return 0.0
        if self._pace == 0.0:
            return None
        return max(self._due - time.monotonic(), 0.0)

    def _interval(self) -> float:
        if self._pace == WHOLE:
            return FIRST * float((1.0 - FIRST / WHOLE_LASTS) ** self._done)
        if 0.0 < self._pace < math.inf:
            return 1.0 / self._pace
        return 0.0


class Runner:
    """A run: its first iteration, the reference, then iterations as they are due.

    It is `interrupted` where an order waits that ends it; where one waits that halts it
    a status step is given up until it goes on. The problem is shown by `sampler`; it
    has the newest `iterate`, a `history` with a record of each, and at its end a
    `status`. `pacing` says when the next iteration is due, `has_news` whether anything
    changed since the last frame.
    """

    def __init__(
        self,
        start: Start,
        references: ReferenceCache,
        interrupted: Callable[[], bool],
        halted: Callable[[], bool] = lambda: False,
    ) -> None:
        self.settings = settings = start.settings
        self.is_dragged = start.is_dragged
        began = time.perf_counter()
        problem = discretise(settings)
        latin = method_of(settings)
        is_compared = has_reference(settings)
        most = settings.max_iterations
        self.cost: RunCost = run_cost(problem, latin, most, with_reference=is_compared)
        spent = time.perf_counter() - began
        self.sampler = Sampler(problem, settings, start.number)
        self.iterate: Iterate | None = None
        self.history: list[Record] = []
        self.status: Status | None = None
        self.has_news = False
        self.pacing = Pacing(start.pace, start.steps)
        self._iterates = judged(problem, latin, spent=spent, interrupted=halted)
        self._references = references
        self._interrupted = interrupted
        self._is_compared = False
        self._distance: Distance | None = None
        self._hurries_until = time.monotonic() + (HURRY if start.is_dragged else 0.0)

    @property
    def hurries(self) -> bool:
        """Check whether the run goes on before it is shown."""
        return self.status is None and time.monotonic() < self._hurries_until

    @property
    def is_presentable(self) -> bool:
        """Check whether there is something new to show."""
        return self.has_news and self.iterate is not None and not self.hurries

    def rest(self, is_seen: bool = True) -> float | None:
        """Seconds until the next piece of work.

        None waits for an order, or to be seen.
        """
        is_to_be_seen = self.is_dragged and (self.has_news or not is_seen)
        if (
            self.iterate is None
            or self.hurries
            or not (self._is_compared or is_to_be_seen)
        ):
            return 0.0
        if self.status is not None:
            return None
        return self.pacing.rest()

    def advance(self) -> None:
        """Do one piece of work."""
        if self.iterate is not None and not self._is_compared and not self.hurries:
            self._compare()
        else:
            self._iterate()

    def frame(self, needs: Needs) -> Frame:
        """Frame of the newest iterate."""
        self.has_news = False
        return self.sampler.frame(self.iterate, self.history, self.status, needs)

    def _iterate(self) -> None:
        iterate, decision = next(self._iterates)
        self.pacing.count(iterate.number)
        self.status = decision.status
        self.has_news = True
        if self.status is not None and self.status.ending is Ending.DIVERGED:
            return
        self.iterate = iterate
        self.history.append(record(iterate, decision, self._distance))

    def _compare(self) -> None:
        """Find the reference, and the errors of the iterate recorded before it."""
        problem = self.sampler.problem
        try:
            reference = self._references.of(self.settings, problem, self._interrupted)
        except Interrupted:
            return
        self._is_compared = self.has_news = True
        if reference is not None and reference.collapse is not None:
            self.sampler.collapse(reference.collapse)
            if self.status is None or self.status.ending is not Ending.CONVERGED:
                self.status = collapses(problem, reference.collapse)
            return
        self.sampler.complete(reference)
        if reference is not None:
            self._distance = distance = distance_to(reference, problem)
            self.history[-1] = replace(
                self.history[-1],
                error_displacement=distance.of_displacement(self.iterate),
                error_force=distance.of_friction_force(self.iterate),
            )
