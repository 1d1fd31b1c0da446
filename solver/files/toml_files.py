"""Files in TOML: reading, and checks of their keys."""

from __future__ import annotations

import contextlib
import tomllib
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import MISSING, fields
from functools import partial
from pathlib import Path
from typing import Any, get_type_hints

from solver.files.disk import LARGEST, read_bytes, too_large
from solver.files.table_lines import text_of
from solver.settings.scene import Settings
from solver.settings.values import SettingError

WORDS = {
    str: "text",
    int: "a whole number",
    list: "a list",
    dict: "a table",
}
"""Words on the type of a value in a file; of all other types they are "a number"."""
TEXTS = tuple[str, ...]
IN_FILES: dict[Any, Any] = {
    str: str,
    int: int,
    float: (int, float),
    TEXTS: list,
}
"""Type of a value in a file, by the type of the field that the value is for."""


def read_toml(path: Path, kind: str) -> dict[str, Any]:
    """Read a file in TOML; refusals name the file by its `kind`."""
    refuse = partial(SettingError, kind, str(path), "a file that can be read")
    return parse_toml(read_bytes(path, refuse), kind, str(path))


def parse_toml(data: bytes | str, name: str, shown: str) -> dict[str, Any]:
    """Parse a text in TOML; refusals have the name `name`, and show `shown`."""
    if len(data) > LARGEST:
        raise SettingError(name, shown, "TOML", too_large())
    refuse = partial(SettingError, name, shown, "TOML")
    text = text_of(data, refuse, "save the settings again")
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as problem:
        reason = " ".join(str(problem).split())
        raise refuse(f"mend it: {reason}") from None


def check_keys(
    values: Mapping[str, Any], keys: Mapping[str, Any], optional: Collection[str] = ()
) -> None:
    """Refuse unknown keys, missing keys, and values of a wrong type."""
    known = ", ".join(keys)
    for name, value in values.items():
        if name not in keys:
            raise SettingError(name, value, known, "there is no such key: leave it out")
        # True is an instance of int in Python, and no number here.
        if not isinstance(value, keys[name]) or isinstance(value, bool):
            raise SettingError(
                name, value, WORDS.get(keys[name], "a number"), "mend the value"
            )
    for name in keys:
        if name not in values and name not in optional:
            raise SettingError(name, None, known, "this key is needed: write it")


def fields_in(kind: Any, values: Mapping[str, Any], **others: Any) -> dict[str, Any]:
    """Values of the fields of a dataclass from a table's keys, with lists as tuples.

    The table has no key `name`, and may leave out fields with a default. `others` are
    the types of keys that are no fields, or whose values have another type in the file.
    Keys are refused as by `check_keys`, and lists of anything but texts.
    """
    # Types of fields are texts in modules with postponed annotations.
    types = get_type_hints(kind)
    keys = {}
    optional = []
    for field in fields(kind):
        if field.name == "name":
            continue
        if types[field.name] in IN_FILES:
            keys[field.name] = IN_FILES[types[field.name]]
        if field.default is not MISSING:
            optional.append(field.name)
    check_keys(values, keys | others, optional)
    found = dict(values)
    for name in keys.keys() & found.keys():
        if types[name] == TEXTS and name not in others:
            found[name] = _texts_in(found[name], name)
    return found


def _texts_in(values: Sequence[object], name: str) -> tuple[str, ...]:
    """Texts in a list under a key; refuse an empty list and other values."""
    texts = [value for value in values if isinstance(value, str)]
    require(
        len(values) > 0 and len(texts) == len(values) and all(texts),
        name,
        list(values),
        "a list of texts, at least one",
        "write them in quotes",
    )
    return tuple(texts)


def require(is_met: bool, name: str, value: object, allowed: str, remedy: str) -> None:
    """Refuse a value unless a requirement is met."""
    if not is_met:
        raise SettingError(name, value, allowed, remedy)


def check_controls(names: Sequence[str], settings: Settings) -> None:
    """Refuse controls that are no settings, or do not apply."""
    applying = [name for name in settings.definitions() if settings.applies(name)]
    for name in names:
        remedy = "name a setting that does something here"
        require(name in applying, "controls", name, ", ".join(applying), remedy)


@contextlib.contextmanager
def placed(place: str) -> Iterator[None]:
    """Context that puts a file, or a place in a file, before names in refusals."""
    try:
        yield
    except SettingError as refusal:
        name = f"{place}: {refusal.name}"
        raise SettingError(
            name, refusal.value, refusal.allowed, refusal.remedy
        ) from None
