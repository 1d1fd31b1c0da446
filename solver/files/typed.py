"""Values of settings as people type them: in a command, an address, a field, a file.

Numbers are read as `numerals.py` says, with a unit of the setting's kind behind them:
`.5`, `1.`, `0,5`, `1 200`, `2 kN`, `50 %`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

import param

from solver.files.amounts import Unit, sizes_of
from solver.files.numerals import decimal_signs, leading_number, number
from solver.files.units import size_in
from solver.refusal import is_number
from solver.settings.definitions import CurveParameter, Parameter, properties_of
from solver.settings.values import SettingError, allowed, parse

SWITCHED = {
    "true": True,
    "on": True,
    "false": False,
    "off": False,
}
"""Values of a switch by words in small letters."""
_ENTRY = re.compile(r"[^\[\],\s]+")
"""Entries of a table in brackets."""


def typed_amount(text: str, unit: Unit, si: str) -> float:
    """Value in SI of a typed number, in a default unit or a typed one.

    Raises
    ------
    ValueError
        If the text is no number, or its unit is of another quantity; it says what to
        write instead.
    """
    value, behind = leading_number(text)
    if not math.isfinite(value):
        raise ValueError("write a number")
    sizes = {**sizes_of(si), "": unit.factor, unit.name: unit.factor}
    size = sizes.get(behind) or size_in(behind, si)
    # A second number is no unit, though heads of tables have 1 as one.
    if size is None or behind[:1].isdigit():
        raise ValueError(f"write a number {_in_unit(unit)}")
    return float(f"{value * size:.15g}")


def _in_unit(unit: Unit) -> str:
    """Words on a unit behind a number."""
    if unit.name:
        return f"in {unit.name}"
    return "without a unit"


def typed_value(text: str, name: str, definition: Parameter | None) -> Any:
    """Value in a typed text: of a setting by name, or of another name.

    What cannot be read stays a text, which the check of the setting refuses.

    Raises
    ------
    SettingError
        For a unit of another quantity, and for a comma that may stand between thousands
        or before decimals.
    """
    value = parse(text.strip())
    if isinstance(definition, param.Number):
        return _typed_number(value, name, definition)
    if not isinstance(value, str):
        return value
    if isinstance(definition, param.Boolean):
        return SWITCHED.get(value.lower(), value)
    if isinstance(definition, CurveParameter) and value.startswith("["):
        # Entries that TOML does not know, as `.5`, are written as it does.
        rows = parse(_ENTRY.sub(_plain_entry, value))
        if isinstance(rows, str):
            remedy = "write numbers between commas, and close each bracket"
            raise SettingError(name, value, allowed(definition), remedy)
        return rows
    return value


def typed_numbers(
    values: Mapping[str, Any], definitions: Mapping[str, Parameter]
) -> dict[str, Any]:
    """Values with numbers in place of texts of a file: "2 kN" as typed."""
    found = dict(values)
    for name, value in values.items():
        definition = definitions.get(name)
        if isinstance(definition, param.Number):
            found[name] = _typed_number(value, name, definition)
    return found


def _typed_number(value: object, name: str, definition: Parameter) -> object:
    """Number in a typed value of a setting; what is no text stays as it is."""
    if not isinstance(value, str):
        return value
    text = value.strip()
    si = properties_of(definition).unit
    can = allowed(definition)
    lead, behind = leading_number(text)
    numeral = text.removesuffix(behind).strip()
    if "," in numeral and len(decimal_signs(numeral)) > 1:
        whole = numeral.replace(",", "")
        decimal = numeral.replace(",", ".")
        remedy = f"write {whole} or {decimal}, as the comma may mean both"
        raise SettingError(name, value, can, remedy)
    if not math.isfinite(lead):
        return value
    try:
        return typed_amount(text, Unit(si), si)
    except ValueError as flaw:
        raise SettingError(name, value, can, str(flaw)) from None


def _plain_entry(entry: re.Match[str]) -> str:
    """Entry of a table as TOML writes numbers; one that is no number stays."""
    value = number(entry[0], ".")
    if is_number(parse(entry[0])) or not math.isfinite(value):
        return entry[0]
    return repr(value)
