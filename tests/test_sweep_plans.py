"""A sweep's plan holds what was asked for, and foolish ones are refused in a line."""

from __future__ import annotations

import contextlib
import json
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.definitions import SettingError
from solver.scenes.bar import BarSettings
from solver.study.sweep import plan_from_plain, plan_of
from solver.study.sweep.order import snake
from solver.study.sweep.plan import axis_of

BAR = BarSettings.checked({})
ANY = settings(max_examples=60)


def values_of(text: str) -> list[Any]:
    return list(axis_of(BAR, text).values)


def test_a_range_holds_its_ends_and_what_is_evenly_between() -> None:
    assert values_of("friction=0.1:0.6:6") == [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
    assert values_of("k_scale=0.01:100:5:log") == [0.01, 0.1, 1.0, 10.0, 100.0]
    assert values_of("peak=900:-900:3") == [900.0, 0.0, -900.0]


def test_a_list_is_taken_as_it_is_each_value_once() -> None:
    assert values_of("load=triangle,sine,triangle") == ["triangle", "sine"]
    assert values_of("elements=100, 50") == [100, 50]
    assert values_of("multiscale=true,false") == [True, False]


def test_whole_numbers_are_rounded_and_made_unique() -> None:
    assert values_of("substructures=1:4:31") == [1, 2, 3, 4]
    found = values_of("elements=50:3200:7:log")
    assert found == [50, 100, 200, 400, 800, 1600, 3200]
    assert all(isinstance(value, int) for value in found)


FOOLISH = [
    (["frction=0.1:0.6:3"], ["iterations"], "did you mean friction?"),
    (["friction"], ["iterations"], "name a setting and its values"),
    (["friction="], ["iterations"], "name a setting and its values"),
    (["friction=0.1:0.6"], ["iterations"], "three numbers"),
    (["friction=0.1:0.6:lots"], ["iterations"], "three numbers"),
    (["friction=0.1:0.6:1"], ["iterations"], "whole number from 2"),
    (["friction=0.1:0.6:2.5"], ["iterations"], "whole number from 2"),
    (["friction=0.1:0.6:nan"], ["iterations"], "whole number from 2"),
    (["friction=0.1:0.1:5"], ["iterations"], "the two ends differ"),
    (["friction=-0.1:0.1:5"], ["iterations"], "inside this range"),
    (["friction=0.1:inf:5"], ["iterations"], "finite"),
    (["peak=-1:1:5:log"], ["iterations"], "above zero"),
    (["load=sine:ramp:3"], ["iterations"], "list its values"),
    (["load=sine,cosine"], ["iterations"], "choose a preset"),
    (["elements=10.5,20"], ["iterations"], "a whole number"),
    (["friction=0.1,,0.2"], ["iterations"], "write a number"),
    (["friction=0.1,0.2", "friction=0.3,0.4"], ["iterations"], "each of them once"),
    (["friction=0.1:1:150", "peak=1:900:150"], ["iterations"], "22500"),
    ([], ["iterations"], "vary one or two"),
    (["friction=0.1,0.2", "peak=1,2", "elements=9,10"], ["iterations"], "vary one or two"),
    (["friction=0.1,0.2"], [], "at least one"),
    (["friction=0.1,0.2"], ["dissipated"], "choose one of these"),
    (["friction=0.1,0.2"], ["iterations@3"], "takes no parameter"),
]


@pytest.mark.parametrize(("vary", "of", "words"), FOOLISH, ids=lambda value: str(value)[:40])
def test_a_foolish_plan_is_refused_in_a_line(vary: list[str], of: list[str], words: str) -> None:
    with pytest.raises(SettingError) as refusal:
        plan_of(BAR, vary, of)
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)


@ANY
@given(st.sampled_from(["friction", "elements", "load", "method", "multiscale"]), st.text())
def test_no_text_breaks_the_reading_of_a_range(name: str, text: str) -> None:
    with contextlib.suppress(SettingError):
        assert axis_of(BAR, f"{name}={text}").values


def test_a_point_changes_what_varies_and_nothing_else() -> None:
    plan = plan_of(BAR.replace(elements=40), ["load=sine,ramp", "peak=1:3:3"], ["iterations"])
    assert plan.size == 6
    assert plan.point(4) == {"load": "ramp", "peak": 2.0}
    assert plan.settings_at(4).changed(plan.settings) == {"load": "ramp", "peak": 2.0}


def test_a_plan_survives_as_json_and_another_has_another_digest() -> None:
    table = BAR.replace(load=((0.0, 0.0), (1.0, 900.0)))
    plan = plan_of(table, ["friction=0.1:0.6:3", "method=fast,paper"], ["dissipation@1", "modes"])
    again = plan_from_plain(json.loads(json.dumps(plan.plain())))
    assert again.digest == plan.digest
    assert again.axes == plan.axes
    assert again.settings_at(5).values() == plan.settings_at(5).values()
    digests = {
        plan_of(base, vary, of).digest
        for base in (BAR, BAR.replace(peak=1.0))
        for vary in (["friction=0.1,0.2"], ["friction=0.1,0.3"])
        for of in (["iterations"], ["modes"])
    }
    assert len(digests) == 8


@ANY
@given(st.lists(st.integers(1, 12), min_size=1, max_size=2))
def test_the_path_goes_through_every_point_once_from_neighbour_to_neighbour(
    shape: list[int],
) -> None:
    path = snake(shape)
    size = shape[0] * shape[-1] if len(shape) == 2 else shape[0]
    assert sorted(path) == list(range(size))
    for one, next_one in pairwise(path):
        places = [divmod(number, shape[-1]) for number in (one, next_one)]
        assert sum(abs(a - b) for a, b in zip(*places, strict=True)) == 1
