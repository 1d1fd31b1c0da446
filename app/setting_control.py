"""The control of one setting: a field, a slider or a select, from its definition."""

from __future__ import annotations

import math
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.echoes import Echoes
from app.files.points import CurveDialog
from app.state import PageState
from app.widgets import button, looks
from solver.files.amounts import unit_of
from solver.files.typed import typed_amount
from solver.settings.definitions import (
    CurveParameter,
    Parameter,
    TextParameter,
    help_of,
    is_logarithmic,
    names_of,
    properties_of,
    title_of,
)

WIDTH = 286
STEPS = 80
"""Least number of steps of a slider."""
POINTS = "points"
OWN = "a file"
"""Choice of a text that is the content of a file: the files group opens one."""


class SettingControl:
    """The widget of a setting, which shows the value in the state and changes it.

    `field` takes the value; for a number it is a text field with a `slider`. `views`
    are what stands on the page, one below the other.
    """

    def __init__(self, name: str, state: PageState) -> None:
        self.name = name
        self._state = state
        self._definition: Parameter = state.settings.definitions()[name]
        self._about = properties_of(self._definition)
        self._unit = unit_of(self._definition)
        self._is_updating = False
        self._is_dragged = False
        self._may_forget = False
        self._echoes = Echoes(state)
        self._positions = Echoes(state)
        self._dialog: CurveDialog | None = None
        self._edit_button: pmui.Button | None = None
        self.slider: pmui.FloatSlider | None = None
        self.field, self.views = self._make()
        self.field.param.watch(lambda event: self._on_field(event.new), "value")
        if isinstance(self.field, pmui.TextInput):
            self.field.param.watch(self._forgive, ["value_input", "enter_pressed"])
        if isinstance(self.field, pmui.Select):
            self.field.param.watch(self._follow_list, "dropdown_open")
        self.update()
        # No browser has shown the initial values of the widgets.
        self._echoes = Echoes(state)
        self._positions = Echoes(state)

    def update(self, refusal: str = "") -> None:
        """Show the value of the setting, whether it applies, and a refusal, if any.

        In one change: what is given twice in a moment the browser may show in either
        order.
        """
        settings = self._state.settings
        # Widgets report these changes, too, as if a person had made them.
        self._is_updating = True
        try:
            applies = settings.applies(self.name)
            for view in self.views:
                view.visible = applies
            self._show(getattr(settings, self.name))
            self._explain(refusal)
        finally:
            self._is_updating = False

    def _make(self) -> tuple[Any, list[Any]]:
        """Make the field of the setting, and the widgets of the page."""
        definition = self._definition
        more: dict[str, Any] = {
            "description": help_of(definition),
            "label": self._unit.titled(title_of(definition)),
            "size": "small",
            "width": WIDTH,
            "margin": (4, 0),
        }
        if isinstance(definition, param.Boolean):
            field = pmui.Switch(**more)
            return field, [field]
        if isinstance(definition, TextParameter) and not definition.is_file:
            field = pmui.TextInput(variant="standard", **more)
            return field, [field]
        names = names_of(definition)
        if isinstance(definition, CurveParameter):
            options = [*names, POINTS]
            field = pmui.Select(options=options, variant="standard", **more)
            return field, [pn.Column(field, margin=0)]
        if names:
            field = pmui.Select(options=names, variant="standard", **more)
            return field, [field]
        # All others are numbers: a field to type in, and below it a slider.
        more |= {"margin": (3, 0, 0, 0), "variant": "standard", **looks("number")}
        default = self._written(definition.default)
        field = pmui.TextInput(placeholder=f"{default} by default", **more)
        self._is_logarithmic = is_logarithmic(definition)
        self.slider = self._make_slider()
        return field, [field, self.slider]

    def _make_slider(self) -> pmui.FloatSlider:
        lowest, highest = self._definition.softbounds
        low = self._to_slider(lowest)
        high = self._to_slider(highest)
        is_whole = isinstance(self._definition, param.Integer)
        if is_whole and not self._is_logarithmic:
            step = 1.0
        else:
            step = 10.0 ** math.floor(math.log10((high - low) / STEPS))
        slider = pmui.FloatSlider(
            label=title_of(self._definition),
            start=low,
            end=high,
            step=step,
            value=low,
            show_value=False,
            tooltips=False,
            size="small",
            width=WIDTH,
            height=13,
            margin=(-3, 0, 0, 0),
            **looks("under-number"),
        )
        slider.param.watch(self._move, ["value", "value_throttled"])
        return slider

    def _to_slider(self, value: float) -> float:
        """Position of a value on the slider: in the field's unit, or its logarithm."""
        if self._is_logarithmic:
            return math.log10(max(value, 1e-300))
        return float(f"{value / self._unit.factor:.10g}")

    def _from_slider(self, position: float) -> float:
        """Value at a position of the slider, rounded to its resolution."""
        if self._is_logarithmic:
            value = 10.0**position
            digits = 3
        else:
            value = position * self._unit.factor
            digits = 10
        if isinstance(self._definition, param.Integer):
            return round(value)
        return float(f"{value:.{digits}g}")

    def _written(self, value: float) -> str:
        return f"{value / self._unit.factor:.10g}"

    def _show(self, value: Any) -> None:
        if isinstance(self._definition, CurveParameter):
            choice = POINTS if isinstance(value, tuple) else value
            self._echoes.show(self.field, choice)
            self._offer_points(has_points=isinstance(value, tuple))
            if self._dialog is not None:
                self._dialog.update()
        elif isinstance(self._definition, TextParameter) and self._definition.is_file:
            presets = names_of(self._definition)
            # A file is there to be chosen only while it is open.
            if value not in presets:
                presets.append(OWN)
                value = OWN
            self._echoes.show(self.field, value, options=presets)
        elif self.slider is None:
            self._echoes.show(self.field, value)
        else:
            self._echoes.show(self.field, self._written(value))
            if not self._is_dragged:
                self._show_on_slider(value)

    def _offer_points(self, *, has_points: bool) -> None:
        """Show the button for the points of a path, if the path has points."""
        if has_points:
            self._add_edit_button()
        if self._edit_button is not None:
            self._edit_button.visible = has_points

    def _add_edit_button(self) -> None:
        """Add the button for the points of a path."""
        if self._edit_button is None:
            self._edit_button = button(
                "Edit points",
                self._edit,
                icon="show_chart",
                variant="text",
                margin=(-4, 0, 0, 0),
                visible=False,
            )
            self.views[0].append(self._edit_button)

    def _show_on_slider(self, value: float) -> None:
        slider = self.slider
        low, high = self._definition.softbounds
        # Other settings may allow less than the definition.
        largest = self._state.settings.largest_counts.get(self.name, high)
        if largest < high:
            high = max(largest, low + 1)
        slider.end = self._to_slider(high)
        position = min(max(self._to_slider(value), slider.start), slider.end)
        if (slider.value, slider.value_throttled) == (position, position):
            return
        # The throttled value is set, too: the browser sends it only when it changes.
        with param.edit_constant(slider):
            self._positions.show(slider, position, value_throttled=position)

    def _explain(self, refusal: str) -> None:
        """Show below the field why a value is refused, or the help of a preset."""
        value = getattr(self._state.settings, self.name)
        text = refusal
        if not refusal and isinstance(value, str):
            line = self._about.presets.get(value, "")
            text = line[:1].upper() + line[1:]
        if getattr(self.field, "helper_text", text) != text:
            self.field.param.update(helper_text=text, error_state=bool(refusal))

    def _forgive(self, event: Any) -> None:
        """Forget a refusal once the shown value is typed again.

        To the server that is no new value.
        """
        field = self.field
        if self._is_updating or not field.error_state:
            return
        # What was refused may be told once more, after it was replaced.
        is_shown = event.name == "enter_pressed" or event.new == field.value
        if is_shown:
            self._forget()

    def _follow_list(self, event: Any) -> None:
        """Forget a refusal once the list of options closes on the shown one.

        To the server that is no new value. A new one comes before the list closes.
        """
        if event.new:
            self._may_forget = self.field.error_state
        elif self._may_forget:
            self._forget()

    def _forget(self) -> None:
        """Forget the refusal that stands below the field."""
        if self._state.refusal == self.field.helper_text:
            self._state.refusal = ""
        self._explain("")

    def _on_field(self, value: Any) -> None:
        if self._is_updating or value is None:
            return
        if self._echoes.has(value):
            # The browser may show it too.
            self.update()
        elif value == POINTS and isinstance(self._definition, CurveParameter):
            self._edit()
        elif value == OWN:
            self.update()
        elif self.slider is not None:
            self._take_text(value)
        else:
            self._change(value)

    def _take_text(self, text: str) -> None:
        """Take a value that was typed; an empty text means the default."""
        try:
            if text:
                value = typed_amount(text, self._unit, self._about.unit)
            else:
                value = self._definition.default
        except ValueError as problem:
            self._refuse(
                f"{title_of(self._definition)} cannot be “{text[:40]}”: {problem}."
            )
        else:
            self._change(value)

    def _change(self, value: Any) -> None:
        if not self._state.change(**{self.name: value}):
            self._refuse(self._state.refusal)

    def _refuse(self, refusal: str) -> None:
        """Show the present value again, and the reason of the refusal."""
        self._state.refusal = refusal
        self._may_forget = False
        self.update(refusal)

    def _move(self, *events: Any) -> None:
        """Run the value of the slider while it is dragged, and when it is released.

        A key releases at once; a refused value leaves the one before.
        """
        if self._is_updating:
            return
        if self._positions.has(events[-1].new):
            # The browser may show it too.
            self.update()
            return
        value = self._from_slider(events[-1].new)
        self._is_dragged = all(event.name == "value" for event in events)
        if self._is_dragged:
            self._state.drag(self.name, value)
            return
        self._state.release(self.name, value)
        self.update(self._state.refusal)

    # What is set here in a figure is to come after the figure, whoever holds the
    # document's lock.
    @pn.io.hold()
    def _edit(self) -> None:
        """Open the points of a path."""
        if self._dialog is None:
            # Nothing is to be added to the page while the dialog is open.
            self._add_edit_button()
            self._dialog = CurveDialog(self.name, self._state)
            self.views[0].append(self._dialog.view)
        self.update()
        self._dialog.view.open = True
