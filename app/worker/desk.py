"""The folder in which a report grows: how far it is, and its files as the command line writes them.

Files, so that any executor will do that shares a disk with the server.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

PROGRESS = ".progress"


class Desk:
    """What the process that makes a report writes on; nothing is ever seen half written."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def tell(self, doing: str, share: float) -> None:
        """Say what is being done, and the share of the whole that is done, from 0 to 1."""
        text = json.dumps([doing, share])
        self.publish(lambda folder: (folder / PROGRESS).write_text(text, encoding="utf-8"))

    def publish(self, write: Callable[[Path], object]) -> None:
        """Put files where they are read, in place of those of the same names."""
        with TemporaryDirectory(dir=self._folder, prefix=".") as name:
            write(Path(name))
            for file in Path(name).iterdir():
                os.replace(file, self._folder / file.name)


def told(folder: Path) -> tuple[str, float] | None:
    """Read how far a report is; None before its process has said anything."""
    try:
        doing, share = json.loads((folder / PROGRESS).read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    return doing, share


def files(folder: Path) -> list[Path]:
    """Give the files of a report that are there."""
    return sorted(file for file in folder.iterdir() if not file.name.startswith("."))
