"""Refusals in the words of the page: titles in place of names, values in the units of fields."""

from __future__ import annotations

import math
import re
from typing import Any

import param

from app.units import Unit, number, unit_of, units_of_points
from solver.definitions import CurveParameter, Parameter, about, allowed
from solver.refusal import RefusedError
from solver.settings import Settings

EXACT = 10
"""Digits of what is refused: a value beside the end of a range is told from it."""
HALVINGS = 12
"""Of a slider's way, by which the last value that holds is sought."""
LONGEST = 40
"""Characters of a text that is refused."""
NUMBER = r"(?<![\w.])(-?\d+(?:\.\d+)?(?:e[-+]?\d+)?)(?![\w.])"


def message_of(refusal: RefusedError, settings: Settings, name: str = "", value: Any = None) -> str:
    """What was refused, why, and what is allowed, in a sentence.

    Parameters
    ----------
    refusal
        Of a setting, or of something else that was given.
    settings
        Those that hold.
    name, value
        The setting that was to change, and to what; another may be the one that is refused.
    """
    definitions = settings.definitions()
    remedy = _in_titles(settings, refusal.remedy)
    definition = definitions.get(refusal.name)
    if definition is None:
        limits = _in_titles(settings, refusal.allowed)
        return f"{refusal.name} cannot be {_written(refusal.value)}: {remedy}. Allowed: {limits}."
    title, unit = about(definition).title, _unit_of(settings, refusal.name)
    limits = _in_unit(_allowed(definition, refusal), _si_of(settings, refusal.name), unit)
    limits = _in_titles(settings, limits)
    refused = _written(refusal.value, unit)
    if name in ("", refusal.name):
        return f"{title} cannot be {refused}: {remedy}. Allowed: {limits}."
    changed = about(definitions[name]).title
    to = _written(value, _unit_of(settings, name))
    return (
        f"{changed} cannot be {to} while {title} is {refused}: {remedy}. "
        f"Allowed for {title}: {limits}."
    )


def _unit_of(settings: Settings, name: str) -> Unit:
    definition = settings.definitions()[name]
    if isinstance(definition, CurveParameter):
        return units_of_points(settings.scene, name, settings.curve_units(name))[1]
    return unit_of(definition)


def _si_of(settings: Settings, name: str) -> str:
    definition = settings.definitions()[name]
    is_curve = isinstance(definition, CurveParameter)
    return settings.curve_units(name)[1] if is_curve else about(definition).unit


def _allowed(definition: Parameter, refusal: RefusedError) -> str:
    """What a setting takes, as its widget offers it."""
    if refusal.allowed == allowed(definition) and isinstance(definition, CurveParameter):
        points = f"a table of {definition.abscissa} and {definition.ordinate}"
        return f"{', '.join(definition.presets)}, or {points}"
    return refusal.allowed


def _in_unit(text: str, si: str, unit: Unit) -> str:
    """A text with its amounts of an SI unit in another unit."""
    amounts = rf"{NUMBER} {re.escape(si)}(?![\w/^·])"
    return re.sub(amounts, lambda match: unit(float(match[1]), EXACT), text) if si else text


def _in_titles(settings: Settings, text: str) -> str:
    """A text with titles for names of settings, and with numbers as the page prints them."""
    definitions = settings.definitions()

    def titled(match: re.Match[str]) -> str:
        lead, name = match[1] or "", match[2]
        return lead + about(definitions[name]).title if lead or "_" in name else match[0]

    text = re.sub(NUMBER, lambda match: number(float(match[1]), EXACT), text)
    # Many names are common words: these mean the setting where it is to be lowered or raised.
    return re.sub(rf"\b(lower |raise |or |\d to )?({'|'.join(definitions)})\b", titled, text)


def _written(value: object, unit: Unit | None = None) -> str:
    """A value as one would say it, a number in a unit."""
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, list | tuple):
        return "this table"
    if isinstance(value, int | float) and abs(value) < 1e300:
        return (unit or Unit(""))(value, EXACT)
    text = str(value)
    return f"“{text if len(text) <= LONGEST else text[: LONGEST - 3] + '...'}”"


def nearest_allowed(settings: Settings, name: str, value: float) -> float:
    """The value that holds nearest to one that is refused, on the way there from what is set."""
    definition = settings.definitions()[name]
    start = float(getattr(settings, name))
    is_whole = isinstance(definition, param.Integer)
    is_log = about(definition).logarithmic and min(start, value) > 0.0
    good, bad = (math.log10(end) if is_log else end for end in (start, value))
    allowed_value = getattr(settings, name)
    for _ in range(HALVINGS):
        middle = 0.5 * (good + bad)
        candidate = 10.0**middle if is_log else middle
        candidate = round(candidate) if is_whole else float(f"{candidate:.3g}")
        try:
            settings.with_change(name, candidate)
            good, allowed_value = middle, candidate
        except RefusedError:
            bad = middle
    return allowed_value
