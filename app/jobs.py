"""Commands of the command line that pages have run: in processes, one after the other."""

from __future__ import annotations

import atexit
import time
from collections.abc import Sequence
from contextlib import ExitStack
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from app.worker.commands import LOG, command
from solver.running.executors import executor_of_the_server, opened
from solver.running.pool import Pool

LOCAL = "processes:1"
"""Two at a time would spoil each other's measurements, and thirty the server."""
STOPPED = "Its process stopped unexpectedly; start it again."
SETTINGS = "settings.toml"
OUT = "out"


@cache
def executor() -> Pool:
    """What all pages of this server share: a process a command, in turn; or the server's cluster.

    Raises
    ------
    SettingError
        If the setting of the server names none.
    """
    named = executor_of_the_server()
    stack = ExitStack()
    on = LOCAL if named.startswith("processes") or not named else named
    pool = stack.enter_context(opened(on, lasting=False))
    atexit.register(stack.close)
    return pool


class Job:
    """A command that is waiting, running, or done.

    Parameters
    ----------
    arguments
        As after `python -m solver`; they may name the file `SETTINGS` and the folder `OUT`.
    settings
        Text of that file.

    Attributes
    ----------
    folder
        In which it runs.
    """

    def __init__(self, arguments: Sequence[str], settings: str = "") -> None:
        self._place = TemporaryDirectory(prefix="slipfront-", ignore_cleanup_errors=True)
        self.folder = Path(self._place.name)
        (self.folder / SETTINGS).write_text(settings, encoding="utf-8")
        self._asked = time.monotonic()
        self._is_cancelled = False
        self._future = executor().submit(command, tuple(arguments), self.folder)

    @property
    def is_begun(self) -> bool:
        """Whether its turn has come."""
        return self._future.running() or self._future.done()

    @property
    def is_over(self) -> bool:
        """Whether nothing more comes."""
        return self._future.done()

    @property
    def lines(self) -> list[str]:
        """What the command has printed so far."""
        log = self.folder / LOG
        return log.read_text(encoding="utf-8").splitlines() if log.exists() else []

    @property
    def files(self) -> dict[str, bytes]:
        """What the command has written, by name."""
        out = self.folder / OUT
        return {file.name: file.read_bytes() for file in sorted(out.glob("*"))}

    @property
    def progress(self) -> str:
        """How far it is, or why it came to nothing."""
        seconds = time.monotonic() - self._asked
        if not self.is_begun:
            return "Waiting: another report is made first."
        if not self.is_over:
            last = next((line.strip() for line in reversed(self.lines) if line.strip()), "Working")
            return f"{seconds:.0f} s: {last}"
        return self.failure

    @property
    def failure(self) -> str:
        """Why it came to nothing, or nothing."""
        if self._is_cancelled:
            return "Cancelled."
        if not self.is_over:
            return ""
        if self._future.exception() is not None:
            return STOPPED
        has_failed = self._future.result() not in (0, 1) or not (self.files or self.lines)
        return "\n".join(self.lines[-3:]) if has_failed else ""

    def cancel(self) -> None:
        """End it; a process at work is ended at once."""
        self._is_cancelled = self._is_cancelled or not self.is_over
        self._future.cancel()

    def close(self) -> None:
        """End it and leave nothing behind."""
        self.cancel()
        self._place.cleanup()
