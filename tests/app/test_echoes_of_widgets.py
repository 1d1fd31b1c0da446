"""The browser's echo of a widget's value is no choice of anybody."""

from __future__ import annotations

import panel_material_ui as pmui
import pytest

from app.controls import Controls
from app.echoes import linked_to
from app.setting_control import SettingControl
from app.state import TABS, PageState, default_settings


def changed_twice(name: str, *values: object) -> tuple[PageState, SettingControl]:
    """Page on which a setting had two values in turn, and the control of it."""
    state = PageState(default_settings("bar"))
    control = SettingControl(name, state)
    for value in values:
        state.change(**{name: value})
        control.update()
    return state, control


@pytest.mark.parametrize(
    ("name", "values", "echo"),
    [
        ("peak", (1000.0, 1100.0), "1000"),
        ("load", ("cycles", "ramp"), "cycles"),
        ("multiscale", (False, True), False),
    ],
)
def test_a_value_that_a_field_showed_on_the_way_changes_nothing_later(
    name: str, values: tuple[object, object], echo: object
) -> None:
    state, control = changed_twice(name, *values)
    present = control.field.value
    control.field.value = echo
    assert state.settings.values()[name] == values[1]
    assert control.field.value == present


def test_a_position_that_a_slider_showed_on_the_way_changes_nothing_later() -> None:
    state, control = changed_twice("peak", 1000.0, 1100.0)
    control.slider.value = 1000.0
    assert state.settings.values()["peak"] == 1100.0
    assert control.slider.value == 1100.0
    control.slider.value = 1300.0
    assert state.settings.values()["peak"] == 1300.0


def test_the_scene_that_was_left_meanwhile_is_not_chosen_again() -> None:
    state = PageState(default_settings("bar"))
    controls = Controls(state)
    for scene in ("block", "bar"):
        state.choose_scene(scene)
    controls.view[0].value = "block"
    assert state.settings.scene == "bar"
    assert controls.view[0].value == "bar"


def test_the_same_value_is_a_persons_once_the_browser_has_shown_all() -> None:
    state, control = changed_twice("peak", 1000.0, 1100.0)
    state.shown = state.given
    control.field.value = "1000"
    assert state.settings.values()["peak"] == 1000.0


def test_a_tab_that_the_page_left_meanwhile_is_not_turned_to_again() -> None:
    state = PageState(default_settings("bar"))
    tabs = linked_to(state, "tab", pmui.RadioButtonGroup(options=TABS, value="Live"))
    state.tab = "Fit"
    state.tab = "Live"
    tabs.value = "Fit"
    assert (state.tab, tabs.value) == ("Live", "Live")
    tabs.value = "Reports"
    assert state.tab == "Reports"


def test_a_value_that_a_person_had_typed_may_be_typed_again() -> None:
    state = PageState(default_settings("bar"))
    control = SettingControl("peak", state)
    control.field.value = "1100"
    state.change(peak=900.0)
    control.update()
    control.field.value = "1100"
    assert state.settings.values()["peak"] == 1100.0


def test_a_value_is_known_until_what_replaced_it_is_shown() -> None:
    state, control = changed_twice("peak", 1000.0)
    state.shown = state.given
    state.change(peak=1100.0)
    control.update()
    control.field.value = "1000"
    assert state.settings.values()["peak"] == 1100.0
