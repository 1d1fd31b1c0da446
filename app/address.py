"""Settings in a page's address."""

from __future__ import annotations

import json
from urllib.parse import parse_qsl, quote

from solver.definitions import SettingError, parse
from solver.files import scene_settings
from solver.settings import Settings

DEFAULT_SCENE = "bar"


def settings_from_query(query: str) -> tuple[Settings, str]:
    """Read settings from a page's address; a bad one gives the defaults and a complaint."""
    kind = scene_settings(DEFAULT_SCENE)
    try:
        pairs = dict(parse_qsl(query.lstrip("?")))
        kind = scene_settings(pairs.pop("scene", DEFAULT_SCENE))
        definitions = kind.definitions()
        values = {
            name: parse(text) if name in definitions else text for name, text in pairs.items()
        }
        return kind.checked(values), ""
    except SettingError as refusal:
        return kind.checked({}), f"From the address: {refusal}"


def query_of(settings: Settings) -> str:
    """Write the settings that differ from their defaults as a page's address."""
    pairs = [("scene", settings.scene)]
    pairs += [(name, json.dumps(value)) for name, value in settings.changed().items()]
    return "?" + "&".join(f"{name}={quote(text)}" for name, text in pairs)
