"""Definitions of settings: kinds, groups, help, and properties for widgets.

Widgets, address, command line and saved files all derive from these definitions.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import param

Rows = tuple[tuple[float, ...], ...]
Parameter = param.Parameter[Any]
ANY = -1e15, 1e15
POSITIVE = ANY, (0.0, 1e15)
"""Bounds of both columns of a path without values below zero."""


@dataclass(frozen=True)
class SettingProperties:
    """Properties of a setting besides its value, for page and command line.

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
    """A preset of any kind of setting: an object with a description."""

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
        """Check whether the curve is a path: an increasing abscissa, and one value."""
        return len(self.columns) == 2


class TextParameter(Parameter):
    """A text: one of a few presets, or another text that the scene understands.

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


def properties_of(parameter: Parameter) -> SettingProperties:
    """Properties of a setting, from its definition."""
    record: SettingProperties = parameter.metadata["about"]
    return record


def help_of(definition: Parameter) -> str:
    """Help of a setting with a line on each of its presets, as one paragraph."""
    lines = [f"{line}." for line in lines_of(definition)]
    return " ".join([definition.doc or "", *lines])


def lines_of(definition: Parameter) -> list[str]:
    """Descriptions of the presets of a setting, each after its name."""
    presets = properties_of(definition).presets
    return [f"{named_preset(preset)}: {line}" for preset, line in presets.items()]


def named_preset(preset: str) -> str:
    """Name of a preset in a sentence: "nothing" for an empty text."""
    return preset or "nothing"


def title_of(definition: Parameter) -> str:
    """Label of a setting on its widget."""
    return definition.label or ""


def names_of(definition: Parameter) -> list[str]:
    """Names of the values of a setting; empty if they are numbers."""
    if isinstance(definition, param.Boolean):
        return ["false", "true"]
    if isinstance(definition, CurveParameter | TextParameter):
        return list(definition.presets)
    if isinstance(definition, param.Selector):
        return list(definition.objects)
    return []


def is_logarithmic(definition: Any) -> bool:
    """Check whether a slider is logarithmic: if its range is far more than a decade."""
    low, high = definition.softbounds
    ratio = 20
    if isinstance(definition, param.Integer):
        ratio = 100
    return bool(low > 0.0 and high >= ratio * low)


@dataclass(frozen=True)
class SettingGroup:
    """Heading of a group of settings, with a method for each kind of definition.

    Every definition has a help text. Further arguments are fields of
    `SettingProperties`, and `title`, the label of a widget that does not show the name
    of the setting.
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
        """Setting with one of a few names."""
        return param.Selector(
            default=default, objects=list(options), **self._common(doc, **record)
        )

    def preset(
        self, default: str, presets: Mapping[str, Described], doc: str, **record: Any
    ) -> param.Selector[str]:
        """Setting with one of a few presets, without tables."""
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
        """Path or table: name of a preset, or rows with units and bounds of columns."""
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
        """Text: a preset, or another text, of a kind that `others` describes."""
        common = self._common(doc, presets=presets, **record)
        return TextParameter(default, presets, others, is_file=is_file, **common)

    def _common(
        self, doc: str, title: str | None = None, **record: Any
    ) -> dict[str, Any]:
        """Arguments of param that all settings have."""
        metadata = {"about": SettingProperties(self.name, **record)}
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
    """Copy of a setting's definition, with changes, for some scenes."""
    # A copy, as all scenes share the definition.
    again = copy.copy(definition)
    again.default = default
    if slider is not None:
        again.softbounds = slider
    again.doc = doc or again.doc
    if title is not None:
        again.label = title
    again.metadata = {"about": replace(properties_of(definition), **record)}
    return again
