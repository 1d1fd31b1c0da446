"""Settings as objects: checked once, at the edge, and unchangeable."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache, cached_property
from types import MappingProxyType
from typing import Any, ClassVar, Self

import param

from solver.definitions import SettingError, about, checked_value, unknown


class Checked(param.Parameterized):
    """Settings whose values hold alone and together.

    `checked` is the one edge at which values are verified; `replace` gives new settings.
    """

    scene: str = ""

    METHODS: ClassVar[Mapping[str, Mapping[str, object]]] = {}
    """What `method` sets; a scene that lacks an option keeps its own default."""

    method: Any
    """Name of one of the methods."""

    @classmethod
    @cache
    def definitions(cls) -> Mapping[str, Any]:
        """Definition of every setting, by name, in the order of their groups."""
        parameters = {name: cls.param[name] for name in cls.param}
        return MappingProxyType(
            {
                name: parameter
                for name, parameter in parameters.items()
                if "about" in (parameter.metadata or {})
            }
        )

    @classmethod
    def checked(cls, values: Mapping[str, object]) -> Self:
        """Settings of plain values by name; what is left out is as by default, or by the method.

        Refuses an unknown name, a wrong type, a value out of range, and values that do not fit
        together with a `SettingError`.
        """
        definitions = cls.definitions()
        clean = {}
        for name, value in values.items():
            if name not in definitions:
                raise unknown(name, value, definitions)
            clean[name] = checked_value(definitions[name], name, value)
        values = {**cls.of_method(clean.get("method", definitions["method"].default)), **clean}
        # A default that is given takes param as long as anything else.
        others = {n: value for n, value in values.items() if value is not definitions[n].default}
        settings = cls(**others)
        settings.check_together()
        return settings

    @classmethod
    def of_method(cls, method: str) -> dict[str, Any]:
        """Values of the settings that a method sets."""
        values = dict(cls.METHODS[method])
        for name, value in values.items():
            definition = cls.definitions()[name]
            if isinstance(definition, param.Selector) and value not in definition.objects:
                values[name] = definition.default
        return values

    @classmethod
    def defaults(cls, method: str) -> dict[str, Any]:
        """Value of every setting where only the method is given."""
        values = {name: definition.default for name, definition in cls.definitions().items()}
        return {**values, **cls.of_method(method)}

    def check_together(self) -> None:
        """Check what no setting can check alone; a scene extends this."""

    def values(self) -> dict[str, Any]:
        """Plain value of every setting, by name."""
        return dict(self._values)

    @cached_property
    def _values(self) -> Mapping[str, Any]:
        # To ask param for all of them takes longer than an iteration, and they never change.
        return {name: getattr(self, name) for name in self.definitions()}

    def changed(self, base: Self | None = None) -> dict[str, Any]:
        """Settings that differ from others, or from their defaults.

        Where the method differs too, those that it sets are compared with what it says.
        """
        defaults = base.values() if base else self.defaults(self.method)
        if base and base.method != self.method:
            defaults.update(self.of_method(self.method))
        return {name: value for name, value in self._values.items() if value != defaults[name]}

    def replace(self, /, **changes: object) -> Self:
        """New settings with some values changed, checked as a whole.

        Another method brings its own values of all that it sets.
        """
        values = self.values()
        if changes.get("method", self.method) != self.method:
            own = self.METHODS[self.method]
            values = {name: value for name, value in values.items() if name not in own}
        return self.checked({**values, **changes})

    def refusal(self, name: str, allowed: str, remedy: str) -> SettingError:
        """Refusal of the present value of a setting: what is allowed beside others, what to do."""
        return SettingError(name, getattr(self, name), allowed, remedy)

    def applies(self, name: str) -> bool:
        """Whether a setting does anything under the present values."""
        record = about(self.definitions()[name])
        if record.path and not isinstance(getattr(self, record.path), str):
            return False
        return record.applies(self)


def dump(settings: Checked) -> str:
    """Text of a TOML file of settings, which every front reads."""
    lines = [f"{name} = {json.dumps(value)}" for name, value in settings.values().items()]
    return "\n".join([f"scene = {json.dumps(settings.scene)}", *lines, ""])
