"""The sweep that a page has asked for: on the server's executor, rows as they come."""

from __future__ import annotations

import contextlib
import logging
import math
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager

from solver.definitions import SettingError
from solver.running.executors import executor_of_the_server, opened
from solver.running.machine import processors
from solver.running.pool import Pool
from solver.study.sweep import Plan, Row, VersionsDifferError, patience, sweep

_log = logging.getLogger(__name__)

LIMIT = 60.0
"""Seconds that a run may take: nobody waits longer in front of a page for a point of a chart."""
PROCESSES = "processes"
OFTEN, A_POINT = 0.2, 1e-3
"""Seconds between two looks at what has come, and more for every point that is there: all of them
are sent and painted anew, on processors that the rest of the chart waits for."""
BROKEN = "The executor broke ({}: {}); start again."
CANCELLED = "Cancelled."


class Lender:
    """Gives every sweep of the server's pages its part of the executor, which ends with the sweep.

    A queue for all would have everybody wait for the longest run of anybody. So each page has
    processes of its own, fewer the more pages are at it, and the operating system shares.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self.users = 0

    @contextlib.contextmanager
    def lent(self) -> Iterator[Pool]:
        """Open a part of the executor.

        Raises
        ------
        SettingError
            If the setting of the server names none.
        """
        with self._lock:
            self.users += 1
            on = part_of(executor_of_the_server() or PROCESSES, self.users)
        try:
            with opened(on, patience(LIMIT)) as pool:
                yield pool
        finally:
            with self._lock:
                self.users -= 1


def part_of(on: str, users: int) -> str:
    """Name what one of so many users has of an executor: of a cluster, which has a queue, all.

    Where no number is named, one processor is left to the pages, but of two none: a chart is then
    there in half of the time, and as its processes are niced, a slider has its picture 1.1 to
    1.5 times as late.
    """
    kind, _, count = on.partition(":")
    if kind != PROCESSES or (count and not count.isdecimal()) or count == "0":
        return on
    width = int(count) if count else max(processors() - 1, min(processors(), 2))
    return f"{PROCESSES}:{max(1, width // users)}"


LENDER = Lender()


class SweepThread:
    """One sweep, on a thread of its own until its end.

    Attributes
    ----------
    rows
        Those that have come and were not taken yet.
    notice
        Why it came to nothing, or empty.
    is_over
        Whether nothing more comes.
    """

    def __init__(self, plan: Plan, lent: Callable[[], AbstractContextManager[Pool]]) -> None:
        self.rows: deque[Row] = deque()
        self.notice = ""
        self.is_over = False
        self._is_cut = threading.Event()
        work = threading.Thread(target=self._go, args=(plan, lent), name="sweep", daemon=True)
        work.start()

    def cut(self) -> None:
        """End it."""
        self._is_cut.set()

    def _go(self, plan: Plan, lent: Callable[[], AbstractContextManager[Pool]]) -> None:
        try:
            with lent() as pool:
                for row in sweep(plan, pool, limit=LIMIT, cancelled=self._is_cut.is_set):
                    self.rows.append(row)
        except (SettingError, VersionsDifferError) as refusal:
            self.notice = str(refusal)
        except Exception as trouble:
            _log.exception("A sweep broke.")
            self.notice = BROKEN.format(type(trouble).__name__, trouble)
        self.is_over = True


class Inquiry:
    """What a page has asked, at most one sweep at a time.

    Parameters
    ----------
    lent
        Lends the executor.
    began
        Called when a sweep begins, of which `collect` has to take what comes from then on.

    Attributes
    ----------
    plan, rows
        The sweep that was asked for last, and what has come of it.
    before
        The plan and the rows of the one before; None before there is one with any row.
    notice
        Why it came to nothing, or empty.
    """

    def __init__(
        self,
        lent: Callable[[], AbstractContextManager[Pool]] = LENDER.lent,
        began: Callable[[], object] = lambda: None,
    ) -> None:
        self._lent, self._began = lent, began
        self._course: SweepThread | None = None
        self._asked = self._looked = 0.0
        self.plan: Plan | None = None
        self.rows: list[Row] = []
        self.before: tuple[Plan, Sequence[Row]] | None = None
        self.notice = ""

    @property
    def is_busy(self) -> bool:
        """Whether anything is still to come."""
        return self._course is not None

    @property
    def left(self) -> float:
        """Seconds that the rest will take, if it goes on so; infinite before the first row."""
        if self.plan is None or not self.rows:
            return math.inf
        spent = self._looked - self._asked
        return spent / len(self.rows) * (self.plan.size - len(self.rows))

    def ask(self, plan: Plan) -> None:
        """Begin a sweep, in place of the one that goes on."""
        self.cancel()
        if self.plan is not None and self.rows:
            self.before = self.plan, self.rows
        self.plan, self.rows, self.notice = plan, [], ""
        self._asked = self._looked = time.monotonic()
        self._course = SweepThread(plan, self._lent)
        self._began()

    def cancel(self) -> None:
        """End it; what has come so far stays."""
        if self._course is not None:
            self._course.cut()
            self._take(self._course)
            self._course, self.notice = None, CANCELLED

    def collect(self) -> bool:
        """Take what has come, not too often; tell whether anything is new."""
        course, now = self._course, time.monotonic()
        if course is None:
            return False
        is_over = course.is_over
        if not is_over and now - self._looked < OFTEN + A_POINT * len(self.rows):
            return False
        before, self._looked = len(self.rows), now
        self._take(course)
        if is_over:
            self._course, self.notice = None, course.notice
        return is_over or len(self.rows) > before

    def _take(self, course: SweepThread) -> None:
        while course.rows:
            self.rows.append(course.rows.popleft())
