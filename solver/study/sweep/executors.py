"""Executors of parallel calls: processes of this machine, or a Dask cluster.

All are executors as of `concurrent.futures`. A call that is cancelled while it runs is
ended with its process, where the process is one of this machine.
"""

from __future__ import annotations

import logging
import multiprocessing
import os
import signal
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from multiprocessing import forkserver, resource_tracker
from multiprocessing.context import BaseContext
from multiprocessing.synchronize import RLock
from typing import Any

import numpy as np
import scipy
from threadpoolctl import threadpool_limits

from solver.settings.values import SettingError

LIMITS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
"""Variables that `python -m solver` sets to 1 before it imports NumPy.

A variable that the user has set is left alone."""
ONE_THREAD = dict.fromkeys(LIMITS, "1")
FORMS = "processes, processes:COUNT, or dask://HOST:PORT"
DASK = "dask://"
MOST_PROCESSES = 256
NICENESS = 10
"""Niceness of processes: below all that people wait for, such as a page's own runs."""
PATIENCE = 10.0
"""Seconds that a Dask scheduler has to answer."""
PRELOADED = ("solver.study.sweep.run", "pebble")
"""Modules that a fork server imports once for all processes."""

left_alone = ExitStack()
"""Callbacks of a process of `Processes` that ends because its parent is gone."""


def processors() -> int:
    """Number of processors that this process may use."""
    # A container or a user may have fewer processors than the machine.
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def machine() -> str:
    """Text on processors, BLAS threads and versions."""
    limits = {os.environ[name] for name in LIMITS if name in os.environ}
    threads = ", ".join(sorted(limits)) or "not limited"
    python = sys.version.split()[0]
    return (
        f"{processors()} processors; BLAS threads: {threads}; "
        f"Python {python}, NumPy {np.__version__}, SciPy {scipy.__version__}"
    )


class Processes(Executor):
    """Niced processes of this machine with one BLAS thread each.

    They end with this process. A process that is killed fails its call with
    `pebble.ProcessExpired`. If it had no call, all calls that wait fail with
    `BrokenProcessPool`, and can be submitted again.

    Parameters
    ----------
    count
        Number of processes.
    limit
        Time of a call, s, after which its process is ended and the call raises
        `TimeoutError`.
    n_calls
        Number of calls after which a process is replaced by a new one; 0 is never.
    """

    def __init__(
        self, count: int, limit: float | None = None, n_calls: int = 0
    ) -> None:
        # Here and not above: commands without processes do without asyncio.
        from pebble import ProcessPool

        self._limit = limit
        self._is_shut_down = False
        self._context = _LastingLocks(_context())
        self._started = partial(
            ProcessPool, count, n_calls, initializer=_begin, context=self._context
        )
        self._pool = self._started()

    def submit(
        self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any
    ) -> Future[Any]:
        """Submit a call, of picklable parts, to the next process that is free."""
        if not (self._pool.active or self._is_shut_down):
            # A pool is broken once a process is killed while none does a call.
            self._pool.stop()
            self._join()
            self._pool = self._started()
        return self._pool.schedule(fn, args, kwargs, timeout=self._limit)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Start no other call; with `cancel_futures` end the processes immediately."""
        self._is_shut_down = True
        if cancel_futures:
            self._pool.stop()
        else:
            self._pool.close()
        if wait:
            self._join()

    def _join(self) -> None:
        """Wait until all processes have ended, and unlink their locks."""
        self._pool.join()
        self._context.let_go()


class _LastingLocks:
    """Multiprocessing context that keeps locks until its processes have ended.

    A pool drops its locks, which unlinks them, before it ends its processes. One that
    has just been started, as in the place of one that was ended, would look for a lock
    that is gone, and print a traceback.
    """

    def __init__(self, context: Any) -> None:
        self.Pipe = context.Pipe
        self.Process = context.Process
        self.get_start_method = context.get_start_method
        self.RLock = self._lasting_lock
        self._make_lock = context.RLock
        self._locks: list[RLock] = []

    def _lasting_lock(self) -> RLock:
        """Make a lock, and keep it."""
        lock: RLock = self._make_lock()
        self._locks.append(lock)
        return lock

    def let_go(self) -> None:
        """Release all locks; unused ones are unlinked."""
        self._locks.clear()


def _context() -> BaseContext:
    """Multiprocessing context: a fork server where available."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([*PRELOADED])
    start_fork_server()
    return context


def start_fork_server() -> None:
    """Start the fork server of this process, unless it runs, immune to Ctrl-C.

    Ctrl-C reaches all processes of a terminal. The server and its processes inherit
    that they ignore it, also while they import: the process that asks for them ends
    them.
    """
    # The tracker runs before, since starting it later would unblock the signal here.
    resource_tracker.ensure_running()
    unblocked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        forkserver.ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, unblocked)


def _begin() -> None:
    """Prepare a process for its calls."""
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    threadpool_limits(1)
    # A parent that is killed cannot end its processes itself.
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """Wait for the end of the parent process, then end this process."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        left_alone.close()
        os._exit(0)


@contextmanager
def opened(on: str, limit: float | None = None, n_calls: int = 0) -> Iterator[Executor]:
    """Context with the executor named by a text; at its end all calls are ended.

    `limit` and `n_calls` are those of `Processes`; a cluster does not take them.

    Raises
    ------
    SettingError
        For a text that names none, or a cluster that cannot be reached.
    """
    count = check_name(on)
    if count is None:
        with _cluster(on.removeprefix(DASK)) as executor:
            yield executor
        return
    executor = Processes(count, limit, n_calls)
    try:
        yield executor
    finally:
        executor.shutdown(cancel_futures=True)


def check_name(on: str) -> int | None:
    """Check the name of an executor; return its number of processes, None for Dask.

    Raises
    ------
    SettingError
        For a text that names none.
    """
    if on.startswith(DASK) and on != DASK:
        return None
    kind, colon, rest = on.partition(":")
    # A colon without a number gives 0, which is refused below.
    if rest.isdecimal():
        count = int(rest)
    elif colon:
        count = 0
    else:
        count = processors()
    if kind == "processes" and 1 <= count <= MOST_PROCESSES:
        return count
    remedy = f"name one, with at most {MOST_PROCESSES} processes"
    raise SettingError("--on", on, FORMS, remedy)


@contextmanager
def _cluster(address: str) -> Iterator[Executor]:
    """Executor of a Dask scheduler, which repeats calls of lost workers."""
    try:
        from distributed import Client
    except ModuleNotFoundError as missing:
        remedy = f"{missing.name} is not here: pip install 'slipfront[cluster]'"
        raise SettingError("--on", DASK + address, FORMS, remedy) from None
    # The client logs a scheduler that is gone with its traceback; here it is a line.
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
    host, _, port = address.rpartition(":")
    try:
        # The socket comes first, since a client without a scheduler is never closed.
        socket.create_connection((host, int(port)), PATIENCE).close()
        client = Client(f"tcp://{address}", timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, OverflowError) as problem:
        answers = "the HOST:PORT of a Dask scheduler that answers"
        reason = f"{type(problem).__name__}: {problem}".splitlines()[0]
        raise SettingError("--on", DASK + address, answers, reason) from None
    try:
        # Equal calls are not one call: lost ones are submitted again.
        yield client.get_executor(pure=False)
    finally:
        # Closing fails in many ways where the scheduler is gone.
        with suppress(Exception):
            client.close()
