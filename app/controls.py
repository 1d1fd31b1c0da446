"""The controls at the side: a Panel widget for each setting, from its definition."""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.browser import Echoes, fade_first, linked
from app.files.opener import files_panel
from app.files.points import CurveDialog
from app.state import PageState
from app.units import unit_of
from app.widgets import button, looks, mask_of, rebuilt
from solver.files.typed import typed_amount
from solver.scenes import CATALOGUE
from solver.settings.definitions import (
    CurveParameter,
    Parameter,
    TextParameter,
    help_of,
    is_logarithmic,
    properties_of,
    title_of,
)

WIDTH = 286
STEPS = 80
"""Least number of steps of a slider."""
POINTS = "points"
FILES = "Files"
"""Title of the group that saves and opens files; the other groups have settings."""
OWN = "a file"
"""Choice of a text that is the content of a file: the files group opens one."""
GROUPS = (
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
    "Decomposition",
    "Method",
    "Stop",
)
"""Order of the groups: the scene, then its solution from Decomposition on."""


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
        self._echoes = Echoes(state)
        self._positions = Echoes(state)
        self._dialog: CurveDialog | None = None
        self._edit_button: pmui.Button | None = None
        self.slider: pmui.FloatSlider | None = None
        self.field, self.views = self._make()
        self.field.param.watch(lambda event: self._on_field(event.new), "value")
        self.update()
        # No browser has shown the initial values of the widgets.
        self._echoes = Echoes(state)
        self._positions = Echoes(state)

    def update(self) -> None:
        """Show the value of the setting, and whether it applies."""
        settings = self._state.settings
        # Widgets report these changes, too, as if a person had made them.
        self._is_updating = True
        try:
            applies = settings.applies(self.name)
            for view in self.views:
                view.visible = applies
            self._show(getattr(settings, self.name))
            self._explain("")
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
        if isinstance(definition, CurveParameter):
            options = [*definition.presets, POINTS]
            field = pmui.Select(options=options, variant="standard", **more)
            return field, [pn.Column(field, margin=0)]
        if isinstance(definition, param.Boolean):
            field = pmui.Switch(**more)
            return field, [field]
        if isinstance(definition, TextParameter):
            return self._make_text(definition, more)
        if isinstance(definition, param.Selector):
            options = list(definition.objects)
            field = pmui.Select(options=options, variant="standard", **more)
            return field, [field]
        # All others are numbers: a field to type in, and below it a slider.
        more |= {"margin": (3, 0, 0, 0), "variant": "standard", **looks("number")}
        default = self._written(definition.default)
        field = pmui.TextInput(placeholder=f"{default} by default", **more)
        self._is_logarithmic = is_logarithmic(definition)
        self.slider = self._make_slider()
        return field, [field, self.slider]

    def _make_text(
        self, definition: TextParameter, more: dict[str, Any]
    ) -> tuple[Any, list[Any]]:
        """Make the field of a text: presets and an open file, or text input."""
        if not definition.is_file:
            field = pmui.TextInput(variant="standard", **more)
            return field, [field]
        options = list(definition.presets)
        field = pmui.Select(options=options, variant="standard", **more)
        return field, [field]

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
            presets = list(self._definition.presets)
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
        self.update()
        self._explain(refusal)

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
        self.update()
        self._explain(self._state.refusal)

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


class Controls:
    """All controls of the present scene: main ones, and groups that open.

    Controls that are not in sight follow the state once they are opened: each widget
    costs a browser time.
    """

    def __init__(self, state: PageState, *, is_open: bool = True) -> None:
        self._state = state
        self._is_open = is_open
        self._controls: list[SettingControl] = []
        # Toggle buttons have no pictures of their own: rules of style give each of them
        # one.
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
        self._show_scene = linked(
            self._scene, state, lambda: state.settings.scene, self._choose_scene
        )
        self._groups = pmui.Accordion(
            margin=(10, 0),
            width=WIDTH,
            title_variant="body2",
            disable_gutters=True,
            elevation=0,
            **looks("groups"),
        )
        self._groups.param.watch(lambda event: self._open(), "active")
        self.view = pmui.Column(self._scene, self._groups, width=WIDTH, margin=(4, 12))
        self._files: pn.Column | None = None
        self._built = ""
        self._titles: list[str] = []
        self._chief: list[str] = []
        self._made: dict[str, SettingControl] = {}
        state.param.watch(lambda event: self.update(), "settings")
        self.update()

    def _choose_scene(self, scene: str) -> None:
        fade_first(self._state, partial(self._state.choose_scene, scene))

    def open(self, is_open: bool) -> None:
        """Start or stop following the state."""
        self._is_open = is_open
        self.update()

    def update(self) -> None:
        """Show the present values, if the controls are open.

        With another scene build the controls of that scene.
        """
        if not self._is_open:
            return
        settings = self._state.settings
        with pn.io.hold():
            if settings.scene != self._built:
                with rebuilt():
                    self._build()
            else:
                for control in self._controls:
                    control.update()
                self._complete()

    def _build(self) -> None:
        settings = self._state.settings
        self._built = settings.scene
        self._show_scene()
        self._scene.label = settings.title
        self._controls = []
        self._made = {}
        self._chief, groups = _groups_of(type(settings))
        self._complete()
        # The numbers of open groups would mean groups of the scene before. Files alone
        # stay open: settings that a file brings with their scene have a message.
        has_files = FILES in [self._titles[number] for number in self._groups.active]
        self._groups.active = []
        self._titles = [*groups, FILES]
        # Each group is a spacer until it is opened: it costs a page less than a column.
        self._closed = dict(enumerate([*groups.items(), (FILES, [])]))
        # A title that is given beside a group costs a pane that nobody sees. The names
        # of groups are read where their number changes.
        self._groups.objects = []
        self._groups.objects = [
            pn.Spacer(name=title, height=0) for title in self._titles
        ]
        if has_files:
            self._groups.active = [len(groups)]

    def _complete(self) -> None:
        """Make the main controls that apply; others would cost each page their time."""
        settings = self._state.settings
        missing = [name for name in self._chief if name not in self._made]
        new = [name for name in missing if settings.applies(name)]
        for name in new:
            self._made[name] = SettingControl(name, self._state)
            self._controls.append(self._made[name])
        if new:
            made = [self._made[name] for name in self._chief if name in self._made]
            self.view[1:-1] = views_of(made)

    def _open(self) -> None:
        """Build groups that are opened for the first time."""
        for number in self._closed.keys() & set(self._groups.active):
            _, names = self._closed.pop(number)
            if names:
                controls = [SettingControl(name, self._state) for name in names]
                self._controls += controls
                view = pn.Column(*views_of(controls), margin=0)
            else:
                if self._files is None:
                    self._files = files_panel(self._state, WIDTH)
                view = self._files
            views = list(self._groups)
            views[number] = view
            self._groups.objects = views


def views_of(controls: Iterable[SettingControl]) -> list[Any]:
    """Widgets of controls on the page, in order."""
    views = []
    for control in controls:
        views += control.views
    return views


def _groups_of(kind: Any) -> tuple[list[str], dict[str, list[str]]]:
    """The main settings of a scene, and other variable ones by group."""
    definitions = kind.definitions()
    chief = [name for name in (*kind.CHIEF, *kind.ALSO_CHIEF) if name in definitions]
    groups: dict[str, list[str]] = {group: [] for group in GROUPS}
    for name, definition in definitions.items():
        if name not in chief and len(getattr(definition, "objects", "any")) > 1:
            groups.setdefault(properties_of(definition).group, []).append(name)
    return chief, {group: names for group, names in groups.items() if names}
