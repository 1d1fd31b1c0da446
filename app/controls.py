"""Widgets made from the settings' definitions, one for each setting that has a choice."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import panel as pn
import panel_material_ui as pmui
import param
from bokeh.models import CustomJSTickFormatter

from solver.settings import Curve, Settings, about

POINTS = "table of points"
LOGARITHMIC = "const v = 10 ** tick; return Number(v.toPrecision(3)).toString()"

Report = Callable[[str, Any], None]


class Control:
    """The widget of one setting: tells what the user does, and shows what the settings are.

    Attributes
    ----------
    view
        What stands on the page.
    """

    def __init__(self, name: str, definition: param.Parameter, report: Report) -> None:
        self.name = name
        self.definition = definition
        self._report = report
        self._showing = False
        self.widget = self._make_widget()
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
            self._report(self.name, self._read(event.new))

    def _common(self) -> dict[str, Any]:
        return {
            "label": self.label,
            "description": self.definition.doc,
            "sizing_mode": "stretch_width",
            "size": "small",
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
    """A number on a slider, logarithmic where the quantity is; it widens for a value outside."""

    def _make_widget(self) -> Any:
        low, high = self.definition.softbounds
        whole = isinstance(self.definition, param.Integer)
        if self._logarithmic:
            return pmui.FloatSlider(
                start=math.log10(low),
                end=math.log10(high),
                step=(math.log10(high) - math.log10(low)) / 240,
                format=CustomJSTickFormatter(code=LOGARITHMIC),
                **self._common(),
            )
        if whole:
            return pmui.IntSlider(start=low, end=high, **self._common())
        step = 10.0 ** math.floor(math.log10((high - low) / 80))
        return pmui.FloatSlider(start=low, end=high, step=step, format="0[.]000", **self._common())

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
        if self._logarithmic:
            if self._read(self.widget.value) == value:
                return
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
        frame = pd.DataFrame(value, columns=[self.definition.abscissa, self.definition.ordinate])
        if self._table is None:
            self._table = self._make_table(frame)
            self.view[1:] = [self._table, self._buttons()]
        elif not self._table.value.equals(frame):
            self._table.value = frame

    def _make_table(self, frame: pd.DataFrame) -> Any:
        table = pn.widgets.Tabulator(
            frame,
            show_index=False,
            selectable=1,
            height=220,
            sizing_mode="stretch_width",
            layout="fit_columns",
            editors={column: {"type": "number", "step": "any"} for column in frame.columns},
        )
        table.on_edit(lambda event: self._report_rows(table.value))
        return table

    def _buttons(self) -> Any:
        add = pmui.Button(label="Add row", size="small", variant="outlined")
        remove = pmui.Button(label="Remove row", size="small", variant="outlined")
        add.on_click(lambda event: self._report_rows(_with_row(self._table.value, self._chosen)))
        remove.on_click(lambda event: self._report_rows(self._table.value.drop(index=self._chosen)))
        return pmui.Row(add, remove)

    @property
    def _chosen(self) -> int:
        chosen = self._table.selection
        return int(chosen[0]) if chosen else len(self._table.value) - 1

    def _report_rows(self, frame: pd.DataFrame) -> None:
        rows = [tuple(float(cell) for cell in row) for row in frame.to_numpy(dtype=float)]
        self._report(self.name, rows)


def _with_row(frame: pd.DataFrame, after: int) -> pd.DataFrame:
    rows = frame.to_numpy(dtype=float)
    here = rows[after]
    following = rows[after + 1] if after + 1 < len(rows) else here + (here - rows[after - 1])
    if len(rows) == 1:
        following = here + np.array([1.0, 0.0])
    new = 0.5 * (here + following) if after + 1 < len(rows) else following
    return pd.DataFrame(np.insert(rows, after + 1, new, axis=0), columns=frame.columns)


def make_control(
    name: str,
    definition: param.Parameter,
    report: Report,
    sample: Callable[[str], list[tuple[float, float]]],
) -> Control | None:
    """Make the control that a definition calls for; None where there is nothing to choose."""
    if isinstance(definition, Curve):
        return CurveControl(name, definition, report, sample)
    if isinstance(definition, param.Boolean):
        return SwitchControl(name, definition, report)
    if isinstance(definition, param.Selector):
        return ChoiceControl(name, definition, report) if len(definition.objects) > 1 else None
    return SliderControl(name, definition, report)
