"""A long job that a page has asked for: how far it is, and what came of those before."""

from __future__ import annotations

import threading
from collections import deque
from dataclasses import dataclass
from typing import Any

from app.worker.bench import Bench
from app.worker.job import Broke, Doing, Done, Job, Part, Said, Started, Work

KEPT = 6
WAITING, STARTING = "Waiting for what was asked for before", "Starting"


@dataclass(frozen=True, eq=False)
class Found:
    """A result with what it is called."""

    title: str
    result: Any


class Errand:
    """One kind of job of one page, at most one at a time; its results stay until the page closes.

    Messages arrive on another thread and wait in a mailbox for `collect`.

    Parameters
    ----------
    bench
        Where it is done.

    Attributes
    ----------
    title
        Of the job at work, or of the last one.
    doing, share
        What it does, and the share that is done.
    parts
        What it has found so far.
    found
        Results, oldest first.
    notice
        Why the last job brought no result, or empty.
    is_begun
        Whether the job is at work, and not only asked for.
    """

    def __init__(self, bench: Bench) -> None:
        self._bench = bench
        self._lock = threading.Lock()
        self._mailbox: deque[tuple[int, Said]] = deque()
        self._number = 0
        self._job: Job | None = None
        self.title = ""
        self.doing, self.share = "", 0.0
        self.parts: list[Any] = []
        self.found: deque[Found] = deque(maxlen=KEPT)
        self.notice = ""
        self.is_begun = False

    @property
    def is_busy(self) -> bool:
        """Whether a job is asked for or at work."""
        return self._job is not None

    @property
    def last(self) -> Found | None:
        """The result of the job before, if there is no newer one and that brought any."""
        return self.found[-1] if self.found and not self.is_busy and not self.notice else None

    def ask(self, title: str, work: Work) -> None:
        """Have a job done, unless one is at work."""
        if self._job is not None:
            return
        self._number += 1
        number = self._number
        self.title, self.parts, self.notice = title, [], ""
        self.doing = WAITING if self._bench.is_busy else STARTING
        self.share = 0.0

        def hear(said: Said) -> None:
            with self._lock:
                self._mailbox.append((number, said))

        self._job = self._bench.ask(work, hear)

    def cancel(self) -> None:
        """End the job; what it has found so far stays."""
        if self._job is not None:
            self._job.cancel()
            self._end("Cancelled.")

    def collect(self) -> bool:
        """Take the waiting messages; tell whether anything is new."""
        with self._lock:
            waiting = list(self._mailbox)
            self._mailbox.clear()
        for number, said in waiting:
            if number == self._number and self._job is not None:
                self._take(said)
        return bool(waiting)

    def _take(self, said: Said) -> None:
        match said:
            case Started():
                self.is_begun, self.doing = True, STARTING
            case Doing():
                self.doing, self.share = said.text, said.share
            case Part():
                self.parts.append(said.value)
            case Done():
                self.found.append(Found(self.title, said.result))
                self._end("")
            case Broke():
                self._end(said.reason)

    def _end(self, notice: str) -> None:
        self._job, self.is_begun, self.notice = None, False, notice
