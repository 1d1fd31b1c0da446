"""A worker process: it obeys orders, and between them it works at its page's run.

A thread reads the orders, for three reasons: the end of the pipe ends the process whatever it is
at, a new run interrupts the one at work, and one that cannot be interrupted is given up.
"""

from __future__ import annotations

import _thread
import contextlib
import faulthandler
import os
import signal
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable
from functools import partial
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from app.wire.orders import Order, Run
from app.worker.page_runs import PageRuns

NICENESS = 5
"""Below the server, so that pages stay alive, but not by much: the first picture of a run waits for
this process, and beside a browser that paints on the same cores niceness 10 made it wait 0.1 s."""
POLITE = 0.05
"""Seconds that a run has to come to the end of a piece of work when the next is ordered."""
STUCK = 10.0
"""Seconds after which a run that cannot be interrupted for the next one is taken for stuck."""
LONGEST = 180.0
"""Seconds that one piece of work may take: beyond, nobody would wait for it."""


class InterruptedForNextError(BaseException):
    """Another run is ordered; no handler of the solver's may take this for an error of its own."""


def main(connection: Connection) -> None:
    """Serve orders until the server, or the page, is gone."""
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    faulthandler.enable()
    # A run that diverges is told by its status; the lines on stderr would help nobody.
    np.seterr(over="ignore", invalid="ignore", divide="ignore")
    with contextlib.suppress(OSError):
        serve(Inbox(connection), connection.send)


def serve(inbox: Inbox, send: Callable[[Any], None]) -> None:
    """Obey orders and work in between, without end."""
    runs = PageRuns(inbox.shielded(send), inbox.urgent)
    while True:
        order = inbox.take(runs.rest())
        if order is None and runs.paint():
            continue
        with contextlib.suppress(InterruptedForNextError):
            if order is None:
                inbox.attempt(runs.go_on)
            elif isinstance(order, Run):
                inbox.attempt(partial(runs.obey, order))
            else:
                # What is short is done whole: a page would wait for ever for a lost answer.
                runs.obey(order)


class Inbox:
    """Orders in the sequence in which they came.

    Parameters
    ----------
    connection
        Where they come from; the process ends when it does.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._orders: deque[Order] = deque()
        self._changed = threading.Condition()
        self._interruptible = False
        signal.signal(signal.SIGINT, self._interrupt)
        threading.Thread(target=self._read, name="orders", daemon=True).start()

    def take(self, timeout: float | None) -> Order | None:
        """Give the next order; None if there is none within this time, s."""
        faulthandler.cancel_dump_traceback_later()
        with self._changed:
            self._changed.wait_for(lambda: self._orders, timeout)
            return self._orders.popleft() if self._orders else None

    def urgent(self) -> bool:
        """Tell whether an order waits that ends the run at work."""
        return any(isinstance(order, Run) for order in list(self._orders))

    def attempt(self, action: Callable[[], None]) -> None:
        """Do a piece of work, which a new run interrupts and no more than the longest time ends.

        Raises
        ------
        InterruptedForNextError
            If another run came and the piece did not end soon.
        """
        faulthandler.dump_traceback_later(LONGEST, exit=True)
        self._interruptible = True
        try:
            action()
        finally:
            self._interruptible = False

    def shielded(self, action: Callable[[Any], None]) -> Callable[[Any], None]:
        """Give an action that no new run interrupts: half a report could not be read."""

        def act(argument: Any) -> None:
            before, self._interruptible = self._interruptible, False
            try:
                action(argument)
            finally:
                self._interruptible = before

        return act

    def _read(self) -> None:
        try:
            self._hear()
        except (EOFError, OSError):
            pass
        except BaseException:
            # Without memory, say: a process that is deaf is of no use to anybody.
            traceback.print_exc()
        os._exit(0)

    def _hear(self) -> None:
        urgent_since = 0.0
        while True:
            if self._connection.poll(POLITE if self.urgent() else None):
                order = self._connection.recv()
                with self._changed:
                    self._orders.append(order)
                    self._changed.notify()
            now = time.monotonic()
            urgent_since = (urgent_since or now) if self.urgent() else 0.0
            if urgent_since:
                self._hasten(now - urgent_since)

    def _hasten(self, waited: float) -> None:
        """Interrupt what is at work, or give up the process where it cannot be."""
        if waited > POLITE and self._interruptible:
            _thread.interrupt_main()
        if waited > STUCK:
            faulthandler.dump_traceback()
            os._exit(1)

    def _interrupt(self, number: int, frame: Any) -> None:
        if self._interruptible and self.urgent():
            self._interruptible = False
            raise InterruptedForNextError
