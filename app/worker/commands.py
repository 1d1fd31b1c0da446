"""What a process does that makes a report: a command of the command line, in a folder."""

from __future__ import annotations

import os
import shutil
from collections.abc import Sequence
from contextlib import ExitStack, redirect_stderr, redirect_stdout
from functools import partial
from pathlib import Path

from solver.running.calls import when_deserted

LOG = "log.txt"


def command(arguments: Sequence[str], folder: Path) -> int:
    """Run a command with its output in the folder's log, which goes if the server is gone."""
    from solver.cli import main

    # A process does one command and ends.
    os.chdir(folder)
    deserted = when_deserted(partial(shutil.rmtree, folder, ignore_errors=True))
    with ExitStack() as stack:
        stack.enter_context(deserted)
        log = stack.enter_context(Path(LOG).open("w", buffering=1, encoding="utf-8"))
        stack.enter_context(redirect_stdout(log))
        stack.enter_context(redirect_stderr(log))
        try:
            return main(list(arguments))
        except SystemExit as end:
            return int(end.code or 0)
