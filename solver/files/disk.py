"""Files: read up to a largest size, and written complete or not at all."""

from __future__ import annotations

import errno
import os
import secrets
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

from solver.settings.definitions import SettingError

Refuse = Callable[[str], SettingError]
"""What makes a refusal out of what is to be done."""
LARGEST = 4_000_000
"""Bytes of a file of settings, a table or a lesson, at most: some 200 000 points of a
load path."""
TOO_LARGE = f"it has more than {LARGEST // 1_000_000} MB"


def read_bytes(path: Path, refuse: Refuse) -> bytes:
    """Bytes of a file; of one that is too large no more than it takes to know.

    What cannot be read, is too large, or is no file is refused with the reason. A pipe,
    which may have no other end, is not waited for.
    """
    try:
        with open(path, "rb", opener=_open_at_once) as file:
            is_file = stat.S_ISREG(os.fstat(file.fileno()).st_mode)
            if is_file:
                data = file.read(LARGEST + 1)
            else:
                data = b""
    except (OSError, ValueError) as problem:  # no path at all is a ValueError
        raise refuse(why(problem)) from None
    if not is_file:
        raise refuse("it is a pipe or a device: save what it gives to a file")
    if len(data) > LARGEST:
        raise refuse(TOO_LARGE)
    return data


def _open_at_once(path: str, flags: int) -> int:
    """Open a file; a pipe without waiting for its other end, where a system knows how."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


@contextmanager
def whole_file(path: Path, mode: str = "w") -> Iterator[IO[Any]]:
    """Open a file to write, which takes its place once it is complete.

    Until then it stands beside that place under another name, and goes if anything
    fails.

    Raises
    ------
    OSError
        If there is no such folder, it cannot be written to, or is full; if what stands
        there is no file, or one that must not be changed.
    """
    place, part = _place_and_part(path)
    if "b" in mode:
        encoding = None
        newline = None
    else:
        encoding = "utf-8"
        newline = ""
    try:
        with part.open(
            mode.replace("w", "x"), encoding=encoding, newline=newline
        ) as file:
            yield file
        part.replace(place)
    finally:
        part.unlink(missing_ok=True)


def why(problem: OSError | ValueError) -> str:
    """A few words on why a file cannot be read or written."""
    if isinstance(problem, OSError):
        reason = problem.strerror
    else:
        reason = None
    return reason or type(problem).__name__


def write(path: Path, content: str | bytes) -> None:
    """Write a file, as above."""
    with whole_file(path, "w" if isinstance(content, str) else "wb") as file:
        file.write(content)


def check_place(path: Path) -> None:
    """Raise, before long work, what `whole_file` would."""
    _, part = _place_and_part(path)
    part.touch(exist_ok=False)
    part.unlink()


def _place_and_part(path: Path) -> tuple[Path, Path]:
    """Place of a file, links followed, and what stands beside it until it is complete."""
    place = Path(os.path.realpath(path))
    if place.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if place.exists() and not place.is_file():
        raise OSError(errno.EINVAL, "It is a device, not a file")
    if place.exists() and not os.access(place, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    return place, place.with_name(f".{secrets.token_hex(6)}.part")
