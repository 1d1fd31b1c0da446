"""Definitions of settings: which values a setting takes, and how they are read and checked.

Widgets, address, command line and saved files all derive from these definitions.
"""

from __future__ import annotations

import copy
import difflib
import re
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
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
"""Numbers from here on are no limits to anybody's problem, but to the digits of a
computer."""


GONE = {
    "interpolation": "paths are linear between their points",
    "k_friction_scale": "k_scale is for all interfaces",
    "k_normal_scale": "k_scale is for all interfaces",
}
"""Settings that files of early versions have, and why there are none any more."""
NEAREST = 3
"""Settings that are named, at most, where a name is unknown."""
ALIKE = 0.5
"""Likeness from which on another name may have been meant."""
MEANING = 70
"""Characters of the meaning of each."""


class SettingError(RefusedError):
    """A refused setting."""


@dataclass(frozen=True)
class About:
    """What a front needs to know of a setting beyond its value.

    Attributes
    ----------
    group
        Heading under which it stands.
    unit
        SI unit, empty for a pure number.
    applies
        Whether it does anything, given all the settings.
    path
        Setting of the path over time that reaches this value: where it is a table, that
        has its own size, and this value does nothing.
    places
        What it places or scales in a picture: "right x" along a side, "body"
        throughout.
    presets
        A line on each of the presets that it has, by name, without a full stop.
    """

    group: str
    unit: str = ""
    applies: Callable[[Any], bool] = lambda settings: True
    path: str = ""
    places: tuple[str, ...] = ()
    presets: Mapping[str, str] = field(default_factory=dict)


class Described(Protocol):
    """A preset, whatever it makes."""

    @property
    def description(self) -> str:
        """A line on it, without a full stop."""


@dataclass(frozen=True)
class TablePreset:
    """A table with a name: a line on it, and rows that the settings make."""

    description: str
    rows: Callable[[Any], Rows]


class CurveParameter(Parameter):
    """A path given by a preset's name or by pairs (abscissa, value), linear in between.

    With more than two columns it is a table, whose rows stand in any order.

    Attributes
    ----------
    presets
        By name: a path over time is a `load_paths.Preset`, others are a `TablePreset`.
    columns, units
        Names of the columns, and their units, empty for a pure number.
    bounds
        Ends of the columns, of integers for whole numbers.
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
        """What the first column has."""
        return str(self.columns[0])

    @property
    def is_path(self) -> bool:
        """Return whether it has an abscissa, which increases, and one value."""
        return len(self.columns) == 2


def about(parameter: Parameter) -> About:
    """Record of a setting's definition."""
    record: About = parameter.metadata["about"]
    return record


def help_of(definition: Parameter) -> str:
    """Help of a setting with a line on each of its presets, as one paragraph."""
    lines = (f"{name}: {line}." for name, line in about(definition).presets.items())
    return " ".join([definition.doc or "", *lines])


def title_of(definition: Parameter) -> str:
    """What a widget calls a setting."""
    return definition.label or ""


def is_logarithmic(definition: Any) -> bool:
    """Return whether a slider over a number is logarithmic: where it goes over far more than a decade."""
    low, high = definition.softbounds
    return bool(
        low > 0.0
        and high >= (100 if isinstance(definition, param.Integer) else 20) * low
    )


@dataclass(frozen=True)
class SettingGroup:
    """Heading under which settings stand, which makes their definitions.

    All have help; what else they take are entries of `About`, and a `title` where a
    widget does not call a setting by its name.
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
        """Path or table: a preset's name or rows, with unit and bounds of each column."""
        bounds = bounds or [ANY] * len(units)
        common = self._common(doc, presets=_lines_on(presets), **record)
        return CurveParameter(default, presets, units, bounds, **common)

    def _common(
        self, doc: str, title: str | None = None, **record: Any
    ) -> dict[str, Any]:
        """Arguments of param that all settings have."""
        metadata = {"about": About(self.name, **record)}
        return {"doc": doc, "label": title, "constant": True, "metadata": metadata}


def _lines_on(presets: Mapping[str, Described]) -> dict[str, str]:
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
    """Setting for some scenes, with another default, slider, help and entries of `About`."""
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
    """Words on which values a setting takes."""
    if isinstance(definition, CurveParameter):
        rows = f"pairs [[{', '.join(definition.columns)}], ...]"
        if not definition.is_path:
            units = (f" in {unit}" if unit else "" for unit in definition.units)
            heads = map("".join, zip(definition.columns, units, strict=True))
            rows = f"rows [[{', '.join(heads)}], ...]"
        return f"{', '.join(definition.presets)}, or {rows}"
    if isinstance(definition, param.Boolean):
        return "true or false"
    if isinstance(definition, param.Selector):
        return ", ".join(definition.objects)
    low, high = definition.bounds
    least, most = (
        f"{plain(end)} {about(definition).unit}".strip() for end in (low, high)
    )
    if isinstance(definition, param.Integer):
        return f"a whole number from {least} to {most}"
    if high < FAR:
        return f"a number from {least} to {most}"
    if low < 0.0:
        return f"any number (at most {most} in size)"
    if low > 0.0:
        return f"any number above 0 (from {least} to {most})"
    return f"any number from 0 on (to {most})"


