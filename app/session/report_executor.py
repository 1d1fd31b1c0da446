"""The executor of long reports: those of all pages of a server are made one after the other."""

from __future__ import annotations

import atexit
import logging
import shutil
import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future
from contextlib import ExitStack
from functools import cache, partial
from pathlib import Path
from typing import Any

from app.session.studies import Work
from solver.running.calls import when_deserted
from solver.running.executors import Processes, executor_of_the_server, opened
from solver.running.pool import EndedError

_log = logging.getLogger(__name__)

LOCAL = "processes:1"
"""Two at a time would spoil each other's measurements, and thirty the server."""
STOPPED = "Its process stopped unexpectedly; start it again."


class BrokenReportError(Exception):
    """There is no report; the message is a sentence for the user."""


class ReportExecutor(Executor):
    """A process for every call, in the order in which they were asked for; or the server's cluster.

    What executes is opened when there is first something to do.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._stack = ExitStack()
        self._pool: Executor | None = None

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Have something done when its turn comes, which is at once if nothing else is at work.

        Parameters
        ----------
        fn, args, kwargs
            Picklable, and so is the result.

        Raises
        ------
        SettingError
            If the setting of the server names no executor.
        """
        with self._lock:
            if self._pool is None:
                on = executor_of_the_server()
                on = on if on and not on.startswith("processes") else LOCAL
                self._pool = self._stack.enter_context(opened(on, lasting=False))
        return self._pool.submit(fn, *args, **kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the call at work, and begin no other: nobody is there any more to read them."""
        self._stack.close()

    @property
    def pid(self) -> int | None:
        """Number of the process at work, if any is at work here."""
        pool = self._pool
        return next(iter(pool.pids), None) if isinstance(pool, Processes) else None


@cache
def shared_executor() -> ReportExecutor:
    """Give the executor that all pages of this server share; it ends with the server."""
    executor = ReportExecutor()
    atexit.register(executor.shutdown)
    return executor


def report(work: Work, folder: Path) -> None:
    """Make a report in its folder, which goes with this process if the server is gone.

    Raises
    ------
    BrokenReportError
        If it breaks, which is logged here.
    """
    with when_deserted(partial(shutil.rmtree, folder, ignore_errors=True)):
        try:
            work(folder)
        except Exception as problem:
            _log.exception("A report broke.")
            raise BrokenReportError(said_of(problem)) from None


def said_of(problem: BaseException) -> str:
    """Say in a sentence why there is no report."""
    if isinstance(problem, BrokenReportError):
        return str(problem)
    if isinstance(problem, EndedError | EOFError | OSError):
        return STOPPED
    return f"It broke ({type(problem).__name__}: {problem})."
