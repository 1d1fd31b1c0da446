"""A run in the worker process: pieces of work, their timing, and frames."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import replace

from app.frame import Frame
from app.messages import WHOLE, Needs, Start
from app.worker.references import LastAnswer, ReferenceCache, has_reference
from app.worker.sampling import Sampler
from solver.latin import (
    Decision,
    Ending,
    Iterate,
    Record,
    Status,
    judged,
    record,
)
from solver.latin.end.status import collapses
from solver.latin.end.status_step import Certificate, states_of_solution
from solver.latin.run_cost import RunCost, run_cost
from solver.reference.assembly import Interrupted, never
from solver.reference.distance import Distance, distance_to
from solver.reference.rules import States
from solver.reference.solution import Reference
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.study.scene_run import neighbour

HURRY = 0.1
"""Longest time for which a run that follows a dragged slider is not shown, s."""
WHOLE_LASTS = 3.0
FIRST = 0.25
"""Time of a search at the pace `WHOLE`, and time before its second iterate, s.
Intervals shrink by one ratio: the first iterates are seen one by one, and a hundred
iterations last as long as thirty."""
SOON = 0.1
"""Estimated time of a reference up to which the first picture waits for it, s."""
LATE = 0.1
"""Longest delay, s, that iterations make up for. Pictures are painted between them."""


class Pacing:
    """The pace of a run, as in `Start`, and the requested steps."""

    def __init__(self, pace: float, steps: int = 0) -> None:
        self._pace = pace
        self._steps = steps
        self._done = 0
        self._due = time.monotonic()

    def change(self, pace: float) -> None:
        """Set another pace."""
        self._pace = pace
        self._steps = 0
        self._due = min(self._due, time.monotonic() + self._interval())

    def step(self) -> None:
        """Allow one more iteration, then pause."""
        self._pace = 0.0
        self._steps += 1

    def count(self, number: int) -> None:
        """Count a finished iteration."""
        self._done = number
        self._steps = max(self._steps - 1, 0)
        # From the time when this iteration was due, so that delays do not add up.
        self._due = max(self._due, time.monotonic() - LATE) + self._interval()

    def rest(self) -> float | None:
        """Time until the next iteration is due, s; None: not without an order."""
        if self._steps:
            return 0.0
        if self._pace == 0.0:
            return None
        return max(self._due - time.monotonic(), 0.0)

    def _interval(self) -> float:
        """Time between two iterations, s."""
        if self._pace == WHOLE:
            return FIRST * float((1.0 - FIRST / WHOLE_LASTS) ** self._done)
        if 0.0 < self._pace < math.inf:
            return 1.0 / self._pace
        return 0.0


class Runner:
    """A run: first iteration, reference, then iterations when due.

    `interrupted` says that an order waits that ends the run, and `halted` that one is
    there that ends or halts it: a status step is then given up until the run continues.
    `before` are states of a similar run, from which one status step may find the
    answer; else the run begins as its method says.

    The run has a `sampler` of its problem, the newest `iterate`, a `history` with a
    record of each iterate, and at its end a `status`, with an `answer` if that is
    certified. `pacing` says when the next iteration is due, `has_news` whether anything
    changed since the last frame.

    A run does its first iteration, hurries on for a moment if a slider is dragged,
    finds the reference, and continues at the pace until its end.
    """

    def __init__(
        self,
        start: Start,
        references: ReferenceCache,
        interrupted: Callable[[], bool],
        halted: Callable[[], bool] = never,
        before: States | None = None,
    ) -> None:
        self._order = start
        self.settings = settings = start.settings
        self.is_dragged = start.is_dragged
        # What is made here counts as time of the method.
        began = time.perf_counter()
        problem = discretise(settings)
        # Both solvers need the problem: its time is part of either run time.
        self._making = time.perf_counter() - began
        self._method = method_of(settings)
        self.cost: RunCost = run_cost(
            problem,
            self._method,
            with_reference=has_reference(settings),
        )
        self._spent = time.perf_counter() - began
        self.sampler = Sampler(problem, settings, start.number)
        self.iterate: Iterate | None = None
        self.history: list[Record] = []
        self.status: Status | None = None
        self.answer: LastAnswer | None = None
        self._certificate: Certificate | None = None
        self.has_news = False
        self.pacing = Pacing(start.pace, start.steps)
        self._before = before
        self._is_near = False
        self._iterates: Iterator[tuple[Iterate, Decision]] | None = None
        self._decision: Decision | None = None
        self._references = references
        self._interrupted = interrupted
        self._halted = halted
        self._is_compared = False
        self._distance: Distance | None = None
        self._hurries_until = time.monotonic()
        if start.is_dragged:
            self._hurries_until += HURRY

    @property
    def hurries(self) -> bool:
        """Check whether the run continues before it is shown."""
        return self.status is None and time.monotonic() < self._hurries_until

    @property
    def is_presentable(self) -> bool:
        """Check whether there is a new iterate to show.

        The first one waits for a reference that is there soon. Without it nobody knows
        how far bodies move in the end: their picture would jump.
        """
        if self._is_to_compare(is_seen=False) and self.cost.reference < SOON:
            return False
        return self.has_news and self.iterate is not None and not self.hurries

    def rest(self, is_seen: bool = True) -> float | None:
        """Time until the next piece of work, s; None: not without an order."""
        if self.iterate is None or self.hurries:
            return 0.0
        if self._is_to_compare(is_seen):
            return 0.0
        if self.status is not None:
            return None
        return self.pacing.rest()

    def advance(self, is_seen: bool = True) -> None:
        """Do a piece of work: an iteration, or, after the first one, the reference."""
        if self._before is not None:
            self._start_near(self._before)
        elif self._is_to_compare(is_seen):
            self._compare()
        else:
            self._iterate()

    def _is_to_compare(self, is_seen: bool) -> bool:
        """Check whether the reference is due; `is_seen`: the picture is painted."""
        if self.iterate is None or self._is_compared or self.hurries:
            return False
        # That of a run that follows a slider waits until its picture is seen: the
        # slider may have moved on by then.
        return not self.is_dragged or (is_seen and not self.has_news)

    def frame(self, needs: Needs) -> Frame:
        """Frame of the newest iterate."""
        self.has_news = False
        frame = self.sampler.frame(
            self.iterate,
            self.history,
            self.status,
            needs,
            # Those on a run that follows a slider wait until its picture is seen.
            with_remarks=self._is_compared or not self.is_dragged,
        )
        return replace(frame, is_followed=self._is_near)

    def earlier(self, iteration: int, needs: Needs) -> Frame | None:
        """Frame of an earlier iteration; None if that is not stored."""
        iterate = self.sampler.past.numbered(iteration)
        if iterate is None:
            return None
        history = self.history[:iteration]
        return self.sampler.frame(iterate, history, None, needs)

    def _start_near(self, before: States) -> None:
        """Try to find the answer from the states of another run, once."""
        self._before = None
        began = time.perf_counter()
        near = neighbour(
            self.sampler.problem, self.settings, before, self._halted, self._spent
        )
        # What was tried in vain is time of the run all the same.
        self._spent += time.perf_counter() - began
        if near is not None:
            self._is_near = True
            self._take(*near)

    def _iterate(self) -> None:
        """Do an iteration, and record the iterate unless it diverged."""
        if self._iterates is None:
            self._iterates = judged(
                self.sampler.problem,
                self._method,
                spent=self._spent,
                interrupted=self._halted,
            )
        self._take(*next(self._iterates))

    def _take(self, iterate: Iterate, decision: Decision) -> None:
        """Take the next iterate, and the decision of the stop rules on it."""
        self.pacing.count(iterate.number)
        self.status = decision.status
        self.has_news = True
        if self.status is not None and self.status.ending is Ending.DIVERGED:
            # The iterate before stays, whose numbers can be drawn.
            return
        self.iterate = iterate
        self.sampler.keep(iterate)
        self._decision = decision
        # Indicators of an answer without a search wait until its picture is seen.
        self.history.append(
            record(iterate, decision, self._distance, watch=not self._is_near)
        )
        if self.status is not None and decision.certificate is not None:
            # Without the problem of the solution, which takes most memory.
            states = states_of_solution(decision.certificate.solution)
            self.answer = LastAnswer(self._order, states)
            if self.is_dragged:
                self._certificate = decision.certificate

    def _compare(self) -> None:
        """Find the reference, and the errors of the iterate before."""
        problem = self.sampler.problem
        # The certified solution of a run that follows a slider is its reference: the
        # incremental solver would find it once more, while the slider moves on.
        if self._certificate is not None:
            # It does not tell how long the incremental solver takes from nothing.
            timeless = replace(self._certificate.solution, seconds=math.nan)
            self._complete(timeless, self._certificate.distance)
            return
        try:
            reference = self._references.of(self.settings, problem, self._interrupted)
        except Interrupted:
            return
        if reference is None:
            self._complete(None, None)
        elif reference.collapse is None:
            whole = replace(reference, seconds=reference.seconds + self._making)
            self._complete(whole, distance_to(reference, problem))
        else:
            self._is_compared = self.has_news = True
            self.sampler.collapse(reference.collapse)
            # The answer of a run that has ended before its reference is there stands.
            if self.status is None or self.status.ending is not Ending.CONVERGED:
                self.status = collapses(problem, reference.collapse)

    def _complete(self, reference: Reference | None, distance: Distance | None) -> None:
        """Complete the run with a reference and the distance to it, or without."""
        self._is_compared = self.has_news = True
        self.sampler.complete(reference)
        self._distance = distance
        self.history[-1] = record(self.iterate, self._decision, distance)
