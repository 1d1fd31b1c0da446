"""Two runs in step: which settings they have, and how an address and the sidebar call that."""

from __future__ import annotations

from typing import Any

from app.picture.usual import shown
from solver.definitions import SettingError
from solver.settings import Settings

AT_WORK = "the run at work, as A"
PRESETS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "monoscale | multiscale": (
        {"method": "paper", "multiscale": False},
        {"method": "paper", "multiscale": True},
    ),
    "full | PGD": (
        {"method": "paper", "linear_stage": "full"},
        {"method": "paper", "linear_stage": "pgd"},
    ),
    "paper | fast": ({"method": "paper"}, {"method": "fast"}),
}
"""What A and B have, whatever else is set; the method `fast` ends before the first two differ."""
CHOICES = {"nothing": "", **{name: name for name in (AT_WORK, *PRESETS)}}


def pair(choice: str, settings: Settings) -> tuple[Settings | None, Settings]:
    """Give the settings of runs A and B that a choice means, beside those in force.

    Raises
    ------
    SettingError
        If what tells A from B does nothing with these settings.
    """
    if not choice:
        return None, settings
    if choice == AT_WORK:
        return settings, settings
    mine, others = PRESETS[choice]
    if not all(settings.applies(name) for name in mine):
        raise SettingError(
            "the comparison", choice, "what differs with these settings", "cut the body first"
        )
    return _with(settings, mine), _with(settings, others)


def _with(settings: Settings, changes: dict[str, Any]) -> Settings:
    return shown(settings.replace(**changes), settings)


def choice_of(twin: Settings | None, settings: Settings) -> str:
    """Call the comparison of run A with these settings as the sidebar does."""
    if twin is None:
        return ""
    return next((name for name in PRESETS if _is_preset(name, twin, settings)), AT_WORK)


def _is_preset(name: str, twin: Settings, settings: Settings) -> bool:
    mine, others = PRESETS[name]
    a, b = _with(settings, mine), _with(settings, others)
    return (a.values(), b.values()) == (twin.values(), settings.values())
