"""The fields for a setting that varies, and its values."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.experiments.questions import proposed, variable
from solver.files.amounts import unit_of
from solver.files.typed import typed_amount
from solver.settings.definitions import names_of, properties_of, title_of
from solver.settings.scene import Settings

FIELD: dict[str, Any] = {"size": "small", "margin": (5, 6)}
"""Look of the fields of a question."""
GRAMMAR = (
    "FROM:TO:NUMBER are so many values in even steps, FROM:TO:NUMBER:log in even "
    "ratios; others stand between commas."
)


class SettingRange:
    """Fields for a varied setting and its values.

    `changed` is called when a person has changed a field.
    """

    def __init__(
        self, label: str, changed: Callable[[], object], *, is_optional: bool
    ) -> None:
        if is_optional:
            self._nothing = {"–": ""}
        else:
            self._nothing = {}
        self._changed = changed
        self._is_updating = False
        self.name = pmui.Select(
            label=label, options={"–": ""}, value="", width=260, **FIELD
        )
        self.values = pmui.TextInput(
            label="Values", description=GRAMMAR, width=330, **FIELD
        )
        self.view = pn.FlexBox(self.name, self.values)
        for field in self.view:
            field.param.watch(self._on_field, "value")

    def show(self, settings: Settings, text: str) -> None:
        """Show a setting and its values in the unit of its control; nothing for ""."""
        self._settings = settings
        # Fields report these changes, too, as if a person had made them.
        self._is_updating = True
        name, _, values = text.partition("=")
        options = dict(self._nothing)
        for key, known in variable(settings).items():
            options[title_of(known)] = key
        self.name.param.update(options=options, value=name)
        definition = settings.definitions().get(name)
        label = "Values"
        if isinstance(definition, param.Number):
            unit = unit_of(definition)
            label = unit.titled(label)
            values = _converted(
                values, lambda text: f"{float(text) / unit.factor:.10g}"
            )
        elif definition is not None:
            label = f"Values: {', '.join(names_of(definition))}"
        self.values.param.update(label=label, value=values, visible=bool(name))
        self._is_updating = False

    def text(self) -> str:
        """Setting and values in SI, as in `Question.vary`; "" without a setting.

        Raises
        ------
        ValueError
            If a value is no number.
        """
        name = self.name.value
        if not name:
            return ""
        definition = self._settings.definitions()[name]
        values = self.values.value
        if isinstance(definition, param.Number):
            unit = unit_of(definition)
            si = properties_of(definition).unit
            try:
                values = _converted(
                    values, lambda text: f"{typed_amount(text, unit, si):.12g}"
                )
            except ValueError as problem:
                label = self.values.label
                text = f"{label} cannot be “{values[:40]}”: {problem}"
                raise ValueError(text) from None
        return f"{name}={values.replace(' ', '')}"

    def _on_field(self, event: param.parameterized.Event) -> None:
        """Report a changed field; another setting gets its proposed values."""
        if self._is_updating:
            return
        if event.obj is self.name:
            text = ""
            if event.new:
                text = proposed(self._settings, event.new)
            self.show(self._settings, text)
        self._changed()


def _converted(values: str, convert: Callable[[str], str]) -> str:
    """A range with both ends converted, or a list with all its numbers converted."""
    if ":" in values:
        low, high, *rest = values.split(":")
        return ":".join([convert(low), convert(high), *rest])
    return ",".join([convert(part) for part in values.split(",")])
