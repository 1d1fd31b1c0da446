"""A call, the process that does it, and what happens where either is given up."""

from __future__ import annotations

import contextlib
import os
import queue
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from functools import partial
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any

from solver.running.pool import EndedError, OverdueError
from solver.running.processes import start_process

NICENESS = 10
"""Below everything that somebody waits for, a page's own runs among them."""


class Call(Future[Any]):
    """One call, which `cancel` ends even while it runs."""

    def __init__(self, work: partial[Any]) -> None:
        super().__init__()
        self.work = work
        self.is_unwanted = False
        self._process: BaseProcess | None = None
        self._lock = threading.Lock()

    def cancel(self) -> bool:
        """Do not begin with it, or end its process at once; tell whether it was not begun."""
        if super().cancel():
            return True
        with self._lock:
            self.is_unwanted = True
            if self._process is not None:
                self._process.kill()
        return False

    @property
    def pid(self) -> int | None:
        """Number of the process where it runs, if it does."""
        return self._process.pid if self._process is not None else None

    def runs_in(self, process: BaseProcess | None) -> None:
        """Tell where it runs, or that it runs no longer."""
        with self._lock:
            self._process = process
            if process is not None and self.is_unwanted:
                process.kill()


class ProcessSlot:
    """One process at a time, started when it is needed."""

    def __init__(self, limit: float | None) -> None:
        self._limit = limit
        self._process: BaseProcess | None = None
        self._pipe: Connection | None = None

    def do(self, call: Call) -> Any:
        """Do a call.

        Raises
        ------
        EndedError
            If the process ended before it was done.
        """
        if self._process is None or self._pipe is None or not self._process.is_alive():
            self.clear()
            self._process, self._pipe = start_process(obey, preloaded=[call.work.func.__module__])
        call.runs_in(self._process)
        try:
            answer = self._asked(self._pipe, call.work)
            if answer is None or call.is_unwanted:
                self.clear()
        except BaseException:
            self.clear()
            raise
        finally:
            # Last, so that whoever sees that it runs nowhere knows that its process is gone.
            call.runs_in(None)
        if answer is None:
            raise EndedError("its process was ended")
        is_sound, found = answer
        if not is_sound:
            raise found
        return found

    def _asked(self, pipe: Connection, work: partial[Any]) -> tuple[bool, Any] | None:
        """Give what the process says to a call, or nothing if it has ended.

        What the pipe raises ends here: a call keeps its error, and with what was raised before it
        the frame and the buffer of the sender, which Python 3.13 complains of when it is cleared.
        """
        with contextlib.suppress(EOFError, OSError):
            pipe.send(work)
            if not pipe.poll(self._limit):
                raise OverdueError(f"it took longer than {self._limit:g} s")
            found: tuple[bool, Any] = pipe.recv()
            return found
        return None

    def clear(self) -> None:
        """End the process at once, if there is one."""
        if self._process is not None and self._pipe is not None:
            self._process.kill()
            self._process.join()
            self._pipe.close()
        self._process = self._pipe = None


def obey(connection: Connection) -> None:
    """Do calls in this process, until there is nobody any more who asks."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    asked: queue.SimpleQueue[partial[Any]] = queue.SimpleQueue()
    threading.Thread(target=_hear, args=(connection, asked), daemon=True).start()
    with contextlib.suppress(OSError):
        while True:
            work = asked.get()
            try:
                said = True, work()
            except Exception as trouble:
                said = False, trouble
            connection.send(said)


def _hear(connection: Connection, asked: queue.SimpleQueue[partial[Any]]) -> None:
    """Hear what is asked; end the process, whatever it is at, with whoever asks."""
    try:
        while True:
            asked.put(connection.recv())
    finally:
        for act in _farewells:
            act()
        os._exit(0)


_farewells: list[Callable[[], object]] = []


@contextlib.contextmanager
def when_deserted(act: Callable[[], object]) -> Iterator[None]:
    """Have a call's process do something, meanwhile, if it ends since nobody is there any more."""
    _farewells.append(act)
    try:
        yield
    finally:
        _farewells.remove(act)
