"""A run at work in a worker process: one thing at a time, so that orders are never kept waiting."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from typing import Literal

from app.picture.bases import sizes
from app.picture.recording import Recording
from app.picture.sampler import Frame, Sampler
from app.picture.shown import Look, has_reference
from app.wire.orders import Pace, Run, Seek, Step
from app.worker.full_stage_run import FullStageRun
from app.worker.rivals import KeptReferences
from app.worker.seeking import Found, Seeking
from app.worker.tempo import Tempo
from solver.latin import PGD, Checkpoint, Decision, Ending, Iterate, StopRules, record
from solver.latin.indicators import latin_indicator
from solver.latin.run_cost import run_cost
from solver.latin.warm import Start, choose_start, fits, iterations_from
from solver.reference.distance import Distance, distance_to
from solver.reference.solution import Interrupted, Reference
from solver.scenes import discretise
from solver.scenes.method import method_of

IN_A_HURRY = 0.1
"""Seconds that a run which follows a hand has to come to its end before it is shown."""


class WorkerRun:
    """One run, which does a small piece of work at each `advance` and obeys orders in between.

    The pieces are: the first iteration; the reference; an iteration that is sought; the next one.

    Parameters
    ----------
    order
        What to run.
    look
        Where one looks.
    urgent
        Tells whether an order waits that ends this run.
    references
        Shared by the runs of a process.
    previous
        The last iterate of the run before, if this one may start from it.

    Attributes
    ----------
    recording
        What is kept of it.
    has_news, cost
        Whether something has changed since this was last set to False; what it is to take.
    """

    def __init__(
        self,
        order: Run,
        look: Look,
        urgent: Callable[[], bool],
        references: KeptReferences,
        previous: Iterate | None = None,
    ) -> None:
        self.ticket, self.follows_hand = order.ticket, order.follows_hand
        self._urgent = urgent
        self._references = references
        self._settings = order.settings
        self._problem = discretise(self._settings)
        self._latin, most = method_of(self._settings), self._settings.max_iterations
        compared = has_reference(self._settings)
        self.cost = run_cost(self._problem, self._latin, most, with_reference=compared)
        self._sampler = Sampler(self._problem, self._settings, look)
        self.recording = Recording(
            order.ticket,
            self._settings,
            order.label,
            order.notice,
            self._sampler.stand(),
            is_warm=order.warm,
        )
        self.has_news = False
        self._rules = StopRules(self._latin)
        self._is_compared = False
        self._reference: Reference | None = None
        self._distance: Distance | None = None
        self._unmeasured: list[Iterate] = []
        self._before: Iterate | None = None
        self._start: Start | None = None
        self._previous = previous if fits(previous, self._problem) else None
        self._newest: Iterate | None = None
        self._answer: Iterate | None = None
        self._seeking = Seeking(self._iterations)
        self._sought: Found | None = None
        self._tempo = Tempo(order.pace, order.pause_after)
        self.is_held = order.is_held
        self._hurries_until = time.monotonic() + IN_A_HURRY if order.follows_hand else 0.0

    @property
    def last(self) -> Iterate | None:
        """The last iterate, or before there is any, the one that this run may start from."""
        return self._newest or self._previous

    @property
    def is_presentable(self) -> bool:
        """Whether there is an iterate to show, and the run does not hurry to a better one."""
        hurries = self.recording.status is None and time.monotonic() < self._hurries_until
        return self._newest is not None and not hurries

    @property
    def state(self) -> Literal["running", "paused", "held", "by hand"]:
        """What it does, for the status line."""
        if self.follows_hand:
            return "by hand"
        if self.is_held:
            return "held"
        return "running" if self.rest() is not None else "paused"

    @property
    def sought(self) -> int | None:
        """The iteration that is shown in place of the newest."""
        return self._sought[0].number if self._sought else None

    @property
    def seeks(self) -> int | None:
        """The iteration that is on its way to be shown in place of the newest."""
        return self._seeking.wanted

    @property
    def at(self) -> int:
        """The iteration that is shown; 0 before there is one."""
        return self.sought or (self._newest.number if self._newest else 0)

    @property
    def is_compared(self) -> bool:
        """Whether the first iteration is done, and what is compared with is found."""
        return self._is_compared

    def rest(self) -> float | None:
        """Give the seconds until `advance` has something to do; None waits for an order."""
        if self._newest is None or not self._is_compared or self._seeking.wanted is not None:
            return 0.0
        return self._rest_of_iterations(self._newest.number)

    def advance(self) -> None:
        """Do the next piece of work, if any is due."""
        if self._newest is None:
            self._open()
        elif not self.is_presentable:
            self._iterate(self._newest)
        elif not self._is_compared:
            self._compare(self._newest)
        elif self._seeking.wanted is not None:
            self._seek_on()
        elif self._rest_of_iterations(self._newest.number) == 0.0:
            self._iterate(self._newest)

    def obey(self, order: Pace | Step | Seek) -> None:
        """Follow an order."""
        self.has_news = True
        match order:
            case Pace():
                self._tempo.change(order.pace, self.recording.iteration)
                self.is_held = order.is_held
            case Step(count=int(count)):
                self._follow()
                self._tempo.step(count)
            case Seek(iteration=None):
                self._follow()
            case Seek(iteration=int(wanted)):
                self._seek(wanted)

    def look_at(self, look: Look) -> None:
        """Look elsewhere: another interface has other fields to stand on."""
        self.has_news = True
        if look.interface in ("", self._sampler.interface):
            return
        self._sampler = Sampler(self._problem, self._settings, look)
        self.recording.stand = self._sampler.stand()
        if self._is_compared:
            self._show_known()

    def frame(self, look: Look) -> Frame:
        """Show the iterate that is looked at."""
        assert self._newest is not None
        iterate, before = self._sought or (self._newest, self._before)
        waits = self._sought is not None or (self.recording.status is None and self._tempo.is_slow)
        return self._sampler.frame(iterate, look, before, is_slow=waits)

    def keep_frame(self, look: Look) -> Frame:
        """Keep the fields that are looked at, for others to be compared with; give all of them."""
        frame = self.frame(look)
        self.recording.frame, self.recording.shown = frame.fields, frame.iteration
        return frame

    def _open(self) -> None:
        """Do the first iteration, from the start that is better: its picture comes first."""
        problem = self._problem
        if self._previous is None:
            self._generator = self._iterations(None)
        else:
            self._start, self._generator = choose_start(problem, self._latin, self._previous)
            self._previous = None
        self.recording.choice = self._start.choice if self._start else None
        on_modes = isinstance(self._latin.linear, PGD)
        self._full_stage = FullStageRun(problem, self._settings, self._start) if on_modes else None
        newest = next(self._generator)
        if not math.isfinite(latin_indicator(newest)):
            raise FloatingPointError(
                "Numbers stopped being finite at the first iteration; bring k_scale nearer to 1, "
                "and the loads to ordinary sizes."
            )
        self._newest = newest
        self.has_news = True
        if self.follows_hand:
            self._account(newest, newest)

    def _iterations(self, checkpoint: Checkpoint | None) -> Iterator[Iterate]:
        return iterations_from(self._problem, self._latin, self._start, checkpoint)

    def _compare(self, newest: Iterate) -> None:
        """Find the reference and the closed form, which take longer than the first iteration."""
        try:
            self._reference = self._references.of(self._settings, self._problem, self._urgent)
        except Interrupted:
            return
        self._is_compared = True
        if self._reference is not None:
            self._distance = distance_to(self._reference, self._problem)
            self.recording.measure(self._unmeasured, self._distance)
        self._unmeasured.clear()
        self._show_known()
        if not self.recording.iteration:
            self._account(newest, newest)
        self.has_news = True

    def _show_known(self) -> None:
        self.recording.stand = self._sampler.completed(self.recording.stand, self._reference)
        if self._reference is not None:
            self.recording.reference = self._sampler.reference(self._reference)
            self.recording.reference_seconds = self._reference.seconds

    def _iterate(self, newest: Iterate) -> None:
        self._tempo.count(newest.number)
        if self._answer is not None:
            self._take(newest, self._answer, self._rules.close(self._answer))
        else:
            self._account(newest, next(self._generator))

    def _account(self, newest: Iterate, iterate: Iterate) -> None:
        """Record and judge an iterate; one that is not finite does not become the newest."""
        verdict = self._rules.judge(iterate)
        if (status := verdict.status) is not None and status.ending is Ending.DIVERGED:
            self.recording.status, self.has_news = status, True
            return
        newest = self._take(newest, iterate, verdict)
        self._seeking.keep(iterate.checkpoint)
        if (finished := verdict.finished) and finished.is_answer and not self.follows_hand:
            # The last iterate is shown before it.
            self._answer = finished
        elif finished is not None:
            self._take(newest, finished, self._rules.close(finished))

    def _take(self, newest: Iterate, iterate: Iterate, verdict: Decision) -> Iterate:
        """Record an iterate, which becomes the newest."""
        self.recording.status, self.has_news = verdict.status, True
        if iterate is not newest:
            self._before = newest
        self._newest = iterate
        if not self._is_compared:
            self._unmeasured.append(iterate)
        full = self._full_stage
        more = full.follow(iterate.number, self._distance) if full else ()
        entry = record(iterate, verdict, self._distance)
        self.recording.add(entry, sizes(entry), more)
        return iterate

    def _seek(self, iteration: int) -> None:
        newest = self._newest
        if newest is None:
            return
        wanted = min(max(iteration, 1), newest.number)
        if wanted == newest.number:
            self._seeking.stop()
            self._sought = newest, self._before
        else:
            self._seeking.begin(wanted)

    def _seek_on(self) -> None:
        found = self._seeking.go_on()
        if found is not None:
            self._sought, self.has_news = found, True

    def _follow(self) -> None:
        self._seeking.stop()
        self._sought = None

    def _rest_of_iterations(self, done: int) -> float | None:
        return None if self.recording.status is not None else self._tempo.rest(done)
