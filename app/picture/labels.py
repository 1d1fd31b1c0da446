"""How runs are called where they are compared."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from app.picture.units import BY_SIZE, measured
from solver.definitions import about
from solver.phrases import Phrase
from solver.settings import Settings

FEW = 2
"""Changes by which a run is called where there is little room."""


def changes_of(settings: Settings, other: Settings) -> dict[str, Any]:
    """Give what differs from other settings of the same scene, by name."""
    before = other.values()
    return {name: value for name, value in settings.values().items() if value != before[name]}


def difference(settings: Settings, other: Settings, units: str) -> str:
    """Name settings by what differs from others of the same scene."""
    return label_of(settings, changes_of(settings, other), units)


def label_of(
    settings: Settings, changed: dict[str, Any], units: str = BY_SIZE, most: int = FEW
) -> str:
    """Name settings by what is new in them, or by the first few of it."""
    definitions = settings.definitions()
    parts = []
    for name, value in list(changed.items())[:most]:
        said = _written(value, about(definitions[name]).unit, units)
        parts.append(f"{name.replace('_', ' ')} {said}")
    more = len(changed) - most
    return ", ".join(parts) + (f" and {more} more" if more > 0 else "")


def _written(value: Any, unit: str, units: str) -> str:
    if isinstance(value, bool):
        return ("off", "on")[value]
    if isinstance(value, tuple):
        return "points"
    if not isinstance(value, float):
        return f"{value} {unit}".strip()
    return measured(value, unit, units, 4)


def in_titles(settings: Settings, text: str, written: str = "{}") -> str:
    """Call settings in a text what the sidebar calls them; one word may be just that."""
    if isinstance(text, Phrase):
        parts = (text.template, *text.parts)
        return Phrase(*(_in_titles(settings, one, written) for one in parts))
    for name, definition in settings.definitions().items():
        if "_" in name:
            text = re.sub(rf"\b{name}\b", written.format(about(definition).title), text)
    return text


def _in_titles(settings: Settings, part: Any, written: str) -> str:
    """Call a part of a text, where that is the name of a setting, what the sidebar calls it."""
    definition = settings.definitions().get(str(part))
    if definition is not None:
        return about(definition).title
    return in_titles(settings, part if isinstance(part, str) else str(part), written)


def called(interface: str, interfaces: Sequence[str]) -> str:
    """Call an interface as it stands in a list of all; a wire that is alone, by its layer."""
    kind, _, numbers = interface.partition(" ")
    layer, _, wire = numbers.partition(".")
    if kind == "wire" and wire:
        is_alone = sum(one.startswith(f"{kind} {layer}.") for one in interfaces) == 1
        return Phrase("layer {}", layer) if is_alone else Phrase("layer {}, {}", layer, wire)
    return Phrase("contact {}", numbers) if kind == "contact" else interface
