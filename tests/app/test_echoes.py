"""The browser's echo of a widget's value is no choice of anybody."""

from __future__ import annotations

import app.browser
from app.controls import SettingControl
from app.state import PageState, default_settings


def changed_twice() -> tuple[PageState, SettingControl]:
    """Page whose peak load was 1000 N and is 1100 N, and the control of the peak."""
    state = PageState(default_settings("bar"))
    control = SettingControl("peak", state)
    for peak in (1000.0, 1100.0):
        state.change(peak=peak)
        control.update()
    return state, control


def test_a_value_that_a_field_showed_on_the_way_changes_nothing_later() -> None:
    state, control = changed_twice()
    control.field.value = "1000"
    assert state.settings.values()["peak"] == 1100.0


def test_a_position_that_a_slider_showed_on_the_way_changes_nothing_later() -> None:
    state, control = changed_twice()
    control.slider.value = 1000.0
    assert state.settings.values()["peak"] == 1100.0
    assert control.slider.value == 1100.0
    control.slider.value = 1300.0
    assert state.settings.values()["peak"] == 1300.0


def test_later_the_same_value_is_typed_by_hand(monkeypatch) -> None:
    monkeypatch.setattr(app.browser, "LASTS", 0.0)
    state, control = changed_twice()
    control.field.value = "1000"
    assert state.settings.values()["peak"] == 1000.0
