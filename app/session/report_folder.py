"""The folder in which a report grows: how far it is, its sections, and the files of the command.

Files, so that any executor will do that shares a disk with the server.
"""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from solver.study.page import Section

PROGRESS, SECTIONS = ".progress", ".sections"


class ReportFolder:
    """What the process that makes a report writes on; nothing is ever seen half written."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def tell(self, doing: str, share: float) -> None:
        """Say what is being done, and the share of the whole that is done, from 0 to 1."""
        self._say(PROGRESS, (doing, share))

    def show(self, sections: Sequence[Section]) -> None:
        """Show what there is of the report."""
        self._say(SECTIONS, sections)

    def publish(self, write: Callable[[Path], object]) -> None:
        """Put files where they are read, in place of those of the same names."""
        with TemporaryDirectory(dir=self._folder, prefix=".") as name:
            write(Path(name))
            for file in Path(name).iterdir():
                os.replace(file, self._folder / file.name)

    def _say(self, name: str, what: object) -> None:
        data = pickle.dumps(what)
        self.publish(lambda folder: (folder / name).write_bytes(data))


def said(folder: Path, name: str) -> bytes:
    """Read the progress or the sections, pickled; nothing before there are any."""
    file = folder / name
    return file.read_bytes() if file.exists() else b""


def files(folder: Path) -> Mapping[str, bytes]:
    """Read the files of a report that are there, by name."""
    own = sorted(file for file in folder.iterdir() if not file.name.startswith("."))
    return {file.name: file.read_bytes() for file in own}
