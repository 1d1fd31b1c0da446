"""Files in TOML whose keys are checked; what is wrong with one is said with its place."""

from __future__ import annotations

import contextlib
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from solver.definitions import SettingError
from solver.disk import read_text, why

WORDS = {str: "text", int: "a whole number", list: "a list", dict: "a table"}


class PlacedError(SettingError):
    """A refused entry: the file, or the place in it, stands before what is refused."""

    def __init__(self, place: str, refusal: SettingError) -> None:
        ValueError.__init__(self, f"{place}: {refusal}")
        self.name = refusal.name


@contextlib.contextmanager
def placed(place: str) -> Iterator[None]:
    """Put a place before what is refused in it."""
    try:
        yield
    except SettingError as refusal:
        raise PlacedError(place, refusal) from None


def read_toml(path: Path, kind: str) -> dict[str, Any]:
    """Content of a file.

    Parameters
    ----------
    path
        Of the file.
    kind
        What it is to be, used in messages.

    Raises
    ------
    SettingError
        For a file that cannot be read, or is no TOML.
    """
    try:
        return tomllib.loads(read_text(path))
    except OSError as problem:
        raise SettingError(kind, str(path), "a file that can be read", why(problem)) from None
    except (ValueError, RecursionError) as problem:
        reason = " ".join(str(problem).split())
        raise SettingError(kind, str(path), "TOML", f"mend it: {reason}") from None


def check_keys(
    values: Mapping[str, Any], keys: Mapping[str, Any], optional: tuple[str, ...] = ()
) -> None:
    """Refuse keys that there are not, keys that lack, and values of a wrong type."""
    known = ", ".join(keys)
    for name, value in values.items():
        if name not in keys:
            raise SettingError(name, value, known, "there is no such key: leave it out")
        if not isinstance(value, keys[name]) or isinstance(value, bool):
            raise SettingError(name, value, WORDS.get(keys[name], "a number"), "mend the value")
    for name in keys:
        if name not in values and name not in optional:
            raise SettingError(name, None, known, "this key is needed: write it")
