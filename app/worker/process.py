"""The worker process of a page, as the server sees it."""

from __future__ import annotations

import contextlib
import os
import threading
import time
from collections.abc import Callable
from multiprocessing import get_context
from typing import Any

from app.messages import Order, Report
from app.worker.loop import main

PROCESSES = get_context("forkserver")
# Workers share the memory of these modules; the script that serves imports the last,
# and so would each of them.
PROCESSES.set_forkserver_preload(["app.worker.loop", "panel.command"])
# One thread a worker: pages share the processors. The fork server inherits it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
SILENT = 8.0
"""Seconds without a sign of life after which a process is taken to hang."""


class Worker:
    """A worker process, with a pipe for its orders and reports.

    `hear` is called with this and each report, and with None once the process has
    ended, on a thread of its own. The more others there are, the nicer it is: the
    server goes before all.
    """

    def __init__(
        self, hear: Callable[[Worker, Report | None], None], others: int = 0
    ) -> None:
        self._hear: Callable[[Worker, Report | None], None] | None = hear
        self._connection, theirs = PROCESSES.Pipe()
        self._process: Any = PROCESSES.Process(
            target=main, args=(theirs, others), daemon=True
        )
        self._process.start()
        theirs.close()
        self._heard = time.monotonic()
        threading.Thread(target=self._listen, daemon=True).start()

    @property
    def hangs(self) -> bool:
        """Check whether the process has given no sign of life for long."""
        return time.monotonic() - self._heard > SILENT

    def send(self, order: Order) -> None:
        """Send an order, which a process that has ended ignores."""
        with contextlib.suppress(OSError):
            self._connection.send(order)

    def end(self) -> None:
        """End the process at once; its later reports are dropped."""
        self._hear = None
        self._process.kill()
        self._process.join()
        self._connection.close()

    def _listen(self) -> None:
        with contextlib.suppress(EOFError, OSError, TypeError):
            while True:
                report: Report = self._connection.recv()
                self._heard = time.monotonic()
                if self._hear is not None:
                    self._hear(self, report)
        if self._hear is not None:
            self._hear(self, None)
