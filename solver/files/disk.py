"""Files: read up to a largest size, written completely or not at all."""

from __future__ import annotations

import errno
import os
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

from solver.settings.values import Refuse

LARGEST = 4_000_000
"""Largest size of a file of settings, a table, a mesh or a lesson, in bytes: some
200 000 points of a load path, 60 000 elements. A page that reads a table of this size
keeps all others waiting for 4 s (measured)."""
LARGEST_RESULTS = 40_000_000
"""Largest size of a table that a command compares with, in bytes, which keeps nobody
waiting but who gave it: the contact of a rope over all instants has 7 MB, and takes 7 s
and 170 MB of memory (measured)."""


def too_large(largest: int = LARGEST) -> str:
    """Reason why a file of more than `largest` bytes is not read."""
    return f"it has more than {largest // 1_000_000} MB"


def read_bytes(path: Path, refuse: Refuse, largest: int = LARGEST) -> bytes:
    """Read the bytes of a file, at most `largest`.

    A path that cannot be read, is too large, or is no file is refused with the reason.
    A pipe, which may have no other end, is not waited for.
    """
    data = b""
    try:
        # The opened file is asked for its kind: the name could be another file by then.
        with open(path, "rb", opener=_open_at_once) as file:
            is_file = stat.S_ISREG(os.fstat(file.fileno()).st_mode)
            if is_file:
                data = file.read(largest + 1)
    except (OSError, ValueError) as problem:  # no path at all is a ValueError
        raise refuse(why(problem)) from None
    if not is_file:
        raise refuse("it is a pipe or a device: save what it gives to a file")
    if len(data) > largest:
        raise refuse(too_large(largest))
    return data


def _open_at_once(path: str, flags: int) -> int:
    """Open a file without waiting for the other end of a pipe, if the system can."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


@contextmanager
def whole_file(path: Path, mode: str = "w") -> Iterator[IO[Any]]:
    """Open a file to write; it gets its name when it is complete.

    Until then it has another name in the same folder; it is removed if anything fails.

    Raises
    ------
    OSError
        If the folder does not exist, cannot be written to, or is full, or if the path
        is no file, or a file that must not be changed.
    """
    target, part = _target_and_part(path)
    encoding = None
    newline = None
    if "b" not in mode:
        encoding = "utf-8"
        newline = ""
    # Exclusive, so that nobody can have put a link under that name.
    new = mode.replace("w", "x")
    try:
        with part.open(new, encoding=encoding, newline=newline) as file:
            yield file
        # In the same folder, so that the replacement is one step of the file system.
        part.replace(target)
    finally:
        part.unlink(missing_ok=True)


def why(problem: OSError | ValueError) -> str:
    """Short reason why a file cannot be read or written."""
    if isinstance(problem, OSError) and problem.strerror:
        return problem.strerror
    return type(problem).__name__


def write(path: Path, content: str | bytes) -> None:
    """Write a file completely or not at all, as `whole_file`."""
    mode = "w" if isinstance(content, str) else "wb"
    with whole_file(path, mode) as file:
        file.write(content)


def check_place(path: Path) -> None:
    """Raise the error of `whole_file` early, before long work."""
    _, part = _target_and_part(path)
    part.touch(exist_ok=False)
    part.unlink()


def _target_and_part(path: Path) -> tuple[Path, Path]:
    """Path of a file with links resolved, and its temporary path until completion."""
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if target.exists() and not target.is_file():
        raise OSError(errno.EINVAL, "It is a device, not a file")
    # Replacing needs rights on the folder alone, and would pass over a write-protected
    # file.
    if target.exists() and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    return target, target.with_name(f".{secrets.token_hex(6)}.part")