def unknown(
    name: str, value: object, scene: str, known: Mapping[str, Parameter]
) -> SettingError:
    """Refusal of a name that no setting of a scene has, with the nearest ones and their meaning."""
    own = f"a setting of {scene}"
    if name in GONE:
        return SettingError(name, value, own, f"it is gone: {GONE[name]}; leave it out")
    likeness = {other: _likeness(name, other, known[other]) for other in known}
    near = [other for other in likeness if likeness[other] >= ALIKE]
    near.sort(key=lambda other: -likeness[other])
    remedy = "correct the name or leave it out"
    if near:
        told = [f"{other} ({_meaning(known[other])})" for other in near[:NEAREST]]
        remedy = f"did you mean {', or '.join(told)}?"
    return SettingError(name, value, own, f"there is no such setting, {remedy}")


def _likeness(name: str, other: str, definition: Parameter) -> float:
    """Likeness of a name to that of a setting: in spelling, in words, in words of its meaning."""
    spelling = difflib.SequenceMatcher(None, name.lower(), other).ratio()
    words = set(name.lower().split("_"))
    in_name = words & set(other.split("_"))
    meaning = f"{title_of(definition)} {_meaning(definition)}".lower()
    in_meaning = words & set(re.findall(r"\w+", meaning))
    return spelling + (0.4 * len(in_name) + 0.5 * len(in_meaning)) / len(words)


def _meaning(definition: Parameter) -> str:
    """First clause of the help of a setting, or the names that it is one of."""
    if isinstance(definition, param.Selector):
        return f"one of {allowed(definition)}"
    clause = re.split(r"[.:;,]", definition.doc or "", maxsplit=1)[0]
    return shorten(clause, MEANING, placeholder="...")


def checked_value(definition: Parameter, name: str, value: object) -> Any:
    """Value of a setting in its own type; a wrong type, or one out of range, is refused."""
    if isinstance(definition, CurveParameter):
        return _checked_curve(definition, name, value)

    def refuse(remedy: str) -> SettingError:
        return SettingError(name, value, allowed(definition), remedy)

    if isinstance(definition, param.Boolean):
        if not isinstance(value, bool):
            raise refuse("write true or false")
        return value
    if isinstance(definition, param.Selector):
        if value not in definition.objects:
            raise refuse("choose one of these")
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


def _checked_curve(definition: CurveParameter, name: str, value: object) -> str | Rows:
    if isinstance(value, str) and value in definition.presets:
        return value
    refuse = partial(SettingError, name, value, allowed(definition))
    if isinstance(value, str):
        raise refuse("choose a preset, or give a table of points")
    if not isinstance(value, list | tuple) or not value:
        raise refuse(f"give at least one {'pair' if definition.is_path else 'row'}")
    rows = []
    size = len(definition.columns)
    for number, row in enumerate(value, start=1):
        if not isinstance(row, list | tuple) or len(row) != size:
            if definition.is_path:
                what = "a pair of numbers"
            else:
                what = f"{size} numbers"
            raise refuse(f"row {number} must be {what}")
        if not all(map(is_number, row)):
            raise refuse(f"row {number} has an entry that is not a number")
        columns = definition.columns, definition.units, definition.bounds
        for entry, column, unit, (low, high) in zip(row, *columns, strict=True):
            if entry < low == 0.0:
                least = f"{column}s of at least 0 {unit}".rstrip()
                raise SettingError(name, value, least, f"raise the negative {column}")
            is_counted = isinstance(low, int)
            if not low <= entry <= high or (is_counted and entry != int(entry)):
                if is_counted:
                    kind = "a whole number"
                else:
                    kind = "a number"
                ends = " to ".join(
                    f"{plain(end)} {unit}".strip() for end in (low, high)
                )
                raise refuse(
                    f"row {number}: {column} is {plain(entry)}, give {kind} from {ends}"
                )
        rows.append(tuple(map(float, row)))
        if definition.is_path and number > 1 and rows[-1][0] <= rows[-2][0]:
            raise refuse(
                f"row {number}: {definition.abscissa} must increase from row to row"
            )
    return tuple(rows)


def parse(text: str) -> object:
    """Value of a setting from text, as typed on a command line or in an address."""
    try:
        table: dict[str, object] = tomllib.loads(f"value = {text}")
    except (
        ValueError,
        RecursionError,
    ):  # no TOML, digits beyond Python's limit, deep nesting
        return text
    if len(table) == 1:
        return table["value"]
    return text
