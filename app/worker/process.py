"""A worker process: it reads orders from its pipe, and between them it works at its run.

Nothing runs beside this loop, so an order is obeyed as soon as the piece of work at hand is done;
an order that cannot wait for that is the pool's to enforce, by ending the process.
"""

from __future__ import annotations

import contextlib
import os
import signal
import traceback
from collections import deque
from collections.abc import Callable
from functools import partial
from multiprocessing.connection import Connection

import numpy as np

from app.worker.orders import Leave, Order, Pace, Park, Run, Seek, Step, Watch
from app.worker.previous import last_iterate
from app.worker.reports import Parked, Ready, Refused, Taken, Waiting
from app.worker.rivals import References
from app.worker.run import WorkerRun
from solver.definitions import SettingError

NICENESS = 2
"""Below the server, so that pages stay alive, but not by much: the first picture of a run waits for
this process, and beside a browser that paints on the same cores niceness 10 made it wait 0.1 s."""


def main(connection: Connection) -> None:
    """Serve orders until the order to leave, or until the server is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    # A run that diverges is told by its status; the lines on stderr would help nobody.
    np.seterr(over="ignore", invalid="ignore", divide="ignore")
    with contextlib.suppress(OSError):
        connection.send(Ready())
        Worker(connection).serve()


class Worker:
    """The run at work, if any, and the loop that serves it."""

    def __init__(self, connection: Connection) -> None:
        self._inbox = Inbox(connection)
        self._send = connection.send
        self._references = References()
        self._run: WorkerRun | None = None
        self._told_waiting = True

    def serve(self) -> None:
        """Obey orders and work in between, until the order to leave."""
        while True:
            rest = self._run.rest() if self._run else None
            if rest is None and self._run and not self._told_waiting:
                self._send(Waiting(self._run.ticket))
                self._told_waiting = True
            order = self._inbox.take(rest)
            if isinstance(order, Leave):
                return
            if order is not None:
                self._told_waiting = False
                self._obey(order)
            elif self._run is not None:
                self._attempt(self._run.ticket, self._run.advance)

    def _obey(self, order: Order) -> None:
        run = self._run
        match order:
            case Run():
                self._send(Taken(order.ticket))
                self._run = None
                self._attempt(order.ticket, partial(self._begin, order, run))
            case Park():
                self._attempt(order.ticket, partial(self._park, order))
            case Pace() | Step() | Seek() | Watch():
                if run is not None and run.ticket == order.ticket:
                    self._attempt(run.ticket, partial(run.obey, order))

    def _begin(self, order: Run, before: WorkerRun | None) -> None:
        previous = None
        if order.warm and before is not None and before.ticket == order.after:
            previous = before.last
        elif order.warm and order.previous is not None:
            previous = last_iterate(order.previous)
        self._run = WorkerRun(order, self._send, self._inbox.urgent, self._references, previous)

    def _park(self, order: Park) -> None:
        run = self._run
        if run is None or run.ticket != order.ticket:
            self._send(Parked(order.ticket, None))
            return
        self._send(run.parked() if order.keep else Parked(run.ticket, None))
        self._run = None

    def _attempt(self, ticket: int, action: Callable[[], None]) -> None:
        """Do something of a run; if it breaks, the run is over and the process lives on."""
        try:
            action()
        except Exception as problem:
            self._run = None
            told = isinstance(problem, SettingError | FloatingPointError)
            trace = "" if told else traceback.format_exc()
            self._send(Refused(ticket, _sentence(problem), trace))


class Inbox:
    """Orders in the sequence in which they came; the end of the pipe is an order to leave."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._orders: deque[Order] = deque()
        self._open = True

    def take(self, timeout: float | None) -> Order | None:
        """Give the next order; None if there is none within this time, s."""
        if not self._orders and self._connection.poll(timeout):
            self._read()
        return self._orders.popleft() if self._orders else None

    def urgent(self) -> bool:
        """Tell whether an order waits that ends the run at work."""
        while self._open and self._connection.poll():
            self._read()
        return any(isinstance(order, Run | Park | Leave) for order in self._orders)

    def _read(self) -> None:
        try:
            self._orders.append(self._connection.recv())
        except (EOFError, OSError):
            self._open = False
            self._orders.append(Leave())


def _sentence(problem: Exception) -> str:
    if isinstance(problem, SettingError | FloatingPointError):
        return str(problem)
    return (
        f"The run broke ({type(problem).__name__}: {problem}). Change a setting, or lower the "
        "numbers of elements and instants."
    )
