"""Fields of a setting that varies, and of the values that it takes."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.questions import names_of, proposed, variable
from app.units import Unit, typed, unit_of
from solver.definitions import Parameter, SettingError, about
from solver.settings import Settings
from solver.study.sweep.plan import axis_of

EVEN, DECADES, LISTED = "even steps", "even ratios", "a list"
FIELD: dict[str, Any] = {"size": "small", "margin": (5, 6)}
PLAIN = {"& button": {"textTransform": "none", "whiteSpace": "nowrap", "padding": "4px 14px"}}


class Span:
    """The fields of one setting and its values.

    Parameters
    ----------
    label
        Of the first field.
    changed
        Called when somebody has changed a field.
    is_optional
        Whether there may be no setting.

    Attributes
    ----------
    view
        What stands on the page.
    """

    def __init__(self, label: str, changed: Callable[[], object], *, is_optional: bool) -> None:
        self._is_optional, self._is_updating = is_optional, False
        self._settings: Settings | None = None
        self.name = pmui.Select(label=label, options={"–": ""}, value="", width=260, **FIELD)
        spacings = [EVEN, DECADES, LISTED]
        self.spacing = pmui.Select(label="Values in", options=spacings, width=140, **FIELD)
        self.low = pmui.TextInput(label="from", width=110, **FIELD)
        self.high = pmui.TextInput(label="to", width=110, **FIELD)
        self.count = pmui.IntInput(label="Values", value=2, start=2, width=110, **FIELD)
        self.listed = pmui.TextInput(label="Values", width=330, **FIELD)
        self.chosen = pmui.CheckButtonGroup(label="", size="small", margin=(4, 6), sx=PLAIN)
        self.view = pn.FlexBox(
            self.name, self.spacing, self.low, self.high, self.count, self.listed, self.chosen
        )
        self.name.param.watch(lambda event: self._propose(), "value")
        self.spacing.param.watch(lambda event: self._respace(event.old), "value")
        for field in self.view:
            field.param.watch(lambda event: self._is_updating or changed(), "value")

    def show(self, settings: Settings, text: str) -> None:
        """Show a setting and its values, in the unit of its control; "" is none."""
        self._settings, self._is_updating = settings, True
        name, _, values = text.partition("=")
        known = {key: _titled(one, settings) for key, one in variable(settings).items()}
        options = {"–": ""} if self._is_optional else {}
        self.name.param.update(options={**options, **{v: k for k, v in known.items()}}, value=name)
        definition = settings.definitions().get(name)
        is_number = isinstance(definition, param.Number)
        if is_number:
            self._show_numbers(settings.definitions()[name], values)
        elif definition is not None:
            self.chosen.param.update(options=names_of(definition), value=values.split(","))
        is_listed = self.spacing.value == LISTED
        self.spacing.visible = is_number
        self.chosen.visible = definition is not None and not is_number
        self.listed.visible = is_number and is_listed
        for field in (self.low, self.high, self.count):
            field.visible = is_number and not is_listed
        self._is_updating = False

    def _show_numbers(self, definition: Parameter, values: str) -> None:
        unit = unit_of(definition)
        self.low.label = unit.titled("from")
        self.listed.label = unit.titled("Values, separated by commas")
        if ":" not in values:
            shown = ", ".join(_written(value, unit) for value in values.split(","))
            self.spacing.value, self.listed.value = LISTED, shown
            return
        low, high, count, *log = values.split(":")
        self.spacing.value = DECADES if log else EVEN
        self.low.value, self.high.value = _written(low, unit), _written(high, unit)
        self.count.value = int(count) if count.isdigit() else 2

    @property
    def text(self) -> str:
        """The setting and its values as the command line takes them, in SI; "" for none.

        Raises
        ------
        ValueError
            For what is no number.
        """
        assert self._settings is not None
        name = self.name.value
        if not name:
            return ""
        definition = self._settings.definitions()[name]
        if not isinstance(definition, param.Number):
            return f"{name}={','.join(self.chosen.value)}"
        unit, si = unit_of(definition), about(definition).unit
        if self.spacing.value == LISTED:
            values = [f"{typed(one, unit, si):.12g}" for one in self.listed.value.split(",")]
            return f"{name}={','.join(values)}"
        low, high = (f"{typed(end.value, unit, si):.12g}" for end in (self.low, self.high))
        log = ":log" if self.spacing.value == DECADES else ""
        return f"{name}={low}:{high}:{self.count.value}{log}"

    def _propose(self) -> None:
        """Another setting brings its own values."""
        if not self._is_updating and self._settings is not None:
            name = self.name.value
            definition = self._settings.definitions().get(name)
            self.show(self._settings, proposed(definition, name) if definition else "")

    def _respace(self, before: str) -> None:
        """Show the same values in another way, where that can be."""
        if self._is_updating or self._settings is None:
            return
        settings, name, spacing = self._settings, self.name.value, self.spacing.value
        text = proposed(settings.definitions()[name], name).removesuffix(":log")
        if spacing == LISTED:
            self._is_updating, self.spacing.value = True, before
            try:
                values = axis_of(settings, self.text).values
                text = f"{name}={','.join(f'{value:g}' for value in values)}"
            except (ValueError, SettingError):
                text = f"{name}={getattr(settings, name):g}"
        elif before != LISTED:
            with contextlib.suppress(ValueError):
                text = self.text.removesuffix(":log")
        self.show(settings, text + (":log" if spacing == DECADES else ""))


def _titled(definition: Parameter, settings: Settings) -> str:
    """Title of a setting, with its group where another has the same."""
    titles = [about(other).title for other in settings.definitions().values()]
    kind = about(definition)
    return f"{kind.title} ({kind.group})" if titles.count(kind.title) > 1 else kind.title


def _written(text: str, unit: Unit) -> str:
    try:
        return f"{float(text) / unit.factor:.10g}"
    except ValueError:
        return text
