"""Refusals in the words of the page: titles for names, and no forms that only files have."""

from __future__ import annotations

import math
from typing import Any

import param

from app.components.form import item_of
from app.picture.labels import in_titles
from solver.definitions import CurveParameter, Parameter, SettingError, about, allowed
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE
from solver.settings import Settings

CLOSE = 16
"""Halvings of a slider's way, by which the last value that holds is sought."""


def refused(refusal: SettingError, settings: Settings, moved: str = "", value: Any = None) -> str:
    """Say what was refused and why.

    Parameters
    ----------
    refusal
        Of a setting, or of something else that was given.
    settings
        Those in force.
    moved, value
        The setting that was to change, and to what; another may be the one that it refuses.
    """
    definitions = settings.definitions()
    name, remedy = refusal.name, in_titles(settings, refusal.remedy)
    if name not in definitions:
        return f"{written(refusal.value)}: {remedy}. Allowed: {refusal.allowed}."
    definition, title = definitions[name], about(definitions[name]).title
    limits = in_titles(settings, _limits(refusal, definition))
    if name == moved or moved not in definitions:
        return f"{title} cannot be {written(refusal.value)}: {remedy}. Allowed: {limits}."
    own = f"{about(definitions[moved]).title} cannot be {written(value)}"
    return f"{own} while {title} is {written(refusal.value)}. Allowed for this: {limits}; {remedy}."


def refused_by_name(refusal: RefusedError, settings: Settings) -> str:
    """Say what a file or an address has that is refused, with its name there in brackets.

    What is no setting, or none that there is, is called what it is called there.
    """
    kinds = type(settings), *(entry.settings for entry in CATALOGUE.values())
    kind = next((one for one in kinds if refusal.name in one.definitions()), None)
    if kind is None:
        return str(refusal)
    definition = kind.definitions()[refusal.name]
    title, value = title_and_name(refusal.name, definition), written(refusal.value)
    limits = _limits(refusal, definition)
    return f"{title} cannot be {value}: {refusal.remedy}. Allowed: {limits}."


def _limits(refusal: RefusedError, definition: Parameter) -> str:
    return allowed_here(definition) if refusal.allowed == allowed(definition) else refusal.allowed


def title_and_name(name: str, definition: Parameter) -> str:
    """Call a setting what the page calls it and, where that is another word, what a file does."""
    title = about(definition).title
    return title if title.lower() == name else f"{title} ({name})"


def sentence(remedy: str) -> str:
    """Give a remedy by itself."""
    return f"{remedy[:1].upper()}{remedy[1:]}."


def allowed_here(definition: Parameter) -> str:
    """Describe which values a setting takes, as its control offers them."""
    if isinstance(definition, CurveParameter):
        table = f"a table of {definition.abscissa} and {definition.ordinate}"
        return f"{', '.join(definition.presets)}, or {table}"
    return "on or off" if isinstance(definition, param.Boolean) else allowed(definition)


def written(value: object) -> str:
    """Write a value as one would say it."""
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, list | tuple):
        return "this table"
    text = str(value)
    return text if isinstance(value, int) else f"“{text if len(text) <= 40 else text[:37] + '...'}”"


def last_that_holds(settings: Settings, name: str, value: float) -> float | None:
    """Give the value nearest to one that is refused, on the way of its slider from what holds."""
    item = item_of(name, settings.definitions()[name])
    if item is None or item["kind"] != "slider":
        return None
    is_log = item["log"] and value > 0.0 and getattr(settings, name) > 0.0
    good, bad = (
        math.log10(one) if is_log else float(one) for one in (getattr(settings, name), value)
    )
    found = None
    for _ in range(CLOSE):
        middle = (good + bad) / 2.0
        tried = _settled(item, 10.0**middle if is_log else middle)
        try:
            settings.with_change(name, tried)
            good, found = middle, tried
        except SettingError:
            bad = middle
    return found


def _settled(item: dict[str, Any], value: float) -> float:
    """Give a value as round as the slider gives it (`components/values.js`)."""
    if item["whole"]:
        return round(value)
    if item["log"]:
        return float(f"{value:.4g}")
    return float(f"{round(value / item['step']) * item['step']:.12g}")
