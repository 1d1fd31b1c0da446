"""A table that a user brings goes to one load path, never to one that was guessed, and whole."""

from __future__ import annotations

from typing import Any

import pytest

from app.components.form import shown_value
from app.session.uploads import cut_off, load_in
from app.shell.address import LEFT_OUT, query_of, settings_from_query
from solver.definitions import SettingError
from solver.scenes import CATALOGUE
from solver.settings import Settings

ROWS = ((0.0, 0.0), (1.0, 500.0))
TABLE = "0,0\n1,500\n"


def settings_of(scene: str, **changes: Any) -> Settings:
    return CATALOGUE[scene].settings.checked(changes)


@pytest.mark.parametrize("head", ["", "time,force\n", "Time, Force\n", "time,load\n"])
def test_the_only_path_of_a_load_takes_it(head: str) -> None:
    found, _ = load_in(head + TABLE, "path.csv", settings_of("bar"))
    assert found.changed() == {"load": ROWS}


def test_a_pressure_is_named() -> None:
    found, _ = load_in(f"time,pressure_load\n{TABLE}", "path.csv", settings_of("bar"))
    assert found.changed() == {"pressure_load": ROWS}


@pytest.mark.parametrize("name", ["top_normal_load", "top_tangential_load"])
def test_the_path_that_its_head_names_takes_it(name: str) -> None:
    found, _ = load_in(f"time,{name}\n{TABLE}", "path.csv", settings_of("block"))
    assert found.changed() == {name: ROWS}


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


def test_a_table_brings_its_duration_and_says_how_it_is_read() -> None:
    found, said = load_in("Zeit [s];Kraft [kN]\n0;0\n10;0,5\n", "path.csv", settings_of("bar"))
    assert found.changed() == {"load": ((0.0, 0.0), (10.0, 500.0)), "duration": 10.0}
    assert said == (
        "Load path: Zeit in s, Kraft in kN, 2 points, from 0 to 0.5 kN. The run lasts 10 s, and "
        "reads them at 101 instants."
    )
    assert cut_off(found) == ""
    short = found.replace(duration=1.0)
    assert cut_off(short) == "Load path goes on to 10 s, but the run ends at 1 s."


def test_a_run_lasts_until_the_longest_table_ends() -> None:
    long, _ = load_in("time,top_normal_load\n0,0\n4,1e5\n", "a.csv", settings_of("block"))
    both, _ = load_in("time,top_tangential_load\n0,0\n2,1e5\n", "b.csv", long)
    assert both.duration == 4.0


def test_a_long_table_is_no_part_of_an_address_which_says_so() -> None:
    rows = "".join(f"{at / 2000},{at % 7}\n" for at in range(20_001))
    settings, said = load_in(rows, "long.csv", settings_of("bar"))
    assert "20001 points" in said
    query = query_of(settings)
    assert len(query) < 100
    assert f"{LEFT_OUT}=load" in query
    again, complaint = settings_from_query(query)
    assert again.changed() == {"duration": 10.0}
    assert complaint == "From the address: load is too long for it: open its file."
    assert (
        query_of(settings_of("bar", finish="accuracy"), twin=settings.replace(finish="accuracy"))
        == "?scene=bar&compare=%7B%22duration%22%3A10.0%7D&file=load"
    )


def test_a_long_table_is_shown_by_its_ups_and_downs() -> None:
    table = tuple(
        (float(at), 5.0 if at == 7_777 else -5.0 if at == 7_778 else 0.0) for at in range(20_001)
    )
    shown = shown_value(table)
    assert shown["count"] == 20_001
    assert len(shown["drawn"]) <= 250
    assert {table[0], table[7_777], table[7_778], table[-1]} <= set(shown["drawn"])
    assert sorted(shown["drawn"]) == shown["drawn"]
    assert shown_value(table[:100]) == table[:100]
    assert shown_value("sine") == "sine"
