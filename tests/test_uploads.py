"""A table that a user brings goes to one load path, and never to one that was guessed."""

from __future__ import annotations

from typing import Any

import pytest

from app.uploads import load_in
from solver.definitions import SettingError
from solver.scenes import CATALOGUE
from solver.settings import Settings

ROWS = [[0.0, 0.0], [1.0, 500.0]]
TABLE = "0,0\n1,500\n"


def settings_of(scene: str, **changes: Any) -> Settings:
    return CATALOGUE[scene].settings.checked(changes)


@pytest.mark.parametrize("head", ["", "time,force\n", "Time, Force\n", "time,load\n"])
def test_the_only_path_takes_it(head: str) -> None:
    assert load_in(head + TABLE, "path.csv", settings_of("bar")) == ("load", ROWS)


@pytest.mark.parametrize("name", ["top_normal_load", "top_tangential_load"])
def test_the_path_that_its_head_names_takes_it(name: str) -> None:
    assert load_in(f"time,{name}\n{TABLE}", "path.csv", settings_of("block")) == (name, ROWS)


@pytest.mark.parametrize("head", ["", "time,value\n", "time,left_normal_load\n"])
def test_where_several_apply_and_none_is_named_it_is_refused_with_their_names(head: str) -> None:
    with pytest.raises(SettingError) as caught:
        load_in(head + TABLE, "path.csv", settings_of("block"))
    for part in ("path.csv", "top_normal_load, top_tangential_load", "first line"):
        assert part in str(caught.value)


def test_where_none_applies_it_is_refused() -> None:
    with pytest.raises(SettingError, match="none applies"):
        load_in(TABLE, "path.csv", settings_of("block", top="clamped"))


def test_a_table_that_cannot_be_read_is_refused_for_its_line() -> None:
    with pytest.raises(SettingError, match="line 2"):
        load_in("0,0\n1,much\n", "path.csv", settings_of("bar"))
