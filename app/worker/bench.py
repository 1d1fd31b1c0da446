"""The executor of long reports: a process for each of them, one after the other."""

from __future__ import annotations

import atexit
import contextlib
import logging
import os
import shutil
import signal
import threading
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, Future
from functools import cache, partial
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

from app.worker.link import start
from app.worker.process import NICENESS

_log = logging.getLogger(__name__)

STOPPED = "Its process stopped unexpectedly; start it again."


class BrokenCallError(Exception):
    """There is no result; the message is a sentence for the user."""


class Call(Future[Any]):
    """One call, which `cancel` ends even while it runs.

    Attributes
    ----------
    process
        Where it is done; None before that has started.
    """

    def __init__(self, work: partial[Any]) -> None:
        super().__init__()
        self.process: BaseProcess | None = None
        self._work = work
        self._unwanted = False
        self._starting = threading.Lock()

    def cancel(self) -> bool:
        """Do not begin with it, or end its process at once; tell whether it was not begun."""
        if super().cancel():
            return True
        with self._starting:
            self._unwanted = True
            if self.process is not None:
                self.process.kill()
        return False

    def live(self) -> None:
        """Start the process, wait for what comes of it, and have the process end."""
        try:
            said = self._converse()
        except (OSError, EOFError):
            # The process is gone; or, where the fork server was gone, it has never been there.
            said = BrokenCallError(STOPPED)
        except Exception as problem:
            said = _broken(problem)
        if self.process is not None:
            self.process.kill()
            self.process.join()
        if isinstance(said, BrokenCallError):
            self.set_exception(said)
        else:
            self.set_result(said)

    def _converse(self) -> Any:
        started, ours = start(main, self._work)
        with self._starting:
            self.process = started
            if self._unwanted:
                started.kill()
        with ours:
            return ours.recv()


class Bench(Executor):
    """Calls in niced processes of their own, in the order in which they were asked for.

    Two at a time would spoil each other's measurements, and thirty the server. A
    `ProcessPoolExecutor` would not do: it cannot end a call that runs, if its process is killed it
    loses the calls that wait, and it keeps a server from stopping until its call is done.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._waiting: deque[Call] = deque()
        self._at_work: Call | None = None

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Call:
        """Have something done when its turn comes, which is at once if nothing else is at work.

        Parameters
        ----------
        fn, args, kwargs
            Picklable, and so is the result.
        """
        call = Call(partial(fn, *args, **kwargs))
        with self._lock:
            self._waiting.append(call)
        self._go_on()
        return call

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the call at work, and begin no other: nobody is there any more to read them."""
        with self._lock:
            calls = [*self._waiting, *([self._at_work] if self._at_work else [])]
        for call in calls:
            call.cancel()

    @property
    def pid(self) -> int | None:
        """Number of the process at work, if any."""
        call = self._at_work
        return call.process.pid if call and call.process else None

    def _go_on(self) -> None:
        with self._lock:
            while self._waiting and self._at_work is None:
                call = self._waiting.popleft()
                if call.set_running_or_notify_cancel():
                    self._at_work = call
                    threading.Thread(
                        target=self._do, args=(call,), name="report", daemon=True
                    ).start()

    def _do(self, call: Call) -> None:
        call.live()
        with self._lock:
            self._at_work = None
        self._go_on()


@cache
def shared_bench() -> Bench:
    """Give the executor that all pages of this server share; it ends with the server."""
    bench = Bench()
    atexit.register(bench.shutdown)
    return bench


def main(connection: Connection, work: partial[Any]) -> None:
    """Do a call in this process, and say what came of it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    folders = [given for given in work.args if isinstance(given, Path)]
    threading.Thread(target=_end_with, args=(connection, folders), daemon=True).start()
    try:
        said = work()
    except Exception as problem:
        said = _broken(problem)
    folders.clear()
    with contextlib.suppress(OSError):
        connection.send(said)


def _broken(problem: Exception) -> BrokenCallError:
    """Log where something broke, on either side of the pipe, and say it in a sentence."""
    _log.error("A report broke.", exc_info=problem)
    return BrokenCallError(f"It broke ({type(problem).__name__}: {problem}).")


def _end_with(connection: Connection, folders: Sequence[Path]) -> None:
    """End the process as soon as the server is gone, with its folders: nobody else would."""
    with contextlib.suppress(EOFError, OSError):
        connection.recv()
    for folder in folders:
        shutil.rmtree(folder, ignore_errors=True)
    os._exit(0)
