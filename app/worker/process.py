"""The worker process of a page, as the server sees it."""

from __future__ import annotations

import contextlib
import os
import threading
import time
from collections.abc import Callable
from multiprocessing import get_context
from queue import SimpleQueue
from typing import Any, ClassVar
from weakref import WeakSet

from app.messages import Order, Report
from app.worker.loop import main
from solver.study.sweep.executors import start_fork_server

PROCESSES = get_context("forkserver")
# Workers share the memory of these modules. The script that serves imports the second
# one, so each worker would import it, too; closed forms need the last.
PROCESSES.set_forkserver_preload(["app.worker.loop", "panel.command", "scipy.optimize"])
# A worker has one thread for linear algebra, as pages share the processors. The fork
# server inherits the variable.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
NICENESS = 5
NICEST = 19
"""Niceness of a worker that is alone, and of each beside fourteen others or more. The
server goes first: thirty workers at 5 would leave it a fifth of a processor. At 10 the
first picture of a worker that is alone waits 0.1 s longer."""
SILENT = 8.0
"""Time without a sign of life after which a process is taken to hang, s."""


class Worker:
    """A worker process, with a pipe for its orders and reports.

    `hear` is called on a thread of its own: with this worker and each report, and with
    None once the process has ended. The more `others` there are, the nicer the process
    is, as the server goes first; workers that were there before become as nice.
    """

    _running: ClassVar[WeakSet[Worker]] = WeakSet()

    def __init__(
        self, hear: Callable[[Worker, Report | None], None], others: int = 0
    ) -> None:
        self._hear: Callable[[Worker, Report | None], None] | None = hear
        self._connection, theirs = PROCESSES.Pipe()
        self._process: Any = PROCESSES.Process(target=main, args=(theirs,), daemon=True)
        start_fork_server()
        self._process.start()
        self._running.add(self)
        for worker in self._running:
            worker.give_way(others)
        # Else the pipe would outlive the process, as the server holds this end, too.
        theirs.close()
        self._heard = time.monotonic()
        self._orders: SimpleQueue[Order | None] = SimpleQueue()
        for work in (self._listen, self._speak):
            threading.Thread(target=work, daemon=True).start()

    @property
    def hangs(self) -> bool:
        """Check whether the process has given no sign of life for a long time."""
        return time.monotonic() - self._heard > SILENT

    def send(self, order: Order) -> None:
        """Send an order; orders to an ended process are lost.

        A process takes none while a long piece of work lasts, and once its pipe is full
        who writes into it waits: not the server, which all pages share.
        """
        self._orders.put(order)

    def give_way(self, others: int) -> None:
        """Lower the priority of the process in favour of others."""
        # Without a right of its own a process becomes no less nice again.
        wanted = min(niceness() + NICENESS + others, NICEST)
        if not self._process.is_alive():
            return
        with contextlib.suppress(ProcessLookupError):
            if niceness(self._process.pid) < wanted:
                os.setpriority(os.PRIO_PROCESS, self._process.pid, wanted)

    def end(self) -> None:
        """End the process immediately; later reports are dropped."""
        self._running.discard(self)
        self._hear = None
        self._orders.put(None)
        self._process.kill()
        self._process.join()
        self._connection.close()

    def _speak(self) -> None:
        """Write orders into the pipe, until the process has to end."""
        # A pipe that is closed has no handle: also a TypeError.
        with contextlib.suppress(OSError, TypeError):
            while (order := self._orders.get()) is not None:
                self._connection.send(order)

    def _listen(self) -> None:
        """Pass on reports until the pipe ends."""
        # A pipe that is closed while it is read from has no handle: a TypeError.
        with contextlib.suppress(EOFError, OSError, TypeError):
            while True:
                report: Report = self._connection.recv()
                self._heard = time.monotonic()
                if self._hear is not None:
                    self._hear(self, report)
        if self._hear is not None:
            self._hear(self, None)


def niceness(pid: int = 0) -> int:
    """Niceness of a process, by default of this one."""
    return os.getpriority(os.PRIO_PROCESS, pid)
