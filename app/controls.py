"""The controls at the side: a stock widget from each setting's definition."""

from __future__ import annotations

import math
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.state import PageState, default_settings
from app.units import unit_of
from solver.definitions import CurveParameter, Parameter, about
from solver.scenes import CATALOGUE, chief_of

WIDTH = 290
STEPS = 200


class Control:
    """The widget of one setting.

    Attributes
    ----------
    view
        What stands on the page.
    """

    def __init__(self, name: str, definition: Parameter, state: PageState) -> None:
        self._name, self._definition, self._state = name, definition, state
        self._is_updating = False
        self._unit = unit_of(definition)
        self.view = self._make()
        self.update()

    def update(self) -> None:
        """Show the setting as it is."""
        settings = self._state.settings
        self._is_updating = True
        try:
            self.view.visible = settings.applies(self._name)
            self._show(getattr(settings, self._name))
        finally:
            self._is_updating = False

    def _make(self) -> Any:
        definition, kind = self._definition, about(self._definition)
        more = {
            "label": kind.title,
            "description": definition.doc,
            "size": "small",
            "width": WIDTH,
            "margin": (4, 8),
        }
        if isinstance(definition, CurveParameter):
            self._field = pmui.Select(options=list(definition.presets), **more)
        elif isinstance(definition, param.Boolean):
            self._field = pmui.Switch(label=kind.title, width=WIDTH)
        elif isinstance(definition, param.Selector):
            self._field = pmui.Select(options=list(definition.objects), **more)
        else:
            return self._make_number(more)
        self._field.param.watch(lambda event: self._change(event.new), "value")
        return self._field

    def _make_number(self, more: dict[str, Any]) -> pn.Row:
        """A field and a slider for a number, in the unit of its setting."""
        definition, kind = self._definition, about(self._definition)
        is_whole = isinstance(definition, param.Integer)
        more |= {"label": self._unit.titled(kind.title), "width": 150, "margin": (4, 4, 4, 8)}
        self._field = (pmui.IntInput if is_whole else pmui.FloatInput)(**more)
        low, high = (self._to_slider(end) for end in definition.softbounds)
        step = 1 if is_whole and not kind.logarithmic else (high - low) / STEPS
        self._slider = pmui.FloatSlider(
            start=low,
            end=high,
            step=step,
            value=low,
            show_value=False,
            size="small",
            width=120,
            margin=(8, 8),
        )
        self._slider.param.watch(lambda event: self._drag(event.new), "value")
        self._slider.param.watch(
            lambda event: self._change(self._from_slider(event.new)), "value_throttled"
        )
        self._field.param.watch(lambda event: self._change(event.new * self._unit.factor), "value")
        return pn.Row(self._field, self._slider, margin=0, align="center")

    def _to_slider(self, value: float) -> float:
        if about(self._definition).logarithmic:
            return math.log10(max(value, 1e-300))
        return value / self._unit.factor

    def _from_slider(self, place: float) -> float:
        value = 10.0**place if about(self._definition).logarithmic else place * self._unit.factor
        if isinstance(self._definition, param.Integer):
            return round(value)
        return float(f"{value:.4g}")

    def _show(self, value: Any) -> None:
        if not isinstance(self._definition, param.Number):
            if isinstance(value, tuple):
                self._field.options = [*self._definition.presets, "points"]
                value = "points"
            self._field.value = value
            return
        whole = isinstance(self._definition, param.Integer)
        self._field.value = value if whole else float(f"{value / self._unit.factor:.10g}")
        place = self._to_slider(value)
        self._slider.value = min(max(place, self._slider.start), self._slider.end)

    def _change(self, value: Any) -> None:
        if self._is_updating or value is None:
            return
        if isinstance(self._definition, param.Integer):
            value = round(value)
        if not self._state.change(**{self._name: value}):
            self.update()

    def _drag(self, place: float) -> None:
        if not self._is_updating:
            self._state.drag(self._name, self._from_slider(place))


class Controls:
    """All controls of the present scene.

    Attributes
    ----------
    view
        What stands at the side.
    """

    def __init__(self, state: PageState) -> None:
        self._state = state
        self._controls: list[Control] = []
        self._scene = pmui.Select(
            label="Scene",
            options={e.title: n for n, e in CATALOGUE.items()},
            size="small",
            width=WIDTH,
        )
        self._scene.param.watch(lambda event: self._choose(event.new), "value")
        self._chief, self._groups = pn.Column(margin=0), pmui.Accordion(margin=0, width=WIDTH + 16)
        self.view = pn.Column(self._scene, self._chief, self._groups, margin=0)
        self._built = ""
        state.param.watch(lambda event: self.update(), "settings")
        self.update()

    def update(self) -> None:
        """Show the settings as they are, those of another scene in place of the present ones."""
        settings = self._state.settings
        if settings.scene != self._built:
            self._build()
        for control in self._controls:
            control.update()

    def _build(self) -> None:
        settings = self._state.settings
        self._built = self._scene.value = settings.scene
        definitions, chief = settings.definitions(), chief_of(type(settings))
        self._controls = [
            Control(n, definitions[n], self._state) for n in chief if n in definitions
        ]
        self._chief[:] = [control.view for control in self._controls]

    def _choose(self, scene: str) -> None:
        if scene != self._state.settings.scene:
            self._state.adopt(default_settings(scene))
