"""The controls at the side show every setting, and refuse what does not hold."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import chain
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param
import pytest
from panel.models.esm import ReactComponent
from panel.util import edit_readonly

from app.controls import FILES, Controls, _groups_of
from app.files.points import CurveDialog
from app.messages import Start
from app.refusals import in_titles
from app.setting_control import POINTS, SettingControl
from app.state import PageState, default_settings
from solver.files.amounts import Unit, unit_of
from solver.files.typed import typed_amount
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE
from solver.settings.definitions import CurveParameter, TextParameter
from solver.settings.scene import Settings


@cache
def names(scene: str) -> list[str]:
    """Settings of a scene."""
    return list(default_settings(scene).definitions())


def new_names(scene: str) -> list[str]:
    """Settings of a scene but those that are of a scene before it, too."""
    definitions = default_settings(scene).definitions()
    before = set[param.Parameter]()
    for other in CATALOGUE:
        if other == scene:
            break
        before.update(default_settings(other).definitions().values())
    return [name for name, each in definitions.items() if each not in before]


@cache
def defaults(scene: str) -> Settings:
    return default_settings(scene)


def of_scene(scene: str) -> PageState:
    return PageState(defaults(scene))


def held(state: PageState, name: str) -> Any:
    return getattr(state.settings, name)


def holds(state: PageState, name: str, value: float) -> bool:
    try:
        state.settings.with_change(name, value)
    except RefusedError:
        return False
    return True


@pytest.mark.parametrize("scene", CATALOGUE)
def test_every_setting_has_a_widget_that_shows_its_value_and_takes_others(
    scene: str,
) -> None:
    for name in new_names(scene):
        state = of_scene(scene)
        control = SettingControl(name, state)
        definition = state.settings.definitions()[name]
        value = held(state, name)
        if control.slider is not None:
            unit = unit_of(definition)
            assert typed_amount(
                control.field.value, unit, definition.metadata["about"].unit
            ) == (pytest.approx(value, rel=1e-9))
            slide_to_both_ends(control, state)
            # The browser has shown all that was slid: what is typed is a person's.
            state.shown = state.given
            ends = *definition.softbounds[::-1], value
            another = another_that_holds(state, name, ends)
            control.field.value = f"{another / unit.factor:.12g}"
            assert held(state, name) == pytest.approx(another, rel=1e-9), name
        elif isinstance(definition, param.Boolean):
            control.field.value = not value
            assert held(state, name) is not value
        elif isinstance(definition, TextParameter) and not definition.is_file:
            control.field.value = "nowhere held"
            assert state.refusal
            assert held(state, name) == value
        elif others := [
            one for one in control.field.options if one not in (value, POINTS)
        ]:
            another = others[0]
            control.field.value = another
            assert held(state, name) == another or state.refusal, name


def another_that_holds(state: PageState, name: str, values: Sequence[float]) -> float:
    """The first of some values that is another one and holds for a setting."""
    present = held(state, name)
    others = [value for value in values if value != present]
    return next(value for value in others if holds(state, name, value))


def slide_to_both_ends(control: SettingControl, state: PageState) -> None:
    """Both ends of a slider hold, or are refused at the control."""
    slider = control.slider
    for end in ("start", "end"):
        place = getattr(slider, end)
        slider.value = place
        with param.edit_constant(slider):
            slider.value_throttled = place
        is_refused = control.field.error_state
        assert slider.value == pytest.approx(place) or is_refused, control.name
        told = ""
        if is_refused:
            told = state.refusal
        assert control.field.helper_text == told


def test_a_field_keeps_its_unit_whatever_is_typed() -> None:
    state = of_scene("incline")
    control = SettingControl("weight", state)
    assert control.field.label.endswith(", kN")
    for text, newtons in (
        ("-5", -5e3),
        ("900", 9e5),
        ("0,25", 250.0),
        ("3 MN", 3e6),
        ("7 N", 7.0),
    ):
        control.field.value = text
        if newtons < 0.0:
            assert "−5 kN" in control.field.helper_text
        else:
            assert held(state, "weight") == newtons
        assert control.field.label.endswith(", kN")


def test_a_refusal_stands_at_the_field_in_its_unit_and_the_value_before_is_back() -> (
    None
):
    state = of_scene("bar")
    young = SettingControl("young", state)
    parts = SettingControl("substructures", state)
    young.field.value = "-3"
    assert young.field.value == "210"
    assert young.field.error_state
    assert "Young's modulus E cannot be −3 GPa" in young.field.helper_text
    parts.field.value = "ten"
    assert parts.field.helper_text == "Substructures cannot be “ten”: write a number."
    parts.field.value = "60"
    assert "raise Elements" in parts.field.helper_text
    assert state.refusal == parts.field.helper_text
    parts.field.value = "20"
    parts.update()
    assert not parts.field.error_state
    assert not state.refusal


def test_a_refusal_is_forgotten_once_the_shown_value_is_typed_again() -> None:
    state = of_scene("bar")
    field = SettingControl("peak", state).field

    def type_in(**values: str) -> None:
        """Have the browser tell what is typed, and what is entered."""
        with edit_readonly(field):
            field.param.update(**values)

    type_in(value="moon", value_input="moon")
    assert field.error_state
    type_in(value_input="90")
    assert field.error_state
    type_in(value_input="900")
    assert (field.error_state, field.helper_text, state.refusal) == (False, "", "")
    type_in(value="moon", value_input="moon")
    # Enter is told before what was entered.
    field.param.trigger("enter_pressed")
    assert not field.error_state
    type_in(value="moon", value_input="moon")
    type_in(value="sun", value_input="sun")
    assert "sun" in field.helper_text


def test_a_refusal_is_forgotten_once_the_list_closes_on_the_shown_option() -> None:
    state = of_scene("strand")
    field = SettingControl("pressure_load", state).field
    told: list[bool] = []
    field.param.watch(lambda event: told.append(event.new), "error_state")

    def choose(option: str) -> None:
        """Have the browser tell the choice, as soon as the list is closed."""
        field.dropdown_open = True
        field.param.update(value=option, dropdown_open=False)

    for refused in ("shaken", "tightening", "tightening"):
        choose(refused)
        assert field.value == "steady"
        assert refused in field.helper_text
        assert state.refusal == field.helper_text
    # What is told twice in a moment the browser may show in either order.
    assert told == [True]
    choose("steady")
    assert told == [True, False]
    assert "cannot" not in field.helper_text + state.refusal
    choose("shaken")
    choose("loosening")
    assert told[-1]


def test_a_refusal_has_the_units_and_names_of_the_page_and_keeps_its_other_words() -> (
    None
):
    state = of_scene("bar")
    state.change(pressure_load=[[0.0, 1.0], [1.0, -1.0]])
    assert "pressures of at least 0 kN/m" in state.refusal
    state.change(peak=2e15)
    assert state.refusal.endswith("Allowed: any number (at most 1·10¹⁵ N in size).")
    state.change(body_load="nothing")
    assert "delayed, cycles, or a table of time and force" in state.refusal
    state = of_scene("block")
    state.change(substructures_up=state.settings.elements_up + 1)
    assert "lower Substructures up or raise Elements up" in state.refusal


def test_advice_on_a_run_has_the_names_of_the_page_and_keeps_its_other_words() -> None:
    advice = (
        "Friction falls with slip. Raise max_iterations, or lower friction_ratio or "
        "friction, or try a k_scale ten times smaller, where friction falls, or set "
        "finish=at-once (residual 3e-14)."
    )
    assert in_titles(default_settings("bar"), advice) == (
        "Friction falls with slip. Raise Most iterations, or lower Last friction over "
        "first or Friction coefficient μ, or try a Factor on k ten times smaller, "
        "where friction falls, or set Finish = at-once (residual 3·10⁻¹⁴)."
    )


def test_amounts_with_a_power_of_ten_are_in_a_unit_of_their_size() -> None:
    remark = "some body up to 9.4e-06 m away, with 2e+05 N/m and 3e-9 of the force"
    assert in_titles(default_settings("bar"), remark) == (
        "some body up to 9.4 µm away, with 200000 N/m and 3·10⁻⁹ of the force"
    )


def test_an_empty_field_is_the_default() -> None:
    state = of_scene("bar")
    control = SettingControl("peak", state)
    control.field.value = "1200"
    control.field.value = ""
    control.update()
    assert (held(state, "peak"), control.field.value) == (900.0, "900")


def test_a_slider_stops_at_what_others_allow_and_says_so_when_it_is_let_go() -> None:
    state = of_scene("strand")
    told: list[str] = []
    state.param.watch(lambda event: told.append(event.new), "refusal")
    control = SettingControl("friction", state)
    assert control.slider is not None
    for place in (0.2, 0.1, 0.0):
        control.slider.value = place
        assert state.is_dragged
    least = held(state, "friction")
    assert least == 0.2
    with param.edit_constant(control.slider):
        control.slider.value_throttled = 0.0
    assert held(state, "friction") == least
    assert control.field.value == f"{least:g}"
    assert "Friction coefficient μ cannot be 0" in control.field.helper_text
    assert not state.is_dragged


def test_a_key_on_a_slider_starts_one_run_and_a_hand_that_drags_one_for_each_move() -> (
    None
):
    state = of_scene("bar")
    orders = list[object]()
    control = SettingControl("friction", state)
    state.send = orders.append
    with param.edit_constant(control.slider):
        control.slider.param.update(value=0.5, value_throttled=0.5)
    assert [order.is_dragged for order in orders if isinstance(order, Start)] == [False]
    for place in (0.6, 0.7):
        control.slider.value = place
    with param.edit_constant(control.slider):
        control.slider.value_throttled = 0.7
    assert [order.is_dragged for order in orders if isinstance(order, Start)][1:] == [
        *(True, True, False),
    ]
    assert held(state, "friction") == 0.7


def test_a_slider_ends_where_another_setting_has_it_end() -> None:
    state = of_scene("strand")
    control = SettingControl("broken", state)
    assert control.slider is not None
    assert control.slider.end == state.settings.largest_counts["broken"]
    state.change(wires=7)
    control.update()
    assert control.slider.end == state.settings.largest_counts["broken"]


def test_controls_that_do_nothing_here_are_not_made_or_hidden() -> None:
    state = of_scene("bar")
    controls = Controls(state)

    def fields() -> list[str]:
        made = controls.view.select(pmui.TextInput)
        return [field.label for field in made if field.visible]

    peak, *others = fields()
    assert len(controls.view.select(pmui.TextInput)) == 1 + len(others)
    # It comes in its place, and may go and come back.
    for load, seed in (("random", ["Seed"]), ("sine", []), ("random", ["Seed"])):
        state.change(load=load)
        assert fields() == [peak, *seed, *others]


@pytest.mark.parametrize("scene", CATALOGUE)
def test_chief_settings_and_groups_are_all_that_have_several_values(scene: str) -> None:
    chief, groups = _groups_of(type(defaults(scene)))
    shown = [*chief, *chain.from_iterable(groups.values())]
    assert len(shown) == len(set(shown))
    definitions = defaults(scene).definitions()
    assert chief
    assert set(shown) <= set(definitions)
    for name in set(definitions) - set(shown):
        assert len(getattr(definitions[name], "objects", "any")) == 1, name


def test_groups_are_built_when_they_are_opened_and_hold_all_that_is_not_chief() -> None:
    controls = Controls(of_scene("incline"))
    chief, groups = _groups_of(type(defaults("incline")))
    made = [control.name for control in controls._made.values()]
    assert made == [name for name in chief if defaults("incline").applies(name)]
    accordion = controls._groups
    accordion.active = list(range(len(accordion)))
    shown = [control.name for control in controls._made.values()]
    assert sorted(shown) == sorted([*made, *chain.from_iterable(groups.values())])


def test_controls_out_of_sight_are_made_once_they_are_opened() -> None:
    state = of_scene("bar")
    controls = Controls(state, is_open=False)
    assert not controls._made
    state.choose_scene("strand")
    controls.open(True)
    shown = {control.name: control for control in controls._made.values()}
    assert set(shown) <= set(names("strand"))
    assert controls._scene.value == "strand"
    state.change(peak=held(state, "peak") + 1.0)
    current = shown["peak"].field.value
    controls.open(False)
    state.change(peak=held(state, "peak") + 1.0)
    assert shown["peak"].field.value == current
    controls.open(True)
    assert shown["peak"].field.value != current


def test_each_group_has_its_title_and_no_pane_beside_it() -> None:
    state = of_scene("bar")
    controls = Controls(state)
    root = controls.view.get_root()
    for scene in ("bar", "block", "incline"):
        state.choose_scene(scene)
        _, groups = _groups_of(type(defaults(scene)))
        controls._groups.active = [0]
        (accordion,) = root.select({"type": ReactComponent, "name": "Accordion"})
        assert accordion.data._names == [*groups, FILES]
        assert len(accordion.data.objects) == len(groups) + 1
        assert not accordion.data._headers


def test_a_message_on_settings_of_another_scene_stays_in_sight() -> None:
    state = of_scene("bar")
    controls = Controls(state)
    groups = controls._groups
    groups.active = [len(groups) - 1]
    (opened,) = groups[-1].select(pmui.FileInput)
    of_fault = b'scene = "fault"\nfriction_law = "slip-dependent"\nslip_length = 1e-3'
    opened.param.update(filename="old.toml", value=of_fault)
    assert state.settings.scene == "fault"
    assert groups.active == [len(groups) - 1]
    said = " ".join(str(pane.object) for pane in groups[-1].select(pn.pane.HTML))
    assert "old.toml: settings of the scene fault. " in said
    assert "both sides" in said
    # A scene that a person chooses has none.
    state.choose_scene("block")
    said = " ".join(str(pane.object) for pane in groups[-1].select(pn.pane.HTML))
    assert "old.toml" not in said


def test_each_scene_keeps_its_settings() -> None:
    state = of_scene("bar")
    controls = Controls(state)
    state.change(peak=1100.0)
    controls._scene.value = "rope"
    assert state.settings.scene == "rope"
    controls._scene.value = "bar"
    assert held(state, "peak") == 1100.0


def test_points_are_typed_dragged_and_opened_and_the_run_lasts_as_long_as_they_do() -> (
    None
):
    state = of_scene("bar")
    control = SettingControl("load", state)
    control.field.value = POINTS
    dialog = control._dialog
    assert dialog is not None
    assert dialog.view.open
    assert control.field.value == "sine"
    dialog.text.value = "time [s],force [kN]\n0,0\n1,0.9\n1.5,0"
    assert held(state, "load") == ((0.0, 0.0), (1.0, 900.0), (1.5, 0.0))
    assert (state.settings.duration, control.field.value) == (1.5, "sine")
    control.update()
    assert control.field.value == POINTS
    dialog.source.data = {"x": [0.0, 2.0, 1.0], "y": [0.0, 0.0, 500.0]}
    assert held(state, "load") == ((0.0, 0.0), (1.0, 500.0), (2.0, 0.0))
    dialog.text.value = "time,force\n0,0\n1,x"
    assert dialog.text.error_state
    assert "line 3" in dialog.text.helper_text
    assert held(state, "load")[-1] == (2.0, 0.0)


def test_a_point_is_dragged_and_all_others_keep_their_digits() -> None:
    steep = [(0.0, 0.0), (1.0, 0.0), (1.000001, 1234.5678), (2.0, 900.0)]
    state = of_scene("bar")
    state.change(load=steep)
    dialog = CurveDialog("load", state)
    dialog.update()
    x, y = zip(*steep, strict=True)
    dialog.source.data = {"x": list(x), "y": [*y[:-1], 800.123456]}
    assert held(state, "load") == (*steep[:-1], (2.0, 800.123))
    dialog.text.value = dialog.text.value.replace("800.123", "700")
    assert held(state, "load") == (*steep[:-1], (2.0, 700.0))


def test_a_path_has_a_button_to_edit_its_points_as_long_as_it_has_points() -> None:
    state = of_scene("bar")
    control = SettingControl("load", state)

    def labels() -> list[str]:
        column = control.views[0]
        return [each.label for each in column if each.visible]

    field = control.field.label
    assert labels() == [field]
    state.change(load=((0.0, 0.0), (1.0, 900.0)))
    control.update()
    assert labels() == [field, "Edit points"]
    state.change(load="sine")
    control.update()
    assert labels() == [field]


def test_points_that_stand_for_a_preset_are_taken_as_they_stand() -> None:
    taken = set[param.Parameter]()
    settings = list[tuple[str, str]]()
    for scene in CATALOGUE:
        settings += [(scene, name) for name in names(scene)]
    for scene, name in settings:
        definition = defaults(scene).definitions()[name]
        is_new = isinstance(definition, CurveParameter) and definition not in taken
        # A definition of several scenes is one, wherever it applies.
        if not is_new or not defaults(scene).applies(name):
            continue
        taken.add(definition)
        state = of_scene(scene)
        dialog = CurveDialog(name, state)
        dialog.update()
        dialog._take(dialog.text.value, "the text")
        assert isinstance(held(state, name), tuple), state.refusal
    assert taken


def test_a_small_cross_section_has_no_power_of_ten_in_its_field() -> None:
    """A cross section was 3.14e-06 m²."""
    state = of_scene("bar")
    control = SettingControl("section", state)
    assert (control.field.value, control.field.label[-3:]) == ("3.14", "mm²")
    control.field.value = "0.05 cm2"
    assert held(state, "section") == pytest.approx(5e-6)


def test_a_number_is_read_in_each_unit_of_its_kind() -> None:
    assert typed_amount("2 d", Unit("s"), "s") == 172800.0
    assert typed_amount("2 min", Unit("h", 3600.0), "s") == 120.0
    assert typed_amount("3 N/mm2", Unit("kPa", 1e3), "Pa") == 3e6
    newton = Unit("N")
    assert typed_amount("2 lbf", newton, "N") == 2 * 4.4482216152605
    assert typed_amount("1 200", newton, "N") == 1200.0
    assert typed_amount("1\u202f200,5 kN", newton, "N") == 1200500.0


def test_a_number_in_another_unit_is_refused() -> None:
    for text in ("5 kg", "1e", "--3", "5 5"):
        with pytest.raises(ValueError, match="write a number"):
            typed_amount(text, Unit("kN", 1e3), "N")


def test_a_preset_of_a_path_is_described_where_it_is_chosen() -> None:
    state = of_scene("bar")
    control = SettingControl("load", state)
    assert control.field.helper_text.startswith("A wave of a sine: to the value")
    assert (
        "triangle: rises evenly to the value in the middle" in control.field.description
    )
    control.field.value = "ramp"
    control.update()
    assert (
        control.field.helper_text
        == "Rises evenly from 0 to the value, which it has at the end"
    )
    assert not control.field.error_state
    state.change(load=[[0.0, 0.0], [1.0, 500.0]])
    control.update()
    assert control.field.helper_text == ""
