"""Definitions of settings, and functions that read and check their values.

Widgets, address, command line and saved files all derive from these definitions.
"""

from __future__ import annotations

import copy
import difflib
import re
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from textwrap import shorten
from typing import Any, Protocol

import param

from solver.refusal import RefusedError, is_number, plain

Rows = tuple[tuple[float, ...], ...]
Parameter = param.Parameter[Any]
ANY = -1e15, 1e15
POSITIVE = ANY, (0.0, 1e15)
"""Bounds of both columns of a path without values below zero."""
FAR = 1e6
"""Bound from which on a message calls a range unlimited: no problem has such values."""


GONE = {
    "interpolation": "paths are linear between their points",
    "k_friction_scale": "k_scale is for all interfaces",
    "k_normal_scale": "k_scale is for all interfaces",
}
"""Settings of early versions that exist no more, with the reason."""
NEAREST = 3
"""Largest number of settings that the refusal of an unknown name proposes."""
ALIKE = 0.5
"""Smallest likeness of a setting that the refusal of an unknown name proposes."""
MEANING = 70
"""Largest number of characters of the meaning of a proposed setting."""


class SettingError(RefusedError):
    """A refused setting."""


@dataclass(frozen=True)
class About:
    """Properties of a setting that a front needs beside its value.

    Attributes
    ----------
    group
        Heading under which the setting stands.
    unit
        SI unit, empty for a pure number.
    applies
        Function of all settings: whether the setting changes anything.
    path
        Name of the setting of a path over time whose presets reach this value. A path
        that is a table has its own size, and this value does nothing.
    places
        Loads in a picture that the setting places or scales: "right x" along a side,
        "body" throughout.
    presets
        Descriptions of the presets of the setting by name, without a full stop.
    """

    group: str
    unit: str = ""
    applies: Callable[[Any], bool] = lambda settings: True
    path: str = ""
    places: tuple[str, ...] = ()
    presets: Mapping[str, str] = field(default_factory=dict)


class Described(Protocol):
    """A preset of any kind of setting."""

    @property
    def description(self) -> str:
        """Description in a line, without a full stop."""


@dataclass(frozen=True)
class TablePreset:
    """A preset of a table: its description, and a function from settings to rows."""

    description: str
    rows: Callable[[Any], Rows]


class CurveParameter(Parameter):
    """A path given by a preset's name or by pairs (abscissa, value), linear in between.

    A setting of more than two columns is a table, whose rows stand in any order.

    Attributes
    ----------
    presets
        Presets by name: of a path over time each is a `load_paths.Preset`, of others a
        `TablePreset`.
    columns, units
        Names of the columns, and their units, empty for a pure number.
    bounds
        Lower and upper bound of each column; integers for a column of whole numbers.
    """

    __slots__ = ["bounds", "columns", "presets", "units"]

    def __init__(
        self,
        default: str,
        presets: Mapping[str, Any],
        units: Mapping[str, str],
        bounds: Sequence[tuple[float, float]],
        **rest: Any,
    ) -> None:
        super().__init__(default=default, **rest)
        self.presets = presets
        self.bounds = bounds
        self.columns = tuple(units)
        self.units = tuple(units.values())

    @property
    def abscissa(self) -> str:
        """Name of the first column."""
        return str(self.columns[0])

    @property
    def is_path(self) -> bool:
        """Check whether rows are an abscissa, which increases, and one value."""
        return len(self.columns) == 2


class TextParameter(Parameter):
    """A text: one of a few presets, or another one that the scene understands.

    Attributes
    ----------
    presets
        Descriptions of the presets by name.
    others
        Words on all other texts that are allowed.
    is_file
        Whether other texts are contents of files.
    """

    __slots__ = ["is_file", "others", "presets"]

    def __init__(
        self,
        default: str,
        presets: Mapping[str, str],
        others: str,
        *,
        is_file: bool,
        **rest: Any,
    ) -> None:
        super().__init__(default=default, **rest)
        self.presets = presets
        self.others = others
        self.is_file = is_file


def about(parameter: Parameter) -> About:
    """Properties of a setting that a front needs, from its definition."""
    record: About = parameter.metadata["about"]
    return record


def help_of(definition: Parameter) -> str:
    """Help of a setting with a line on each of its presets, as one paragraph."""
    lines = (f"{name}: {line}." for name, line in about(definition).presets.items())
    return " ".join([definition.doc or "", *lines])


def title_of(definition: Parameter) -> str:
    """Label of a setting on its widget."""
    return definition.label or ""


def is_logarithmic(definition: Any) -> bool:
    """Check whether a slider is logarithmic: its range is far more than a decade."""
    low, high = definition.softbounds
    ratio = 20
    if isinstance(definition, param.Integer):
        ratio = 100
    return bool(low > 0.0 and high >= ratio * low)


