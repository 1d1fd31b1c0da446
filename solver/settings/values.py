"""Values of settings: what is allowed, checks, refusals in words, reading from text."""

from __future__ import annotations

import difflib
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from textwrap import shorten
from typing import Any

import param

from solver.refusal import LONGEST, RefusedError, is_number, plain
from solver.settings.definitions import (
    CurveParameter,
    Parameter,
    Rows,
    TextParameter,
    named_preset,
    properties_of,
    title_of,
)

FAR = 1e6
"""Bound from which on a message calls a range unlimited: no problem has such values."""


@dataclass(frozen=True)
class Removed:
    """A setting of early versions that exists no more.

    Attributes
    ----------
    reason
        What came in its place, a clause.
    neutral
        The value without effect, which saved files may have.
    """

    reason: str
    neutral: object


REMOVED = {
    "interpolation": Removed("paths are linear between their points", "linear"),
    "k_friction_scale": Removed("k_scale is for all interfaces", 1.0),
    "k_normal_scale": Removed("k_scale is for all interfaces", 1.0),
    "k_update": Removed("the automatic search direction suits sooner", "none"),
}
"""Settings of early versions that exist no more, by name."""
NEAREST = 3
"""Largest number of settings that the refusal of an unknown name proposes."""
ALIKE = 0.5
"""Smallest likeness of a setting that the refusal of an unknown name proposes."""
MEANING = 70
"""Largest number of characters of the meaning of a proposed setting."""


class SettingError(RefusedError):
    """A refused setting."""


Refuse = Callable[[str], SettingError]
"""Function from a remedy to the refusal of a value."""


def allowed(definition: Parameter) -> str:
    """Description of the allowed values of a setting."""
    if isinstance(definition, CurveParameter):
        return f"{', '.join(definition.presets)}, or {_allowed_rows(definition)}"
    if isinstance(definition, TextParameter):
        presets = map(named_preset, definition.presets)
        return ", ".join([*presets, f"or {definition.others}"])
    if isinstance(definition, param.Boolean):
        return "true or false"
    if isinstance(definition, param.Selector):
        return ", ".join(definition.objects)
    return _allowed_numbers(definition)


def _allowed_rows(definition: CurveParameter) -> str:
    """Description of the allowed rows of a table."""
    if definition.is_path:
        return f"pairs [[{', '.join(definition.columns)}], ...]"
    heads = []
    for column, unit in zip(definition.columns, definition.units, strict=True):
        if unit:
            heads.append(f"{column} in {unit}")
        else:
            heads.append(column)
    return f"rows [[{', '.join(heads)}], ...]"


def _allowed_numbers(definition: Any) -> str:
    """Description of the range of a number."""
    low, high = definition.bounds
    unit = properties_of(definition).unit
    minimum = f"{plain(low)} {unit}".strip()
    maximum = f"{plain(high)} {unit}".strip()
    if isinstance(definition, param.Integer):
        return f"a whole number from {minimum} to {maximum}"
    if high < FAR:
        return f"a number from {minimum} to {maximum}"
    if low < 0.0:
        return f"any number (at most {maximum} in size)"
    if low > 0.0:
        return f"any number above 0 (from {minimum} to {maximum})"
    return f"any number from 0 on (to {maximum})"


def had_no_effect(name: str, value: object) -> bool:
    """Check whether a value is that of a removed setting that had no effect."""
    return name in REMOVED and value == REMOVED[name].neutral


def unknown_setting(
    name: str, value: object, scene: str, known: Mapping[str, Parameter]
) -> SettingError:
    """Refusal of an unknown name, with the most similar settings and their meaning."""
    can = f"a setting of {scene}"
    if name in REMOVED:
        return SettingError(
            name, value, can, f"it is gone: {REMOVED[name].reason}; leave it out"
        )
    likeness = {other: _likeness(name, other, known[other]) for other in known}
    near = [other for other in likeness if likeness[other] >= ALIKE]
    near.sort(key=lambda other: -likeness[other])
    remedy = "correct the name or leave it out"
    if near:
        proposals = [f"{other} ({_meaning(known[other])})" for other in near[:NEAREST]]
        remedy = f"did you mean {', or '.join(proposals)}?"
    return SettingError(name, value, can, f"there is no such setting, {remedy}")


