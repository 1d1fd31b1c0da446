"""Refusals in terms of the page: titles of controls, values in their units."""

from __future__ import annotations

import re
from typing import Any

from app.units import units_of_points
from solver.files.amounts import Unit, number, unit_for, unit_of
from solver.refusal import RefusedError, Words
from solver.settings.definitions import CurveParameter, properties_of, title_of
from solver.settings.scene import Settings
from solver.settings.values import allowed

EXACT = 10
"""Digits of a refused value: it differs from the end of a range even close to it."""
LONGEST = 40
"""Largest number of characters of a refused text that are shown."""
POWER = r"(?<![\w.])-?\d+(?:\.\d+)?e[-+]?\d+\b"
AMOUNT = rf"({POWER}) (m|N|Pa|J)(?![\w/^·])"
"""Amounts in SI that have a power of ten, which another unit makes readable."""
NUMBER = r"(?<![\w.])(-?\d+(?:\.\d+)?(?:e[-+]?\d+)?)(?![\w.])"


def message_of(
    refusal: RefusedError, settings: Settings, name: str = "", value: Any = None
) -> str:
    """A sentence on a refusal: setting, value, reason, allowed values.

    Where the setting `name` was to change to `value`, the refusal may be of another
    setting.
    """
    definitions = settings.definitions()
    remedy = in_titles(settings, refusal.remedy)
    definition = definitions.get(refusal.name)
    if definition is None:
        limits = in_titles(settings, refusal.allowed)
        refused = _written(refusal.value)
        # What is no setting may be named by words.
        subject = re.sub("^the ", "The ", refusal.name)
        return f"{subject} cannot be {refused}: {remedy}. Allowed: {limits}."
    title = title_of(definition)
    si, unit = _units(settings, refusal.name)
    limits = refusal.allowed
    if isinstance(definition, CurveParameter) and limits == allowed(definition):
        # As its widget offers them: presets, or a table.
        *others, last = definition.columns
        table = f"a table of {', '.join(others)} and {last}"
        limits = f"{', '.join(definition.presets)}, or {table}"
    limits = in_titles(settings, _in_unit(limits, si, unit))
    refused = _written(refusal.value, unit)
    if name in ("", refusal.name):
        return f"{title} cannot be {refused}: {remedy}. Allowed: {limits}."
    changed = title_of(definitions[name])
    wanted = _written(value, _units(settings, name)[1])
    return (
        f"{changed} cannot be {wanted} while {title} is {refused}: {remedy}. "
        f"Allowed for {title}: {limits}."
    )


def _units(settings: Settings, name: str) -> tuple[str, Unit]:
    """The SI unit of a setting's values, and the unit on the page."""
    definition = settings.definitions()[name]
    if isinstance(definition, CurveParameter):
        units = settings.curve_units(name)
        return units[1], units_of_points(settings.scene, name, units)[1]
    return properties_of(definition).unit, unit_of(definition)


def _in_unit(text: str, si: str, unit: Unit) -> str:
    """A text with amounts in an SI unit converted to another unit."""
    amounts = rf"{NUMBER} {re.escape(si)}(?![\w/^·])"
    if si:
        return re.sub(amounts, lambda match: unit(float(match[1]), EXACT), text)
    return text


def amounts_in_titles(settings: Settings, text: str) -> str:
    """A text with amounts of settings, as traction = 2e5 Pa, in units of their fields.

    Of choices, as finish=at-once, it has the title, too.
    """
    definitions = settings.definitions()

    def in_title(match: re.Match[str]) -> str:
        name = match[1]
        si, unit = _units(settings, name)
        # Another unit than that of the setting: the words mean something else.
        if si != (match[3] or ""):
            return match[0]
        return f"{title_of(definitions[name])} {unit(float(match[2]), EXACT)}"

    names = "|".join(definitions)
    text = re.sub(rf"\b({names}) = {NUMBER}(?: ([^\s,:()]+))?", in_title, text)
    return re.sub(
        rf"\b({names})=([\w-]+)",
        lambda match: f"{title_of(definitions[match[1]])} = {match[2]}",
        text,
    )


def _in_suitable_unit(amount: str, si: str) -> str:
    """An amount in an SI unit, in a unit of its size."""
    value = float(amount)
    return unit_for(abs(value), si)(value)


def in_titles(settings: Settings, text: str) -> str:
    """A text with titles for names of settings, and numbers as on the page."""
    definitions = settings.definitions()
    text = amounts_in_titles(settings, text)
    text = re.sub(AMOUNT, lambda match: _in_suitable_unit(*match.groups()), text)
    text = re.sub(
        f"{POWER}|{NUMBER}", lambda match: number(float(match[0]), EXACT), text
    )

    def titled(match: re.Match[str]) -> str:
        lead = match[1] or ""
        name = match[2]
        if lead or "_" in name:
            return lead + title_of(definitions[name])
        return match[0]

    # Many names are common words, as friction: they mean the setting where it is to be
    # lowered or raised.
    names = "|".join(definitions)
    return re.sub(rf"\b((?i:lower|raise|or|\d to) )?({names})\b", titled, text)


def _written(value: object, unit: Unit | None = None) -> str:
    """A value as text; a number in a unit."""
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, list | tuple):
        return "this table"
    if isinstance(value, int | float) and abs(value) < 1e300:
        return (unit or Unit(""))(value, EXACT)
    text = str(value)
    if isinstance(value, Words):
        return text
    if len(text) > LONGEST:
        text = f"{text[: LONGEST - 3]}..."
    return f"“{text}”"
