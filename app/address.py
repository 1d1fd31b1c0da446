"""Settings in a page's address."""

from __future__ import annotations

import json
from textwrap import shorten
from typing import Any
from urllib.parse import parse_qsl, quote

from solver.definitions import SettingError, checked_value, parse
from solver.files import scene_settings
from solver.settings import Settings

DEFAULT_SCENE = "bar"
MOST_TOLD = 3
LONGEST_NAME = 40


def settings_from_query(query: str) -> tuple[Settings, str]:
    """Read settings from a page's address.

    Returns
    -------
    settings
        Those of the address that are valid together, and the defaults of the others.
    complaint
        What was refused and why, or empty.
    """
    kind = scene_settings(DEFAULT_SCENE)
    pairs = dict(parse_qsl(query.lstrip("?")))
    try:
        kind = scene_settings(pairs.pop("scene", DEFAULT_SCENE))
    except SettingError as refusal:
        return kind.checked({}), complaint_of([str(refusal)])
    definitions = kind.definitions()
    values, refused = {}, []
    for name, text in pairs.items():
        if name not in definitions:
            refused.append(f"there is no setting {shorten(name, LONGEST_NAME)}")
            continue
        try:
            values[name] = checked_value(definitions[name], name, parse(text))
        except SettingError as refusal:
            refused.append(str(refusal))
    settings, apart = _together(kind, values)
    return settings, complaint_of([*refused, *apart])


def _together(kind: type[Settings], values: dict[str, Any]) -> tuple[Settings, list[str]]:
    """Take as many values as are valid together; give the refusals of the others."""
    try:
        return kind.checked(values), []
    except SettingError:
        pass
    taken: dict[str, Any] = {}
    left, refused = values, {}
    while left:
        # One that was refused may be valid beside one that came later.
        refused = {}
        for name, value in left.items():
            try:
                kind.checked({**taken, name: value})
                taken[name] = value
            except SettingError as refusal:
                alone = refusal.name == name
                refused[name] = str(refusal) if alone else f"{name} is left out: {refusal}"
        if len(refused) == len(left):
            break
        left = {name: left[name] for name in refused}
    return kind.checked(taken), list(refused.values())


def complaint_of(refused: list[str]) -> str:
    """Say what an address has that is refused, at length for the first few."""
    if not refused:
        return ""
    more = len(refused) - MOST_TOLD
    rest = f"; and {more} more" if more > 0 else ""
    return f"From the address: {'; '.join(refused[:MOST_TOLD])}{rest}."


def query_of(settings: Settings) -> str:
    """Write the settings that differ from their defaults as a page's address."""
    pairs = [("scene", settings.scene)]
    pairs += [(name, json.dumps(value)) for name, value in settings.changed().items()]
    return "?" + "&".join(f"{name}={quote(text)}" for name, text in pairs)
