"""Worker processes with a limit or a fault; what they write to stderr goes to a file."""

from __future__ import annotations

import os
import resource
import time
from multiprocessing.connection import Connection
from pathlib import Path

from app.worker import process
from app.worker.run import WorkerRun

ROOM = 200_000_000
"""Bytes that a process may take beyond what it has at its start."""
SOON = 3.0
"""Seconds after which a piece of work counts as stuck; others end by then, however busy all is."""


def hungry(connection: Connection, log: str) -> None:
    """Serve with little memory."""
    _write_to(log)
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    limit = pages * resource.getpagesize() + ROOM
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    process.main(connection)


def stuck_at_first(connection: Connection, log: str) -> None:
    """Serve, but the first time never end the piece of work after the first iteration."""
    if not Path(log).exists():
        _write_to(log)
        process.LONGEST = SOON
        WorkerRun._compare = _never_end  # type: ignore[method-assign]
    process.main(connection)


def _never_end(run: WorkerRun, newest: object) -> None:
    while True:
        time.sleep(1.0)


def _write_to(log: str) -> None:
    os.dup2(os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND), 2)
