"""How runs are called where they are compared."""

from __future__ import annotations

import re
from typing import Any

from app.picture.units import measured
from solver.definitions import about
from solver.settings import Settings

PLAIN = 1e-2, 1e4
"""Sizes of values that are called as their sliders show them."""
FEW = 2
"""Changes by which a run is called where there is little room."""


def changes_of(settings: Settings, other: Settings) -> dict[str, Any]:
    """Give what differs from other settings of the same scene, by name."""
    before = other.values()
    return {name: value for name, value in settings.values().items() if value != before[name]}


def label_of(settings: Settings, changed: dict[str, Any], most: int = FEW) -> str:
    """Name settings by what is new in them, or by the first few of it."""
    definitions = settings.definitions()
    parts = []
    for name, value in list(changed.items())[:most]:
        parts.append(f"{name.replace('_', ' ')} {_written(value, about(definitions[name]).unit)}")
    more = len(changed) - most
    return ", ".join(parts) + (f" and {more} more" if more > 0 else "")


def _written(value: Any, unit: str) -> str:
    if isinstance(value, bool):
        return ("off", "on")[value]
    if isinstance(value, tuple):
        return "points"
    if not isinstance(value, float):
        return f"{value} {unit}".strip()
    is_plain = value == 0.0 or PLAIN[0] <= abs(value) < PLAIN[1]
    return f"{value:.4g} {unit}".strip() if is_plain else measured(value, unit, 4)


def in_titles(settings: Settings, text: str, written: str = "{}") -> str:
    """Call settings in a text what the sidebar calls them; one word may be just that."""
    for name, definition in settings.definitions().items():
        if "_" in name:
            text = re.sub(rf"\b{name}\b", written.format(about(definition).title), text)
    return text
