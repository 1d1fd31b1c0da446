"""The bench: all pages of a server have their long jobs done here, one after the other.

Two of them at a time would spoil each other's measurements, and thirty the server.
"""

from __future__ import annotations

import atexit
import threading
from collections import deque
from collections.abc import Callable

from app.worker.job import Job, Said, Work


class Bench:
    """Jobs in the order in which they were asked for."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._queue: deque[Job] = deque()
        self._at_work: Job | None = None
        self._closed = False

    def ask(self, work: Work, listener: Callable[[Said], None]) -> Job:
        """Have a job done when its turn comes; its listener is as in `Job`."""
        job = Job(work, listener, self._ended)
        with self._lock:
            self._queue.append(job)
        self._go_on()
        return job

    @property
    def is_busy(self) -> bool:
        """Whether a job is at work, for which another one has to wait."""
        return self._at_work is not None

    @property
    def pid(self) -> int | None:
        """Number of the process at work, if any."""
        job = self._at_work
        return job.pid if job else None

    def close(self) -> None:
        """End the job at work; afterwards none begins."""
        with self._lock:
            self._closed = True
            job = self._at_work
        if job is not None:
            job.cancel()

    def _ended(self, job: Job) -> None:
        with self._lock:
            self._at_work = None
        self._go_on()

    def _go_on(self) -> None:
        with self._lock:
            if self._at_work is not None or self._closed:
                return
            while self._queue:
                job = self._queue.popleft()
                if not job.is_cancelled:
                    self._at_work = job
                    job.begin()
                    return


_shared: list[Bench] = []
_sharing = threading.Lock()


def shared_bench() -> Bench:
    """Give the bench that all sessions of this server share; it ends with the server."""
    with _sharing:
        if not _shared:
            _shared.append(Bench())
            atexit.register(_shared[0].close)
        return _shared[0]
