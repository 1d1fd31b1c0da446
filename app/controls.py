"""Widgets made from the settings' definitions, one for each setting that has a choice."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Protocol

import panel as pn
import panel_material_ui as pmui
import param
from bokeh.models import CustomJSTickFormatter

from app.innards import gather_briefly
from app.points import PointsTable
from solver.definitions import Curve, about
from solver.settings import Settings

POINTS = "table of points"
WRITTEN = """
const rounded = Number(value.toPrecision(PLACES)), size = Math.abs(rounded)
if (size === 0 || (size >= 1e-3 && size < 1e5)) { return rounded.toString() }
const [digits, power] = rounded.toExponential().split("e")
const raised = [...power.replace("+", "")].map((one) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[one] ?? "⁻").join("")
return (digits === "1" ? "" : digits + "·") + "10" + raised
"""
LOGARITHMIC = "const value = 10 ** tick" + WRITTEN.replace("PLACES", "3")
LINEAR = "const value = tick" + WRITTEN.replace("PLACES", "4")
"""Numbers that are very large or small have a power of ten, and no row of noughts."""


class Report(Protocol):
    """Takes what the user does."""

    def __call__(self, name: str, value: Any, *, by_hand: bool = False) -> None:
        """Take a value, which may be one of many while a slider is dragged."""


class Control:
    """The widget of one setting: tells what the user does, and shows what the settings are.

    Attributes
    ----------
    view
        What stands on the page.
    is_dragged
        Whether a change may be one of many.
    """

    is_dragged = False

    def __init__(self, name: str, definition: param.Parameter, report: Report) -> None:
        self.name = name
        self.definition = definition
        self._report = report
        self._showing = False
        self.widget = self._make_widget()
        gather_briefly(self.widget)
        self.view: pn.viewable.Viewable = self.widget
        self.widget.param.watch(self._on_value, "value")

    def show(self, settings: Settings) -> None:
        """Show the value that holds, without reporting it as the user's."""
        self._showing = True
        try:
            self._show_value(getattr(settings, self.name))
            self.view.visible = settings.applies(self.name)
        finally:
            self._showing = False

    @property
    def label(self) -> str:
        """Title with unit."""
        record = about(self.definition)
        return f"{record.title} ({record.unit})" if record.unit else record.title

    def _make_widget(self) -> Any:
        raise NotImplementedError

    def _show_value(self, value: Any) -> None:
        self.widget.value = value

    def _read(self, shown: Any) -> Any:
        return shown

    def _on_value(self, event: param.parameterized.Event) -> None:
        if not self._showing:
            self._report(self.name, self._read(event.new), by_hand=self.is_dragged)

    def _common(self) -> dict[str, Any]:
        return {
            "label": self.label,
            "description": self.definition.doc,
            "sizing_mode": "stretch_width",
            "size": "small",
            # Labels repeat, as those of the left and the right side; what looks for one needs this.
            "css_classes": [f"setting-{self.name}"],
        }


class SwitchControl(Control):
    """On or off."""

    def _make_widget(self) -> Any:
        return pmui.Switch(**self._common())


class ChoiceControl(Control):
    """One of a few names."""

    def _make_widget(self) -> Any:
        return pmui.Select(options=list(self.definition.objects), **self._common())


class SliderControl(Control):
    """A number on a slider, logarithmic where the quantity is; it widens for a value outside.

    Parameters
    ----------
    let_go
        Called with the setting's name when a drag, or a press of a key, has ended.
    """

    is_dragged = True

    def __init__(
        self,
        name: str,
        definition: param.Parameter,
        report: Report,
        let_go: Callable[[str], None],
    ) -> None:
        super().__init__(name, definition, report)
        self.widget.param.watch(lambda event: self._showing or let_go(name), "value_throttled")

    def _make_widget(self) -> Any:
        low, high = self.definition.softbounds
        if self._logarithmic:
            low, high = math.log10(low), math.log10(high)
            code, step = LOGARITHMIC, (high - low) / 240
        elif isinstance(self.definition, param.Integer):
            return pmui.IntSlider(start=low, end=high, **self._common())
        else:
            code, step = LINEAR, 10.0 ** math.floor(math.log10((high - low) / 80))
        written = CustomJSTickFormatter(code=code)
        return pmui.FloatSlider(start=low, end=high, step=step, format=written, **self._common())

    @property
    def _logarithmic(self) -> bool:
        return about(self.definition).logarithmic

    def _read(self, shown: Any) -> Any:
        if not self._logarithmic:
            return shown
        low, high = self.definition.bounds
        value = min(max(10.0**shown, low), high)
        return round(value) if isinstance(self.definition, param.Integer) else float(f"{value:.4g}")

    def _show_value(self, value: Any) -> None:
        # Nearly always so: all controls are shown after every change, and an update costs 0.3 ms.
        if self._read(self.widget.value) == value:
            return
        if self._logarithmic:
            value = math.log10(value)
        self.widget.param.update(
            start=min(self.widget.start, value), end=max(self.widget.end, value), value=value
        )


class CurveControl(Control):
    """A preset, or a table of points that the user edits; a table starts as the preset's shape.

    Parameters
    ----------
    sample
        Gives points that stand for the present preset.
    """

    def __init__(
        self,
        name: str,
        definition: Curve,
        report: Report,
        sample: Callable[[str], list[tuple[float, float]]],
    ) -> None:
        self._sample = sample
        self._table: Any = None
        super().__init__(name, definition, report)
        self.view = pmui.Column(self.widget, sizing_mode="stretch_width", margin=0)

    def _make_widget(self) -> Any:
        options = [*self.definition.presets, POINTS]
        return pmui.Select(options=options, **self._common())

    def _read(self, shown: Any) -> Any:
        return self._sample(self.name) if shown == POINTS else shown

    def _show_value(self, value: Any) -> None:
        if isinstance(value, str):
            self.widget.value = value
            if self._table is not None:
                self.view[1:] = []
                self._table = None
            return
        self.widget.value = POINTS
        rows = [list(pair) for pair in value]
        if self._table is None:
            self._table = self._make_table(rows)
            self.view[1:] = [self._table]
        else:
            self._table.show(rows)

    def _make_table(self, rows: list[list[float]]) -> PointsTable:
        names = (self.definition.abscissa, self.definition.ordinate)
        made = PointsTable(
            columns=[
                f"{name} ({unit})" if unit else name
                for name, unit in zip(names, self.definition.units, strict=True)
            ],
            shown=rows,
            sizing_mode="stretch_width",
            margin=(4, 10),
        )
        made.param.watch(self._on_points, "wanted")
        return made

    def _on_points(self, event: param.parameterized.Event) -> None:
        if event.new:
            self._report(self.name, [tuple(row) for row in event.new])


def make_control(
    name: str,
    definition: param.Parameter,
    report: Report,
    sample: Callable[[str], list[tuple[float, float]]],
    let_go: Callable[[str], None] = lambda name: None,
) -> Control | None:
    """Make the control that a definition calls for; None where there is nothing to choose."""
    if isinstance(definition, Curve):
        return CurveControl(name, definition, report, sample)
    if isinstance(definition, param.Boolean):
        return SwitchControl(name, definition, report)
    if isinstance(definition, param.Selector):
        return ChoiceControl(name, definition, report) if len(definition.objects) > 1 else None
    return SliderControl(name, definition, report, let_go)
