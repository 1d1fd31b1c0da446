"""Process of a report: runs a command in a folder."""

from __future__ import annotations

import os
import shutil
from collections.abc import Sequence
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

from solver.study.sweep.executors import left_alone

LOG = "log.txt"


def command(arguments: Sequence[str], folder: Path) -> int:
    """Run a command with a log in the folder; end if the server has ended."""
    from solver.commands.cli import main

    # A process does one command and ends.
    os.chdir(folder)
    left_alone.callback(shutil.rmtree, folder, ignore_errors=True)
    with (
        Path(LOG).open("w", buffering=1, encoding="utf-8") as log,
        redirect_stdout(log),
        redirect_stderr(log),
    ):
        try:
            return main(list(arguments))
        except SystemExit as end:
            return int(end.code or 0)
