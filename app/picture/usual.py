"""What a page takes where nothing is said: as everywhere else, but that it shows the search."""

from __future__ import annotations

from functools import cache
from typing import Any

from solver.settings import Settings

WATCH, ANSWER = "accuracy", "at-once"
"""Values of `finish`: the method's own iterates until they are near, or a solution at once."""


@cache
def usual_settings(kind: type[Settings]) -> Settings:
    """Give the settings that a page begins a scene with."""
    return kind.checked({"finish": WATCH})


def usual_value(settings: Settings, name: str) -> Any:
    """Give what a setting usually is with the method that is chosen."""
    value = settings.usual(settings.method)[name]
    return WATCH if (name, value) == ("finish", ANSWER) else value


def shown(settings: Settings, before: Settings) -> Settings:
    """Have the search shown of a method that has taken the place of another."""
    if settings.method == before.method or settings.finish != ANSWER:
        return settings
    return settings.replace(finish=WATCH)


def hurried(settings: Settings) -> Settings:
    """Give the settings with which the answer is there at once."""
    return settings.replace(finish=ANSWER) if settings.finish == WATCH else settings


def changed(settings: Settings) -> dict[str, Any]:
    """Give the settings that differ from what is usual."""
    return settings.changed(usual_settings(type(settings)))
