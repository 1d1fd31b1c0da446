"""What runs many calls at once: processes of this machine, or the workers of a Dask cluster.

`opened` gives an executor (PEP 3148) by a short text, with its `width` besides. A call that is
cancelled while it runs is ended with its process, where that is one of this machine.
"""

from __future__ import annotations

import contextlib
import os
import queue
import threading
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from solver.definitions import SettingError
from solver.running.calls import Call, ProcessSlot
from solver.running.machine import processors
from solver.running.pool import Pool

__all__ = ["FORMS", "VARIABLE", "Pool", "Processes", "executor_of_the_server", "opened"]
VARIABLE = "SLIPFRONT_EXECUTOR"
"""Of the environment: where a server's sweeps and reports run."""
FORMS = "processes, processes:COUNT, or dask://HOST:PORT"
DASK = "dask://"
MOST_PROCESSES = 256


class Processes(Pool):
    """Niced processes of this machine, each killed and replaced where a call takes too long.

    A `ProcessPoolExecutor` cannot end a call that runs, and loses all calls with one process.

    Parameters
    ----------
    count
        How many.
    limit
        Seconds that a call may take; without end if None.
    lasting
        Whether a process does one call after the other.
    """

    def __init__(self, count: int, limit: float | None = None, *, lasting: bool = True) -> None:
        self._limit, self._lasting = limit, lasting
        self._calls: queue.SimpleQueue[Call | None] = queue.SimpleQueue()
        self._at_work: set[Call] = set()
        self._is_over = self._ends_all = False
        self._threads = [
            threading.Thread(target=self._live, name="executor", daemon=True) for _ in range(count)
        ]
        for thread in self._threads:
            thread.start()

    @property
    def width(self) -> int:
        """Number of processes."""
        return len(self._threads)

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Call:
        """Have something done in the next process that is free.

        Parameters
        ----------
        fn, args, kwargs
            Picklable, and so is the result.
        """
        if self._is_over:
            raise RuntimeError("this executor is shut down")
        call = Call(partial(fn, *args, **kwargs))
        self._calls.put(call)
        return call

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Begin no other call; end those that run, too, if futures are to be cancelled."""
        self._is_over, self._ends_all = True, cancel_futures
        with contextlib.suppress(queue.Empty):
            while cancel_futures:
                call = self._calls.get_nowait()
                if call is not None:
                    call.cancel()
        for call in list(self._at_work) if cancel_futures else ():
            call.cancel()
        for _ in self._threads:
            self._calls.put(None)
        for thread in self._threads if wait else ():
            thread.join()

    def _live(self) -> None:
        """Do calls, one after the other, in a process that lasts as long as it is sound."""
        slot = ProcessSlot(self._limit)
        while (call := self._calls.get()) is not None:
            if call.set_running_or_notify_cancel():
                self._at_work.add(call)
                if self._ends_all:
                    call.cancel()
                try:
                    result = slot.do(call)
                except Exception as trouble:
                    call.set_exception(trouble)
                else:
                    call.set_result(result)
                self._at_work.discard(call)
                if not self._lasting:
                    slot.clear()
        slot.clear()


@contextlib.contextmanager
def opened(on: str, limit: float | None = None, *, lasting: bool = True) -> Iterator[Pool]:
    """Open the executor that a text names, and close it in the end with all that still runs.

    Parameters
    ----------
    on
        `processes`, `processes:COUNT`, or `dask://HOST:PORT`.
    limit
        Seconds that a call may take before its process is ended, on this machine; None: any.
    lasting
        Whether processes of this machine do one call after the other.

    Raises
    ------
    SettingError
        For a text that names none, or a cluster that cannot be reached.
    """
    pool = _open(on, limit, lasting)
    try:
        yield pool
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _open(on: str, limit: float | None, lasting: bool) -> Pool:
    kind, colon, rest = on.partition(":")
    if kind == "processes" and not colon:
        return Processes(processors(), limit, lasting=lasting)
    if kind == "processes" and rest.isdecimal() and 1 <= int(rest) <= MOST_PROCESSES:
        return Processes(int(rest), limit, lasting=lasting)
    if on.startswith(DASK) and len(on) > len(DASK):
        return _cluster(on)
    raise SettingError("--on", on, FORMS, f"name one, with at most {MOST_PROCESSES} processes")


def _cluster(on: str) -> Pool:
    try:
        from solver.running.cluster import Cluster
    except ModuleNotFoundError as missing:
        remedy = f"{missing.name} is not here: pip install 'slipfront[cluster]'"
        raise SettingError("--on", on, FORMS, remedy) from None
    return Cluster(on.removeprefix(DASK))


def executor_of_the_server() -> str:
    """Give the text that the environment names for a server's work, or nothing."""
    return os.environ.get(VARIABLE, "")
