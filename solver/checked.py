"""Settings as objects: checked once, at the edge, and unchangeable."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache, cached_property
from types import MappingProxyType
from typing import Any, ClassVar, Self

import param

from solver.definitions import Parameter, Retired, about, checked_value, unknown


class Checked(param.Parameterized):
    """Settings whose values hold alone and together.

    `checked` is the one edge at which values are verified; `replace` gives new settings.
    """

    scene: str = ""

    METHODS: ClassVar[Mapping[str, Mapping[str, object]]] = {}
    """What `method` sets; a scene that lacks an option keeps its own default."""

    RETIRED: ClassVar[Mapping[str, Retired]] = {}
    """Settings that there were."""

    method: Any
    """Name of one of the methods."""

    @classmethod
    @cache
    def definitions(cls) -> Mapping[str, Parameter]:
        """Give the definition of every setting, by name, in the order of their groups."""
        found = {
            name: cls.param[name]
            for name in cls.param
            if (cls.param[name].metadata or {}).get("about") is not None
        }
        return MappingProxyType(found)

    @classmethod
    @cache
    def _defaults(cls) -> Mapping[str, Any]:
        found = {name: definition.default for name, definition in cls.definitions().items()}
        return MappingProxyType(found)

    @classmethod
    def checked(cls, values: Mapping[str, object]) -> Self:
        """Check values and make a settings object of them.

        Parameters
        ----------
        values
            Plain values by name; what is left out takes its default, or what the method says.

        Raises
        ------
        SettingError
            For an unknown name, a wrong type, a value out of range, or values that do not fit
            together.
        """
        definitions, defaults = cls.definitions(), cls._defaults()
        clean = {}
        for name, value in values.items():
            if name in cls.RETIRED:
                cls.RETIRED[name].check(name, value)
                continue
            if name not in definitions:
                raise unknown(name, value, definitions)
            clean[name] = checked_value(definitions[name], name, value)
        values = {**cls.of_method(clean.get("method", defaults["method"])), **clean}
        # To tell param of a default takes as long as to tell it of anything else.
        settings = cls(**{name: one for name, one in values.items() if one is not defaults[name]})
        settings.check_together()
        return settings

    @classmethod
    def of_method(cls, method: str) -> dict[str, Any]:
        """Give the values of the settings that a method sets."""
        definitions = cls.definitions()
        found = {}
        for name, value in cls.METHODS[method].items():
            definition = definitions[name]
            is_option = not isinstance(definition, param.Selector) or value in definition.objects
            found[name] = value if is_option else definition.default
        return found

    @classmethod
    def usual(cls, method: str) -> dict[str, Any]:
        """Give every setting's value where nothing is said but the method."""
        return {**cls._defaults(), **cls.of_method(method)}

    def check_together(self) -> None:
        """Check what no setting can check alone; a scene extends this."""

    def values(self) -> dict[str, Any]:
        """Give every setting's plain value by name."""
        return dict(self._values)

    @cached_property
    def _values(self) -> Mapping[str, Any]:
        # To ask param for all of them takes longer than an iteration, and they never change.
        return {name: getattr(self, name) for name in self.definitions()}

    def changed(self, base: Self | None = None) -> dict[str, Any]:
        """Give the settings that differ from others, or from their defaults.

        Where the method differs too, those that it sets are compared with what it says.
        """
        usual = base.values() if base else self.usual(self.method)
        if base and base.method != self.method:
            usual.update(self.of_method(self.method))
        return {name: value for name, value in self._values.items() if value != usual[name]}

    def replace(self, /, **changes: object) -> Self:
        """Give new settings with some values changed, checked as a whole.

        Another method brings its own values of all that it sets.
        """
        values = self.values()
        if changes.get("method", self.method) != self.method:
            own = self.METHODS[self.method]
            values = {name: value for name, value in values.items() if name not in own}
        return self.checked({**values, **changes})

    def with_change(self, name: str, value: object) -> Self:
        """Change one setting and bring along those that could not stand beside it."""
        return self.replace(**{name: value})

    def curve_units(self, name: str) -> tuple[str, str]:
        """Units of a curve's abscissa and ordinate under the present values."""
        # Of the class: param copies what is read of an instance to it, and no pipe takes that.
        units: tuple[str, str] = type(self).param[name].units
        return units

    def applies(self, name: str) -> bool:
        """Tell whether a setting does anything under the present values."""
        return about(self.definitions()[name]).applies(self)


def dump(settings: Checked) -> str:
    """Write settings as the text of a TOML file that every front reads."""
    lines = [f"{name} = {json.dumps(value)}" for name, value in settings.values().items()]
    return "\n".join([f"scene = {json.dumps(settings.scene)}", *lines, ""])