@dataclass(frozen=True)
class SettingGroup:
    """Heading of a group of settings, with a method for each kind of definition.

    Every definition has a help text. Further arguments are fields of `About`, and
    `title`, the label of a widget that does not show the name of the setting.
    """

    name: str

    def quantity(
        self,
        default: float,
        bounds: tuple[float, float],
        slider: tuple[float, float],
        doc: str,
        **record: Any,
    ) -> param.Number[float]:
        """Real setting: hard `bounds`, and the range that a `slider` shows."""
        common = self._common(doc, **record)
        return param.Number(default=default, bounds=bounds, softbounds=slider, **common)

    def count(
        self,
        default: int,
        bounds: tuple[int, int],
        slider: tuple[int, int],
        doc: str,
        **record: Any,
    ) -> param.Integer[int]:
        """Whole-number setting."""
        common = self._common(doc, **record)
        return param.Integer(
            default=default, bounds=bounds, softbounds=slider, **common
        )

    def switch(self, default: bool, doc: str, **record: Any) -> param.Boolean[bool]:
        """On/off setting."""
        return param.Boolean(default=default, **self._common(doc, **record))

    def choice(
        self, default: str, options: Iterable[str], doc: str, **record: Any
    ) -> param.Selector[str]:
        """Setting that is one of a few names."""
        return param.Selector(
            default=default, objects=list(options), **self._common(doc, **record)
        )

    def preset(
        self, default: str, presets: Mapping[str, Described], doc: str, **record: Any
    ) -> param.Selector[str]:
        """Setting that is one of a few presets, and no table."""
        return self.choice(default, presets, doc, presets=_lines_on(presets), **record)

    def curve(
        self,
        default: str,
        presets: Mapping[str, Described],
        units: Mapping[str, str],
        doc: str,
        *,
        bounds: Sequence[tuple[float, float]] = (),
        **record: Any,
    ) -> CurveParameter:
        """Path or table: a preset's name, or rows with units and bounds of columns."""
        bounds = bounds or [ANY] * len(units)
        common = self._common(doc, presets=_lines_on(presets), **record)
        return CurveParameter(default, presets, units, bounds, **common)

    def text(
        self,
        default: str,
        presets: Mapping[str, str],
        others: str,
        doc: str,
        *,
        is_file: bool = False,
        **record: Any,
    ) -> TextParameter:
        """Text: a preset, or one of `others`; the scene says which it understands."""
        common = self._common(doc, presets=presets, **record)
        return TextParameter(default, presets, others, is_file=is_file, **common)

    def _common(
        self, doc: str, title: str | None = None, **record: Any
    ) -> dict[str, Any]:
        """Arguments of param that all settings have."""
        metadata = {"about": About(self.name, **record)}
        return {"doc": doc, "label": title, "constant": True, "metadata": metadata}


def _lines_on(presets: Mapping[str, Described]) -> dict[str, str]:
    """Descriptions of presets by name."""
    return {name: preset.description for name, preset in presets.items()}


CONTACT = SettingGroup("Contact")
LOAD = SettingGroup("Load")
BODY = SettingGroup("Body")
METHOD = SettingGroup("Method")
DECOMPOSITION = SettingGroup("Decomposition")


def redefined(
    definition: Any,
    default: object,
    slider: tuple[float, float] | None = None,
    doc: str = "",
    title: str | None = None,
    **record: Any,
) -> Any:
    """Define a setting anew for some scenes, with changes to its definition."""
    # A copy, as all scenes share the definition.
    again = copy.copy(definition)
    again.default = default
    if slider is not None:
        again.softbounds = slider
    again.doc = doc or again.doc
    if title is not None:
        again.label = title
    again.metadata = {"about": replace(about(definition), **record)}
    return again


def allowed(definition: Parameter) -> str:
    """Words on the values that a setting takes."""
    if isinstance(definition, CurveParameter):
        return f"{', '.join(definition.presets)}, or {_allowed_rows(definition)}"
    if isinstance(definition, TextParameter):
        return ", ".join([*definition.presets, f"or {definition.others}"])
    if isinstance(definition, param.Boolean):
        return "true or false"
    if isinstance(definition, param.Selector):
        return ", ".join(definition.objects)
    return _allowed_numbers(definition)


def _allowed_rows(definition: CurveParameter) -> str:
    """Words on the rows of a table."""
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
    """Words on the range of a number."""
    low, high = definition.bounds
    unit = about(definition).unit
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


def unknown(
    name: str, value: object, scene: str, known: Mapping[str, Parameter]
) -> SettingError:
    """Refusal of an unknown name, with settings of similar names and their meaning."""
    can = f"a setting of {scene}"
    if name in GONE:
        return SettingError(name, value, can, f"it is gone: {GONE[name]}; leave it out")
    likeness = {other: _likeness(name, other, known[other]) for other in known}
    near = [other for other in likeness if likeness[other] >= ALIKE]
    near.sort(key=lambda other: -likeness[other])
    remedy = "correct the name or leave it out"
    if near:
        proposals = [f"{other} ({_meaning(known[other])})" for other in near[:NEAREST]]
        remedy = f"did you mean {', or '.join(proposals)}?"
    return SettingError(name, value, can, f"there is no such setting, {remedy}")


def _likeness(name: str, other: str, definition: Parameter) -> float:
    """Likeness of a name to a setting in spelling, in words, and in its meaning."""
    spelling = difflib.SequenceMatcher(None, name.lower(), other).ratio()
    words = set(name.lower().split("_"))
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


Refuse = Callable[[str], SettingError]
"""Refusal of a value, made from the remedy."""


def _refusing(definition: Parameter, name: str, value: object) -> Refuse:
    """Make the function from a remedy to the refusal of a value."""
    return lambda remedy: SettingError(name, value, allowed(definition), remedy)


def _checked_curve(definition: CurveParameter, name: str, value: object) -> str | Rows:
    """Preset, or rows of numbers; refuse others."""
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
    """Numbers of a row of a table, by the row's number from 1 on; refuse others."""
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
    """Value of a setting from text, as typed on a command line or in an address."""
    try:
        table: dict[str, object] = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        # It is no TOML, has digits beyond Python's limit, or is nested too deeply.
        return text
    if len(table) == 1:
        return table["value"]
    return text
