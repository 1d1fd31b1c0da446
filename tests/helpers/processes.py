"""Helpers of tests of processes: what to ask of them, and waiting."""

from __future__ import annotations

import os
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

PATIENCE = 120.0
"""Seconds that a test waits for what comes at all, also where others keep the machine
busy."""


def is_alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def wait_for(condition: Callable[[], object]) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        # What is asked may be the whole table of processes, or a page
        time.sleep(0.05)


@contextmanager
def started(
    command: Sequence[str], **options: Any
) -> Iterator[subprocess.Popen[bytes]]:
    """Start a command, with options of `Popen`, and end it in any case."""
    with subprocess.Popen(command, **options) as process:
        try:
            yield process
        finally:
            process.kill()
