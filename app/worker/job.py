"""A long piece of work in a process of its own, which ends with it, with the page, or the server.

process -> page    Started, then Doing and Part as they come, and exactly one of Done and Broke;
nothing more once it was cancelled
"""

from __future__ import annotations

import contextlib
import logging
import os
import signal
import threading
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any

from app.worker.link import start
from app.worker.process import NICENESS

_log = logging.getLogger(__name__)

STOPPED = "Its process stopped unexpectedly; start it again."


@dataclass(frozen=True)
class Started:
    """The process is being started: until then, another job had the processors."""


@dataclass(frozen=True)
class Doing:
    """What is being done, and the share of the whole that is done, from 0 to 1."""

    text: str
    share: float


@dataclass(frozen=True)
class Part:
    """A part of the result, as soon as it is there."""

    value: Any


@dataclass(frozen=True)
class Done:
    """The whole result."""

    result: Any


@dataclass(frozen=True)
class Broke:
    """There is no result: a sentence for the user, and for the server's log where it broke."""

    reason: str
    trace: str = ""


Said = Started | Doing | Part | Done | Broke
Send = Callable[[Doing | Part], None]
Work = Callable[[Send], Any]
"""Picklable, with a picklable result; it is given what takes its messages."""


class Job:
    """One piece of work, from its beginning to its end.

    Parameters
    ----------
    work
        What is done in the process.
    listener
        Takes what it says, on a thread of this job.
    ended
        Called once on the same thread when the process is gone.
    """

    def __init__(
        self,
        work: Work,
        listener: Callable[[Said], None],
        ended: Callable[[Job], None] = lambda job: None,
    ) -> None:
        self._work = work
        self._listener = listener
        self._ended = ended
        self._lock = threading.Lock()
        self._cancelled = False
        self._process: BaseProcess | None = None

    def begin(self) -> None:
        """Start the process, without waiting for it."""
        threading.Thread(target=self._live, name="job-reports", daemon=True).start()

    def cancel(self) -> None:
        """End it at once, or do not begin with it."""
        with self._lock:
            self._cancelled = True
            if self._process is not None:
                self._process.kill()

    @property
    def is_cancelled(self) -> bool:
        """Whether nobody waits for it any more."""
        return self._cancelled

    @property
    def pid(self) -> int | None:
        """Number of the process, None before it has started."""
        return self._process.pid if self._process else None

    def _live(self) -> None:
        try:
            self._say(Started())
            self._converse()
        except (OSError, EOFError):
            # The process is gone; or, where the fork server was gone, it has never been there.
            self._say(Broke(STOPPED))
        except Exception as problem:
            self._say(Broke(_sentence(problem), traceback.format_exc()))
        finally:
            if self._process is not None:
                self._process.kill()
                self._process.join()
            self._ended(self)

    def _converse(self) -> None:
        """Start the process, and pass on what it says."""
        started, ours = start(main, self._work)
        with self._lock:
            self._process = started
            if self._cancelled:
                started.kill()
        with ours:
            self._listen(ours)

    def _listen(self, connection: Connection) -> None:
        """Pass on what is said, until the end or, as an EOFError, the end of the process."""
        said: Said | None = None
        while not isinstance(said, Done | Broke):
            said = connection.recv()
            self._say(said)

    def _say(self, said: Said) -> None:
        if isinstance(said, Broke) and said.trace:
            _log.error("A job broke.\n%s", said.trace)
        # What was read while it was being cancelled is for nobody.
        if not self._cancelled:
            self._listener(said)


def main(connection: Connection, work: Work) -> None:
    """Do a job in this process, and say what came of it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    threading.Thread(target=_end_with, args=(connection,), daemon=True).start()
    end: Done | Broke
    try:
        end = Done(work(connection.send))
    except Exception as problem:
        end = Broke(_sentence(problem), traceback.format_exc())
    with contextlib.suppress(OSError):
        connection.send(end)


def _sentence(problem: Exception) -> str:
    return f"It broke ({type(problem).__name__}: {problem})."


def _end_with(connection: Connection) -> None:
    """End the process as soon as the server is gone: nobody else would, in the middle of work."""
    with contextlib.suppress(EOFError, OSError):
        connection.recv()
    os._exit(0)
