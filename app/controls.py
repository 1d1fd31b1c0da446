"""The controls at the side: a stock widget from each setting's definition."""

from __future__ import annotations

import math
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.browser import Echoes
from app.files.opener import files_panel
from app.files.points import CurveDialog
from app.state import PageState
from app.units import typed, unit_of
from app.widgets import button, looks, mask_of
from solver.scenes import CATALOGUE
from solver.settings.definitions import (
    CurveParameter,
    Parameter,
    about,
    help_of,
    is_logarithmic,
    title_of,
)

WIDTH = 286
STEPS = 80
"""Steps of a slider at least."""
POINTS = "points"
GROUPS = (
    *(
        "Load",
        "Ends",
        "Top",
        "Left",
        "Right",
        "Contact",
        "Bar",
        "Strand",
        "Body",
        "Body force",
    ),
    *("Decomposition", "Method", "Stop"),
)
"""Order of the groups: what the scene is, then how it is solved."""


class SettingControl:
    """The widget of one setting: it shows the state's and changes it.

    `field` takes the value; of a number it is a text field, which has a `slider`, too.
    Both stand in `view`.
    """

    def __init__(self, name: str, state: PageState) -> None:
        self.name = name
        self._state = state
        self._definition: Parameter = state.settings.definitions()[name]
        self._about = about(self._definition)
        self._unit = unit_of(self._definition)
        self._is_updating = self._is_dragged = False
        self._echoes = Echoes()
        self._dialog: CurveDialog | None = None
        self.slider: pmui.FloatSlider | None = None
        self.field, self.view = self._make()
        self.field.param.watch(lambda event: self._on_field(event.new), "value")
        self.update()

    def update(self) -> None:
        """Show the setting as it is."""
        settings = self._state.settings
        self._is_updating = True
        try:
            self.view.visible = settings.applies(self.name)
            self._show(getattr(settings, self.name))
            self._explain("")
        finally:
            self._is_updating = False

    def _make(self) -> tuple[Any, Any]:
        """The field and what stands on the page."""
        definition = self._definition
        more: dict[str, Any] = {
            "description": help_of(definition),
            "size": "small",
            "width": WIDTH,
        }
        more |= {
            "margin": (4, 0),
            "label": self._unit.titled(title_of(self._definition)),
        }
        if isinstance(definition, CurveParameter):
            options = [*definition.presets, POINTS]
            field = pmui.Select(options=options, variant="standard", **more)
            look = {"variant": "text", "margin": (-4, 0, 0, 0)}
            self._edit_button = button(
                "Edit points", self._edit, icon="show_chart", **look
            )
            return field, pn.Column(field, self._edit_button, margin=0)
        if isinstance(definition, param.Boolean):
            field = pmui.Switch(**more)
            return field, field
        if isinstance(definition, param.Selector):
            field = pmui.Select(
                options=list(definition.objects), variant="standard", **more
            )
            return field, field
        more |= {"margin": 0, "variant": "standard", **looks("number")}
        default = self._written(definition.default)
        field = pmui.TextInput(placeholder=f"{default} by default", **more)
        self._is_logarithmic = is_logarithmic(definition)
        self.slider = self._make_slider()
        return field, pn.Column(field, self.slider, margin=(3, 0, 0, 0))

    def _make_slider(self) -> pmui.FloatSlider:
        low, high = (self._to_slider(end) for end in self._definition.softbounds)
        is_count = (
            isinstance(self._definition, param.Integer) and not self._is_logarithmic
        )
        slider = pmui.FloatSlider(
            label=title_of(self._definition),
            start=low,
            end=high,
            step=1
            if is_count
            else 10.0 ** math.floor(math.log10((high - low) / STEPS)),
            value=low,
            show_value=False,
            tooltips=False,
            size="small",
            width=WIDTH,
            height=20,
            margin=(-10, 0, 0, 0),
            **looks("under-number"),
        )
        slider.param.watch(self._move, ["value", "value_throttled"])
        return slider

    def _to_slider(self, value: float) -> float:
        if self._is_logarithmic:
            return math.log10(max(value, 1e-300))
        return float(f"{value / self._unit.factor:.10g}")

    def _from_slider(self, place: float) -> float:
        """The value of a place, as round as a hand can mean it."""
        if self._is_logarithmic:
            value = 10.0**place
        else:
            value = place * self._unit.factor
        if isinstance(self._definition, param.Integer):
            return round(value)
        return float(f"{value:.{3 if self._is_logarithmic else 10}g}")

    def _written(self, value: float) -> str:
        return f"{value / self._unit.factor:.10g}"

    def _show(self, value: Any) -> None:
        if isinstance(self._definition, CurveParameter):
            self.field.value = POINTS if isinstance(value, tuple) else value
            self._edit_button.visible = isinstance(value, tuple)
            if self._dialog is not None:
                self._dialog.update()
        elif self.slider is None:
            self.field.value = value
        else:
            self.field.value = self._echoes.give(self._written(value), self.field.value)
            if not self._is_dragged:
                self._show_on_slider(value)

    def _show_on_slider(self, value: float) -> None:
        low, high = self._definition.softbounds
        most = self._state.settings.ends.get(self.name, high)
        self.slider.end = self._to_slider(
            max(min(most, high), low + 1) if most < high else high
        )
        place = min(max(self._to_slider(value), self.slider.start), self.slider.end)
        if (self.slider.value, self.slider.value_throttled) == (place, place):
            return
        # What the browser let go at last is reset, since it sends that only when it is
        # new.
        with param.edit_constant(self.slider):
            self.slider.param.update(value=place, value_throttled=place)

    def _explain(self, refusal: str) -> None:
        """Say below the field why a value is refused, or of a preset that holds what it is."""
        value = getattr(self._state.settings, self.name)
        if isinstance(value, str):
            line = self._about.presets.get(value, "")
        else:
            line = ""
        text = refusal or line[:1].upper() + line[1:]
        if getattr(self.field, "helper_text", text) != text:
            self.field.param.update(helper_text=text, error_state=bool(refusal))

    def _on_field(self, value: Any) -> None:
        if self._is_updating or value is None:
            return
        if self._echoes.has(value):
            # The browser may show it too.
            self.update()
        elif value == POINTS and isinstance(self._definition, CurveParameter):
            self._edit()
        elif self.slider is not None:
            self._take_text(value)
        else:
            self._change(value)

    def _take_text(self, text: str) -> None:
        """Take what is typed; nothing means the default."""
        try:
            if text:
                value = typed(text, self._unit, self._about.unit)
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
        """Show the value that holds again, and why the other does not."""
        self._state.refusal = refusal
        self.update()
        self._explain(refusal)

    def _move(self, *events: Any) -> None:
        """Follow the slider; run where it is let go, by a key at once, or what held before."""
        if self._is_updating:
            return
        value = self._from_slider(events[-1].new)
        self._is_dragged = all(event.name == "value" for event in events)
        if self._is_dragged:
            self._state.drag(self.name, value)
            return
        self._state.release(self.name, value)
        self.update()
        self._explain(self._state.refusal)

    def _edit(self) -> None:
        """Open the points of a path."""
        if self._dialog is None:
            self._dialog = CurveDialog(self.name, self._state)
            self.view.append(self._dialog.view)
        self.update()
        self._dialog.view.open = True


