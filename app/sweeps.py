"""Sweeps of the server's pages: each on a thread of its own, on its share of the executor."""

from __future__ import annotations

import logging
import math
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from solver.definitions import SettingError
from solver.running.executors import executor_of_the_server, opened
from solver.running.machine import processors
from solver.running.pool import Pool
from solver.study.sweep import Plan, Row, VersionsDifferError, patience, sweep

log = logging.getLogger(__name__)
LIMIT = 60.0
"""Seconds that a run may take: nobody waits longer in front of a page for a point of a chart."""
PROCESSES = "processes"
OFTEN = 0.5
"""Seconds between two changes of a chart, each of which takes the server 0.1 s."""
_lock = threading.Lock()
_users = 0


def share_of(executor: str, users: int) -> str:
    """What each of so many users has of an executor: of a cluster, which has a queue, all.

    A queue for all would have everybody wait for the longest run of anybody. Where no number is
    named, one processor is left to the pages, but of two none: the processes are niced.
    """
    kind, _, count = executor.partition(":")
    if kind != PROCESSES or (count and not count.isdecimal()) or count == "0":
        return executor
    width = int(count) if count else max(processors() - 1, min(processors(), 2))
    return f"{PROCESSES}:{max(1, width // users)}"


@contextmanager
def shared() -> Iterator[Pool]:
    """A share of the server's executor.

    Raises
    ------
    SettingError
        If the setting of the server names none.
    """
    global _users
    with _lock:
        _users += 1
        executor = share_of(executor_of_the_server() or PROCESSES, _users)
    try:
        with opened(executor, patience(LIMIT)) as pool:
            yield pool
    finally:
        with _lock:
            _users -= 1


class Sweep:
    """Runs of a plan, from its making to their end.

    Parameters
    ----------
    plan
        What is run.
    changed
        Called on a thread when rows have come, not too often, and at the end.

    Attributes
    ----------
    rows
        Those that have come.
    message
        Why it came to nothing, or empty.
    is_over
        Whether nothing more comes.
    """

    def __init__(self, plan: Plan, changed: Callable[[], object]) -> None:
        self.plan, self._changed = plan, changed
        self.rows: list[Row] = []
        self.message = ""
        self.is_over = False
        self._is_cancelled = threading.Event()
        self._began = self._told = time.monotonic()
        self._count = 0
        self._thread = threading.Thread(target=self._go, name="sweep", daemon=True)
        self._thread.start()

    @property
    def left(self) -> float:
        """Seconds that the rest will take, if it goes on so; infinite before the first row."""
        done = len(self.rows)
        spent = time.monotonic() - self._began
        return spent / done * (self.plan.size - done) if done else math.inf

    def cancel(self) -> None:
        """End it; what has come so far stays."""
        self._is_cancelled.set()

    def wait(self) -> None:
        """Wait for its end."""
        self._thread.join()

    def _go(self) -> None:
        try:
            with shared() as pool:
                for row in sweep(self.plan, pool, limit=LIMIT, cancelled=self._looks):
                    self.rows.append(row)
        except (SettingError, VersionsDifferError) as refusal:
            self.message = str(refusal)
        except Exception as trouble:
            log.exception("A sweep broke.")
            text = f"{type(trouble).__name__}: {trouble}"
            self.message = f"The executor broke ({text}); start again."
        if self._is_cancelled.is_set():
            self.message = "Cancelled."
        self.is_over = True
        self._changed()

    def _looks(self) -> bool:
        """Tell of new rows; whether it is to end."""
        now = time.monotonic()
        if len(self.rows) > self._count and now > self._told + OFTEN:
            self._count, self._told = len(self.rows), now
            self._changed()
        return self._is_cancelled.is_set()