def _likeness(name: str, other: str, definition: Parameter) -> float:
    """Similarity of a name to a setting: in spelling, in words, in meaning."""
    # Whole files have been given as a name, and are compared for seconds.
    name = name[:LONGEST].lower()
    spelling = difflib.SequenceMatcher(None, name, other).ratio()
    words = set(name.split("_"))
    # People mistype a name, turn its words round, or call a setting by its meaning.
    in_name = words & set(other.split("_"))
    meaning = f"{title_of(definition)} {_meaning(definition)}".lower()
    in_meaning = words & set(re.findall(r"\w+", meaning))
    return spelling + (0.4 * len(in_name) + 0.5 * len(in_meaning)) / len(words)


def _meaning(definition: Parameter) -> str:
    """First clause of the help of a setting, or the names of its choices."""
    if isinstance(definition, param.Selector):
        return f"one of {allowed(definition)}"
    clause = re.split(r"[.:;,]", definition.doc or "", maxsplit=1)[0]
    return shorten(clause, MEANING, placeholder="...")


def checked_value(definition: Parameter, name: str, value: object) -> Any:
    """Value of a setting in its own type; refuse a wrong type or range."""
    if isinstance(definition, CurveParameter):
        return _checked_curve(definition, name, value)
    refuse = _refusing(definition, name, value)
    if isinstance(definition, param.Boolean):
        if not isinstance(value, bool):
            raise refuse("write true or false")
        return value
    if isinstance(definition, param.Selector):
        if value not in definition.objects:
            if len(definition.objects) == 1:
                raise refuse("this scene has no other")
            raise refuse("choose one of these")
        return value
    if isinstance(definition, TextParameter):
        if not isinstance(value, str):
            raise refuse("write a text")
        return value
    if not is_number(value):
        raise refuse("write a number")
    low, high = definition.bounds
    if not low <= value <= high:
        raise refuse("choose a value inside this range")
    if not isinstance(definition, param.Integer):
        return float(value)
    if value != int(value):
        raise refuse("write a whole number")
    return int(value)


def _refusing(definition: Parameter, name: str, value: object) -> Refuse:
    """Function that makes the refusal of a value from a remedy."""
    return lambda remedy: SettingError(name, value, allowed(definition), remedy)


def _checked_curve(definition: CurveParameter, name: str, value: object) -> str | Rows:
    """Name of a preset, or rows of numbers; refuse other values."""
    if isinstance(value, str) and value in definition.presets:
        return value
    refuse = _refusing(definition, name, value)
    if isinstance(value, str):
        raise refuse("choose a preset, or give a table of points")
    if not isinstance(value, list | tuple) or not value:
        raise refuse(f"give at least one {'pair' if definition.is_path else 'row'}")
    rows: list[tuple[float, ...]] = []
    # Row by row, so that a refusal names the first that is wrong.
    for number in range(1, len(value) + 1):
        rows.append(_checked_row(definition, name, value, number))
        if definition.is_path and number > 1 and rows[-1][0] <= rows[-2][0]:
            raise refuse(
                f"row {number}: {definition.abscissa} must increase from row to row"
            )
    return tuple(rows)


def _checked_row(
    definition: CurveParameter, name: str, value: Sequence[Any], number: int
) -> tuple[float, ...]:
    """Numbers of a row of a table; refuse other values with the row's number from 1."""
    refuse = _refusing(definition, name, value)
    row = value[number - 1]
    n_columns = len(definition.columns)
    if not isinstance(row, list | tuple) or len(row) != n_columns:
        # Most curves have two columns, which people call a pair.
        expected = f"{n_columns} numbers"
        if definition.is_path:
            expected = "a pair of numbers"
        raise refuse(f"row {number} must be {expected}")
    if not all(is_number(entry) for entry in row):
        raise refuse(f"row {number} has an entry that is not a number")
    for index, entry in enumerate(row):
        column = definition.columns[index]
        unit = definition.units[index]
        low, high = definition.bounds[index]
        if entry < low == 0.0:
            can = f"{column}s of at least 0 {unit}".rstrip()
            raise SettingError(name, value, can, f"raise the negative {column}")
        is_counted = isinstance(low, int)
        if not low <= entry <= high or (is_counted and entry != int(entry)):
            kind = "a number"
            if is_counted:
                kind = "a whole number"
            minimum = f"{plain(low)} {unit}".strip()
            maximum = f"{plain(high)} {unit}".strip()
            raise refuse(
                f"row {number}: {column} is {plain(entry)}, give {kind} "
                f"from {minimum} to {maximum}"
            )
    return tuple(float(entry) for entry in row)


def parse(text: str) -> object:
    """Parse a value from text, as typed on a command line or in an address."""
    try:
        table: dict[str, object] = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        # It is no TOML, has digits beyond Python's limit, or is nested too deeply.
        return text
    if len(table) == 1:
        return table["value"]
    return text
