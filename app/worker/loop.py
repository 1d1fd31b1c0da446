"""The worker process: takes orders of its page, and runs iterations in between."""

from __future__ import annotations

import contextlib
import signal
import threading
import time
from collections import deque
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from app import messages
from app.messages import Needs, Order, Ready, Report, Start
from app.worker.references import LastAnswer, ReferenceCache
from app.worker.runner import Runner
from solver.refusal import RefusedError

LONG = 60.0
LARGE = 2e9
"""Estimated time, s, and memory, bytes, above which a run waits to be agreed to."""
PAUSE = messages.Pace(0.0)
HEARTBEAT = 2.0
"""Time between two signs of life, s."""


def main(connection: Connection) -> None:
    """Process orders until the server or the page has ended."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # The status of a run says that it diverges: NumPy need not warn of it, too.
    np.seterr(over="ignore", invalid="ignore", divide="ignore")
    with contextlib.suppress(OSError, EOFError):
        WorkerLoop(connection).serve()


class WorkerLoop:
    """Loop of a worker: processes orders, advances one run, sends reports.

    It waits for orders without end while there is no run, or the run has nothing to do.
    Between pieces of work it takes all orders that have come. A frame is sent when the
    page is ready for it: `Ready` says so, and the frame that is sent takes it back.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._sending = threading.Lock()
        self._orders: deque[Order] = deque()
        self._references = ReferenceCache()
        self._last: LastAnswer | None = None
        self._runner: Runner | None = None
        self._number = 0
        self._needs = Needs()
        self._asked: int | None = None
        self._is_ready = True
        threading.Thread(target=self._beat, daemon=True).start()

    def serve(self) -> None:
        """Process orders, and work in between, endlessly."""
        while True:
            # Orders may have come while the last piece of work lasted.
            timeout: float | None = 0.0
            if not self._orders:
                timeout = self._rest()
            self._receive(timeout)
            while self._orders:
                self._guard(self._obey, self._orders.popleft())
            if self._runner is not None:
                self._guard(self._work, self._runner)

    def _work(self, runner: Runner) -> None:
        """Do the next piece of work if due, and send a frame if requested."""
        if self._asked is not None:
            earlier = runner.earlier(self._asked, self._needs)
            self._asked = None
            if earlier is not None:
                self._send(messages.Earlier(earlier))
        if runner.rest(self._is_ready) == 0.0:
            runner.advance(self._is_ready)
            if runner.answer is not None:
                self._last = runner.answer
        if self._is_ready and runner.is_presentable:
            self._is_ready = False
            self._send(messages.NewFrame(runner.frame(self._needs)))

    def _rest(self) -> float | None:
        """Time to wait for an order, s; None: unlimited."""
        runner = self._runner
        if runner is None:
            return None
        if self._is_ready and runner.is_presentable:
            return 0.0
        return runner.rest(self._is_ready)

    def _obey(self, order: Order) -> None:
        """Carry out an order; without a run only orders of a run and of needs count."""
        runner = self._runner
        match order:
            case Start():
                self._begin(order)
            case Ready():
                self._is_ready = True
            case Needs():
                self._needs = order
                if runner is not None and runner.iterate is not None:
                    runner.has_news = True
            case messages.Pace(pace) if runner is not None:
                runner.pacing.change(pace)
                runner.has_news = runner.iterate is not None
            case messages.Step() if runner is not None:
                runner.pacing.step()
            case messages.Show(iteration):
                self._asked = iteration

    def _begin(self, start: Start) -> None:
        """Begin a run; ask first if it needs much time or memory."""
        # At once, as the supervisor ends a worker that does not take up a run in time.
        self._send(messages.Began(start.number))
        self._number = start.number
        self._runner = None
        self._asked = None
        before = None
        if self._last is not None:
            before = self._last.start_of(start, self._needs)
        runner = Runner(
            start, self._references, self._is_superseded, self._is_halted, before
        )
        cost = runner.cost
        is_costly = cost.seconds > LONG or cost.memory > LARGE
        if is_costly and not start.is_agreed:
            self._send(messages.Costly(start.number, str(cost)))
        else:
            self._runner = runner

    def _guard(self, action: Callable[[Any], None], argument: Any) -> None:
        """Call an action; report an error, which ends the run."""
        try:
            action(argument)
        except RefusedError as refusal:
            self._fail(refusal)
        except FloatingPointError as problem:
            self._fail(str(problem))
        except (OSError, EOFError):
            # The pipe is gone, and with it the page.
            raise
        except Exception as problem:  # a page outlives a fault of the engine
            self._fail(
                f"The run broke ({type(problem).__name__}: {problem}). Change a "
                "setting, or lower the numbers of elements and instants."
            )

    def _fail(self, problem: str | RefusedError) -> None:
        self._runner = None
        self._send(messages.Failed(self._number, problem))

    def _is_superseded(self) -> bool:
        """Check whether another run is ordered."""
        self._receive(0.0)
        return any(isinstance(order, Start) for order in self._orders)

    def _is_halted(self) -> bool:
        """Check whether another run is ordered, or this one has to pause."""
        self._receive(0.0)
        return any(isinstance(order, Start) or order == PAUSE for order in self._orders)

    def _receive(self, timeout: float | None) -> None:
        """Receive the orders that have arrived; of several runs the last counts."""
        while self._connection.poll(timeout):
            order = self._connection.recv()
            if isinstance(order, Start):
                # Orders for the run before, such as its pace, mean nothing to this one.
                kept = [
                    each for each in self._orders if isinstance(each, Ready | Needs)
                ]
                self._orders = deque(kept)
            self._orders.append(order)
            timeout = 0.0

    def _send(self, report: Report) -> None:
        # Two threads send: parts of their messages must not mix in the pipe.
        with self._sending:
            self._connection.send(report)

    def _beat(self) -> None:
        """Send signs of life, also during a long piece of work."""
        with contextlib.suppress(OSError):
            while True:
                self._send(messages.Alive())
                time.sleep(HEARTBEAT)
