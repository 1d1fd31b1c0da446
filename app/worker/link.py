"""The worker process of a page as the server holds it: a thread each for orders and reports."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from queue import SimpleQueue

from app.wire.orders import Order
from app.wire.reports import Died, Report
from app.worker import process
from solver.running.processes import start_process

PRELOADED = ["numpy", "scipy.linalg", "scipy.sparse.linalg", "app.worker.process"]


class Link:
    """One worker process, from its start to its end.

    Parameters
    ----------
    listener
        Called with every report, on this link's own thread; the last is `Died`, unless the link
        was closed.
    """

    def __init__(self, listener: Callable[[Report], None]) -> None:
        self._listener: Callable[[Report], None] | None = listener
        self._orders: SimpleQueue[Order | None] = SimpleQueue()
        self._process: BaseProcess | None = None
        self._reader = threading.Thread(target=self._live, name="worker-reports", daemon=True)
        self._reader.start()

    @property
    def pid(self) -> int | None:
        """Number of the process, None until it has started."""
        return self._process.pid if self._process else None

    def send(self, order: Order) -> None:
        """Send an order, without ever waiting for the process."""
        self._orders.put(order)

    def close(self) -> None:
        """End the process at once, whatever it does; nothing more is reported."""
        self._listener = None
        if self._process is not None:
            self._process.kill()

    def join(self, timeout: float) -> None:
        """Wait until the process has ended."""
        self._reader.join(timeout)

    def _live(self) -> None:
        try:
            # The pipe ends with the process; where the fork server is gone, there is no process.
            with contextlib.suppress(EOFError, OSError):
                self._converse()
        finally:
            self._orders.put(None)
            if self._process is not None:
                self._process.kill()
                self._process.join()
            self._report(Died())

    def _converse(self) -> None:
        """Start the process, and take its reports until it has ended."""
        self._process, ours = start()
        if self._listener is None:
            return
        carry = threading.Thread(
            target=self._carry_orders, args=(ours,), name="worker-orders", daemon=True
        )
        carry.start()
        while True:
            self._report(ours.recv())

    def _report(self, report: Report) -> None:
        listener = self._listener
        if listener is not None:
            listener(report)

    def _carry_orders(self, connection: Connection) -> None:
        with contextlib.suppress(OSError):
            while (order := self._orders.get()) is not None:
                connection.send(order)


def warm_up() -> None:
    """Have the fork server import what workers need, before the first page waits for it."""
    worker, ours = start()
    ours.close()
    worker.join()


def start(
    main: Callable[..., None] = process.main, *arguments: object
) -> tuple[BaseProcess, Connection]:
    """Start a process of the page's server, as `start_process` does."""
    return start_process(main, *arguments, preloaded=PRELOADED)
