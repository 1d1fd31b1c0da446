"""A run at work in a worker process: one thing at a time, so that orders are never kept waiting."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from app.worker.beside import Beside, beside
from app.worker.orders import Look, Pace, Run, Seek, Step, Watch
from app.worker.outbox import Outbox
from app.worker.reports import Begun, End, Frame, Report, Unrivalled
from app.worker.rivals import References
from app.worker.sampler import Sampler
from app.worker.seeking import Seeking
from app.worker.tempo import Tempo
from solver.discrete import Problem, discretise
from solver.files import scene_settings
from solver.latin import Checkpoint, Ending, Iterate, Status, StopRules, Verdict, record
from solver.latin.indicators import latin_indicator
from solver.latin.warm import Start, choose_start, iterations_from
from solver.reference import incremental
from solver.reference.distance import Distance, distance_to
from solver.reference.incremental import Interrupted


class WorkerRun:
    """One run, which does a small piece of work at each `advance` and obeys orders in between.

    The pieces are: the first iteration and its frame; the reference; an iteration that is sought;
    a frame that is due; the next iteration.

    Parameters
    ----------
    order
        What to run.
    send
        Takes reports.
    urgent
        Tells whether an order waits that ends this run.
    references
        Shared by the runs of a process.
    previous
        The last iterate of the run before, if this one may start from it.

    Raises
    ------
    SettingError
        For a value that is refused.
    """

    def __init__(
        self,
        order: Run,
        send: Callable[[Report], None],
        urgent: Callable[[], bool],
        references: References,
        previous: Iterate | None = None,
    ) -> None:
        self.ticket = order.ticket
        self._send = send
        self._urgent = urgent
        self._references = references
        self._settings = scene_settings(order.scene).checked(order.values)
        self._problem = discretise(self._settings)
        self._look = order.look
        self._sampler = Sampler(self._problem, self._settings, self._look)
        self._rules = StopRules(self._settings)
        self._status: Status | None = None
        self._compared = False
        self._reference: incremental.Reference | None = None
        self._distance: Distance | None = None
        self._before: Checkpoint | None = None
        self._start: Start | None = None
        self._previous = previous if fits(previous, self._problem) else None
        self._newest: Iterate | None = None
        self._seeking = Seeking(self._iterations)
        self._outbox = Outbox(order.ticket, send)
        self._tempo = Tempo(order.pace, order.pause_after)
        self._watch = order.watch
        self._substructure = order.substructure
        self._beside: Beside | None = None

    @property
    def last(self) -> Iterate | None:
        """The last iterate, or before there is any, the one that this run may start from."""
        return self._newest or self._previous

    def rest(self) -> float | None:
        """Give the seconds until `advance` has something to do; None waits for an order."""
        if self._newest is None or not self._compared or self._seeking.wanted is not None:
            return 0.0
        rests = (self._rest_of_iterations(self._newest.number), self._outbox.rest())
        return min((rest for rest in rests if rest is not None), default=None)

    def advance(self) -> None:
        """Do the next piece of work, if any is due."""
        if self._newest is None:
            self._open()
        elif not self._compared:
            self._compare(self._newest)
        elif self._seeking.wanted is not None:
            self._seek_on()
        elif self._outbox.rest() == 0.0:
            self._publish()
        elif self._is_due():
            self._iterate(self._newest)

    def obey(self, order: Pace | Step | Seek | Watch) -> None:
        """Follow an order."""
        match order:
            case Pace():
                self._tempo.change(order.pace)
            case Step():
                self._tempo.step()
            case Seek():
                self._seek(order.iteration)
            case Watch():
                self._watch, self._substructure = order.watch, order.substructure
                self._look_at(order.look)

    def _open(self) -> None:
        """Do the first iteration and show it: the picture comes first."""
        newest = self._first()
        if not math.isfinite(latin_indicator(newest)):
            raise FloatingPointError(
                "Numbers stopped being finite at the first iteration; bring k_scale and the loads "
                "nearer to 1."
            )
        self._newest = newest
        self._send(self._begun())
        self._send(self._frame(newest, self._before))

    def _first(self) -> Iterate:
        """Give the first iterate, from the start that is better."""
        problem, settings = self._problem, self._settings
        if self._previous is None:
            self._generator = self._iterations(None)
        else:
            self._start, self._generator = choose_start(problem, settings, self._previous)
            self._previous = None
        self._beside = beside(problem, settings, self._start)
        return next(self._generator)

    def _iterations(self, checkpoint: Checkpoint | None) -> Iterator[Iterate]:
        return iterations_from(self._problem, self._settings, self._start, checkpoint)

    def _begun(self) -> Begun:
        choice = self._start.choice if self._start else None
        return replace(self._sampler.begun(self.ticket), start=choice)

    def _compare(self, newest: Iterate) -> None:
        try:
            found = self._references.of(self._settings, self._problem, self._urgent)
        except Interrupted:
            return
        # The closed form takes longer than the first iteration, so it comes after the picture.
        self._send(self._sampler.completed(self._begun()))
        self._refer(found)
        self._account(newest, newest)
        self._publish()

    def _refer(self, found: incremental.Reference | None) -> None:
        self._compared = True
        self._reference = found
        if found is not None:
            self._distance = distance_to(found, self._problem)
        self._show_reference()

    def _show_reference(self) -> None:
        found = self._reference
        self._send(
            Unrivalled(self.ticket)
            if found is None
            else self._sampler.reference(self.ticket, found)
        )

    def _look_at(self, look: Look) -> None:
        """Look elsewhere: show what another interface stands on before its fields."""
        self._look = look
        if self._newest is None:
            self._sampler = Sampler(self._problem, self._settings, look)
            return
        if look.interface not in ("", self._sampler.interface):
            self._sampler = Sampler(self._problem, self._settings, look)
            begun = self._begun()
            self._send(self._sampler.completed(begun) if self._compared else begun)
            if self._compared:
                self._show_reference()
        self._send(self._frame(self._newest, self._before))

    def _iterate(self, newest: Iterate) -> None:
        self._tempo.count()
        self._account(newest, next(self._generator))

    def _account(self, newest: Iterate, iterate: Iterate) -> None:
        """Record and judge an iterate; one that is not finite does not become the newest."""
        verdict = self._rules.judge(iterate)
        self._status = verdict.status
        if self._status is None or self._status.ending is not Ending.DIVERGED:
            newest = self._take(newest, iterate, verdict)
            self._seeking.keep(iterate.checkpoint)
            if verdict.finished is not None:
                verdict, finished = self._rules.close(verdict.finished), verdict.finished
                self._status = verdict.status
                newest = self._take(newest, finished, verdict)
        if self._rest_of_iterations(newest.number) is None:
            self._publish()
        if self._status is not None:
            self._send(End(self.ticket, self._status, newest.number))

    def _take(self, newest: Iterate, iterate: Iterate, verdict: Verdict) -> Iterate:
        """Record an iterate, which becomes the newest."""
        if iterate is not newest:
            self._before = newest.checkpoint
            self._outbox.owe_frame()
        self._newest = iterate
        beside = self._beside
        more = beside.follow(iterate.number, self._distance) if beside else ()
        self._outbox.add(record(iterate, verdict, self._distance), more)
        return iterate

    def _seek(self, iteration: int) -> None:
        newest = self._newest
        if newest is None:
            return
        wanted = min(max(iteration, 1), newest.number)
        if wanted == newest.number:
            self._seeking.stop()
            self._send(self._frame(newest, self._before, sought=True))
        else:
            self._seeking.begin(wanted)

    def _seek_on(self) -> None:
        found = self._seeking.go_on()
        if found is not None:
            self._send(self._frame(*found, sought=True))

    def _publish(self) -> None:
        newest = self._newest
        if newest is not None:
            self._outbox.publish(lambda: self._frame(newest, self._before))

    def _frame(self, iterate: Iterate, before: Checkpoint | None, *, sought: bool = False) -> Frame:
        return self._sampler.frame(
            self.ticket,
            iterate,
            self._watch,
            self._look,
            sought=sought,
            before=before,
            substructure=self._substructure,
        )

    def _is_due(self) -> bool:
        return self._newest is not None and self._rest_of_iterations(self._newest.number) == 0.0

    def _rest_of_iterations(self, done: int) -> float | None:
        return None if self._status is not None else self._tempo.rest(done)


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