class Controls:
    """All controls of the present scene: the chief ones, and groups that open."""

    def __init__(self, state: PageState) -> None:
        self._state = state
        self._controls: list[SettingControl] = []
        pictures = {
            f"& .MuiToggleButton-root:nth-of-type({number})::before": mask_of(kind.icon)
            for number, kind in enumerate(CATALOGUE.values(), start=1)
        }
        self._scene = pmui.RadioButtonGroup(
            options={name.capitalize(): name for name in CATALOGUE},
            value=state.settings.scene,
            width=WIDTH,
            margin=0,
            size="small",
            sx=pictures,
            **looks("pictures"),
        )
        self._scene.param.watch(lambda event: state.choose_scene(event.new), "value")
        self._chief = pn.Column(margin=0)
        self._groups = pmui.Accordion(
            margin=(10, 0),
            width=WIDTH,
            title_variant="body2",
            disable_gutters=True,
            elevation=0,
            **looks("groups"),
        )
        self._groups.param.watch(lambda event: self._open(), "active")
        self.view = pn.Column(
            self._scene, self._chief, self._groups, width=WIDTH, margin=(4, 12)
        )
        self._built = ""
        state.param.watch(lambda event: self.update(), "settings")
        self.update()

    def update(self) -> None:
        """Show the settings as they are, those of another scene in place of the present ones."""
        settings = self._state.settings
        with pn.io.hold():
            if settings.scene != self._built:
                self._build()
            for control in self._controls:
                control.update()

    def _build(self) -> None:
        settings = self._state.settings
        self._built = self._scene.value = settings.scene
        self._scene.label = settings.title
        chief, groups = _groups_of(type(settings))
        self._controls = [SettingControl(name, self._state) for name in chief]
        self._chief[:] = [control.view for control in self._controls]
        self._groups.active = []
        # What is opened takes the place of a spacer, which costs a page less than a
        # column.
        self._closed = dict(enumerate([*groups.items(), ("Files", [])]))
        self._groups[:] = [
            (title, pn.Spacer(height=0)) for title, _ in self._closed.values()
        ]

    def _open(self) -> None:
        """Fill the groups that are opened for the first time."""
        for place in self._closed.keys() & {*self._groups.active}:
            title, names = self._closed.pop(place)
            controls = [SettingControl(name, self._state) for name in names]
            self._controls += controls
            settings = pn.Column(*(control.view for control in controls), margin=0)
            if names:
                view = settings
            else:
                view = files_panel(self._state, WIDTH)
            self._groups[place] = (title, view)


def _groups_of(kind: Any) -> tuple[list[str], dict[str, list[str]]]:
    """The chief settings of a scene, and all others by group; without those of a single value."""
    definitions = kind.definitions()
    chief = [name for name in (*kind.CHIEF, *kind.ALSO_CHIEF) if name in definitions]
    groups: dict[str, list[str]] = {group: [] for group in GROUPS}
    for name, definition in definitions.items():
        if name not in chief and len(getattr(definition, "objects", "any")) > 1:
            groups.setdefault(about(definition).group, []).append(name)
    return chief, {group: names for group, names in groups.items() if names}
