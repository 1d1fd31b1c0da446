"""A long report that a page has asked for: how far it is, and what came of those before."""

from __future__ import annotations

import pickle
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from app.session.report_executor import report, said_of
from app.session.report_folder import PROGRESS, SECTIONS, files, said
from app.session.studies import Work
from solver.definitions import SettingError
from solver.study.page import Section

KEPT = 6
AT_ONCE = 0.2
"""Seconds after which a report that is not begun waits for another."""
WAITING, STARTING = "Waiting: another report is made first", "Starting"


@dataclass(eq=False)
class Found:
    """A report: its sections, which grow, and at its end the files of the command, by name."""

    title: str = ""
    sections: Sequence[Section] = ()
    files: Mapping[str, bytes] = field(default_factory=dict)


class ReportJob:
    """One kind of report of one page, at most one at a time; results stay until the page closes.

    Parameters
    ----------
    executor
        Makes it.
    began
        Called when one is asked for, which has to be looked at by `collect` from then on.

    Attributes
    ----------
    title
        Of the report that is being made, or of the last one.
    doing, share
        What is done for it, and the share that is done.
    growing
        What there is of it so far.
    found
        Results, oldest first.
    notice
        Why the last one came to nothing, or empty.
    """

    def __init__(self, executor: Executor, began: Callable[[], object] = lambda: None) -> None:
        self._executor, self._began = executor, began
        self._future: Future[Any] | None = None
        self._folder: TemporaryDirectory[str] | None = None
        self._read = b"", b""
        self._asked = 0.0
        self.title = ""
        self.doing, self.share = "", 0.0
        self.growing = Found()
        self.found: deque[Found] = deque(maxlen=KEPT)
        self.notice = ""

    @property
    def is_busy(self) -> bool:
        """Whether a report is asked for or being made."""
        return self._future is not None

    @property
    def is_begun(self) -> bool:
        """Whether it is being made, and not only asked for."""
        return self._future is not None and self._future.running()

    @property
    def last(self) -> Found | None:
        """The result of the one before, if there is no newer one and that came to anything."""
        return self.found[-1] if self.found and not self.is_busy and not self.notice else None

    def ask(self, title: str, work: Work) -> None:
        """Have a report made, unless one is."""
        if self._future is not None:
            return
        self.title, self.notice, self.share = title, "", 0.0
        self.growing, self._read = Found(title), (b"", b"")
        # What a killed process was writing just then is no reason to complain.
        self._folder = TemporaryDirectory(prefix="slipfront-", ignore_cleanup_errors=True)
        try:
            self._future = self._executor.submit(report, work, Path(self._folder.name))
        except SettingError as refusal:
            self._end(str(refusal))
            return
        self.doing, self._asked = STARTING, time.monotonic()
        self._began()

    def cancel(self) -> None:
        """End it; what has been found so far stays."""
        if self._future is not None:
            self._future.cancel()
            self._end("Cancelled.")

    def collect(self) -> bool:
        """Read how far it is; tell whether anything is new."""
        future = self._future
        if future is None or self._folder is None:
            return False
        is_done, folder = future.done(), Path(self._folder.name)
        before = self.doing, self._read
        self._read = progress, sections = said(folder, PROGRESS), said(folder, SECTIONS)
        waits = not self.is_begun and time.monotonic() > self._asked + AT_ONCE
        self.doing = WAITING if waits else STARTING
        if progress:
            self.doing, self.share = pickle.loads(progress)
        if sections != before[1][1]:
            self.growing.sections = pickle.loads(sections)
        if is_done:
            self._take(future, folder)
        return is_done or before != (self.doing, self._read)

    def _take(self, future: Future[Any], folder: Path) -> None:
        """Follow the end of the process."""
        if future.cancelled():
            self._end("Cancelled.")
        elif problem := future.exception():
            self._end(said_of(problem))
        else:
            self.growing.files = files(folder)
            self.found.append(self.growing)
            self._end("")

    def _end(self, notice: str) -> None:
        assert self._folder is not None
        self._folder.cleanup()
        self._future, self._folder, self.notice = None, None, notice
