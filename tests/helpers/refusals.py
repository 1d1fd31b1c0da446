"""Texts with which settings are refused."""

from __future__ import annotations

import pytest

from solver.settings.values import SettingError


def refusal(action):
    with pytest.raises(SettingError) as caught:
        action()
    text = str(caught.value)
    assert "\n" not in text
    return text


def assert_names(text, name, value, range_):
    assert name in text
    assert value in text
    assert f"allowed: {range_}" in text
