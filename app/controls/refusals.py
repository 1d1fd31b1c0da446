"""Refusals in the words of the page: titles for names, values in the units of their fields.

What a file or an address has is told in SI, as it stands there.
"""

from __future__ import annotations

import math
from typing import Any

import param

from app.components.form import item_of
from app.picture.labels import in_titles
from app.picture.units import BY_SIZE, SI, rounded, scale_of
from solver.definitions import CurveParameter, Parameter, SettingError, about, allowed
from solver.phrases import Amount, Phrase, joined
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE
from solver.settings import Settings

NO_FIELD = (1.0, "")
"""Of what has no unit."""
EXACT = 10
"""Digits of what is refused: one beside the end of a range is told from it."""
HUGE = 10**300
"""What is larger is no number to Python's floating point."""
CLOSE = 16
"""Halvings of a slider's way, by which the last value that holds is sought."""


def refused(
    refusal: RefusedError,
    settings: Settings,
    moved: str = "",
    value: Any = None,
    units: str = BY_SIZE,
) -> str:
    """Say what was refused and why.

    Parameters
    ----------
    refusal
        Of a setting, or of something else that was given.
    settings
        Those in force.
    moved, value
        The setting that was to change, and to what; another may be the one that it refuses.
    units
        One of `app.picture.units.SYSTEMS`.
    """
    definitions = settings.definitions()
    name, remedy = refusal.name, in_titles(settings, refusal.remedy)
    if name not in definitions:
        return Phrase("{}: {}. Allowed: {}.", written(refusal.value), remedy, refusal.allowed)
    title, field = about(definitions[name]).title, field_of(settings, name, units)
    limits = in_titles(settings, _in_field(_limits(refusal, definitions[name]), field))
    found = written(refusal.value, _of_number(definitions[name], field))
    if name == moved or moved not in definitions:
        return Phrase("{} cannot be {}: {}. Allowed: {}.", title, found, remedy, limits)
    own = (
        about(definitions[moved]).title,
        written(value, _of_number(definitions[moved], field_of(settings, moved, units))),
    )
    words = "{} cannot be {} while {} is {}. Allowed for this: {}; {}."
    return Phrase(words, *own, title, found, limits, remedy)


def refused_by_name(refusal: RefusedError, settings: Settings) -> str:
    """Say what a file or an address has that is refused, with its name there in brackets.

    What is no setting, or none that there is, is called what it is called there.
    """
    kinds = type(settings), *(entry.settings for entry in CATALOGUE.values())
    kind = next((one for one in kinds if refusal.name in one.definitions()), None)
    if kind is None:
        return str(refusal)
    definition = kind.definitions()[refusal.name]
    title = title_and_name(refusal.name, definition)
    field = scale_of(1.0, _unit_of(definition), SI)
    limits = _in_field(_limits(refusal, definition), field)
    found = written(refusal.value, _of_number(definition, field))
    return f"{title} cannot be {found}: {refusal.remedy}. Allowed: {limits}."


def field_of(settings: Settings, name: str, units: str) -> tuple[float, str]:
    """Give the unit in which the field of a setting stands, its size in SI before its name.

    It is that of the value, or of the slider's end if that is zero (`components/controls.js`); of
    a table that of its largest value.
    """
    definition, value = settings.definitions()[name], getattr(settings, name)
    size = 1.0
    if isinstance(value, float):
        size = abs(value) or definition.softbounds[1]
    elif isinstance(value, tuple):
        size = max(abs(one) for _, one in value)
    return scale_of(size, _unit_of(definition), units)


def _of_number(definition: Parameter, field: tuple[float, str]) -> tuple[float, str]:
    """Give the unit of a value: a number that stands for a table has none."""
    return NO_FIELD if isinstance(definition, CurveParameter) else field


def _unit_of(definition: Parameter) -> str:
    is_table = isinstance(definition, CurveParameter)
    return definition.units[1] if is_table else about(definition).unit


def _in_field(text: str, field: tuple[float, str]) -> str:
    """Write the amounts of a text as a field has them."""
    if isinstance(text, Amount):
        return written(text.value, field if text.unit else NO_FIELD)
    if isinstance(text, Phrase):
        return Phrase(text.template, *(_in_field(part, field) for part in text.parts))
    return text


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
        columns = definition.abscissa, definition.ordinate
        return Phrase("{}, or a table of {} and {}", joined(", ", definition.presets), *columns)
    return "on or off" if isinstance(definition, param.Boolean) else allowed(definition)


def written(value: object, field: tuple[float, str] = NO_FIELD) -> str:
    """Write a value as one would say it, a number in the unit of a field."""
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, list | tuple):
        return "this table"
    if isinstance(value, float) or (isinstance(value, int) and abs(value) < HUGE):
        factor, unit = field
        return f"{rounded(value / factor, EXACT)} {unit}".strip()
    text = str(value)
    return f"“{text if len(text) <= 40 else text[:37] + '...'}”"


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
