"""What the tab *What if* asks can be run, or is refused beside its field; rows become a chart."""

from __future__ import annotations

import math

import pytest
from sweeps import tiny

from app.shell.address import query_of, settings_from_query, sight_from_query
from app.whatif.charted import described, drawn, is_of, stands
from app.whatif.question import (
    READY,
    Question,
    Span,
    askable,
    bathtub,
    changed_quantity,
    changed_span,
    offered,
    question_from_query,
    usual_span,
)
from solver.scenes import CATALOGUE
from solver.scenes.bar import BarSettings
from solver.settings import Settings
from solver.study.sweep import Row

DEFAULTS = BarSettings.checked({})


def every_scene() -> list[Settings]:
    return [entry.settings.checked({}) for entry in CATALOGUE.values()]


@pytest.mark.parametrize("settings", every_scene(), ids=lambda one: one.scene)
def test_every_setting_that_is_offered_can_vary_as_it_is_proposed(settings: Settings) -> None:
    quantity = next(iter(askable(settings)))
    names = offered(settings)
    assert {"friction", "k_scale", "acceleration"} <= names.keys()
    for name, definition in names.items():
        question = Question((usual_span(definition, name),), quantity)
        assert question.refusals(settings) == {}, name


@pytest.mark.parametrize("settings", every_scene(), ids=lambda one: one.scene)
def test_every_quantity_that_is_offered_can_be_asked_and_every_ready_question(
    settings: Settings,
) -> None:
    spans = bathtub(settings).spans
    for name in askable(settings):
        assert Question(spans, changed_quantity(name, "")).refusals(settings) == {}, name
    made = [question for _, make in READY.values() if (question := make(settings))]
    assert len(made) == len(READY)
    for question in made:
        assert question.refusals(settings) == {}, question.vary


@pytest.mark.parametrize(
    ("span", "words"),
    [
        (Span("friction", "0.1", "7e9", "5"), "a number from 0 to"),
        (Span("friction", "low", "1", "5"), "is no number"),
        (Span("friction", "0", "1", "5", "log"), "ends above zero"),
        (Span("friction", "0", "1", "1"), "whole number from 2"),
        (Span("friction", "0", "inf", "5"), "finite"),
        (Span("elements", spacing="list", listed="20,many"), "write a number"),
        (Span("acceleration", spacing="list", listed=""), "at least one value"),
        (Span("viscosity", "0", "1", "5"), "There is no such setting"),
    ],
)
def test_a_foolish_range_is_refused_in_one_line_beside_its_field(span: Span, words: str) -> None:
    refusals = Question((usual_span(offered(DEFAULTS)["peak"], "peak"), span), "seconds").refusals(
        DEFAULTS
    )
    assert list(refusals) == ["1"]
    assert words in refusals["1"]
    assert "\n" not in refusals["1"]


@pytest.mark.parametrize(
    ("question", "place", "words"),
    [
        (Question((Span("peak", "1", "9"),), "dissipation@0"), "of", "whole number from 1"),
        (Question((Span("peak", "1", "9"),), "beauty"), "of", "Choose one of these"),
        (
            Question((Span("peak", "1", "9", "300"), Span("friction", "0", "1", "300")), "modes"),
            "all",
            "take fewer values",
        ),
        (Question((Span("peak", "1", "9"), Span("peak", "1", "9")), "modes"), "all", "once"),
        (Question((Span("pgd_modes", "1", "9", "9"),), "seconds"), "all", "do something here"),
    ],
)
def test_what_makes_no_plan_is_refused_too(question: Question, place: str, words: str) -> None:
    refusals = question.refusals(DEFAULTS)
    assert list(refusals) == [place]
    assert words in refusals[place]


def test_an_address_has_the_question_and_comes_back_to_it() -> None:
    question = Question(
        (
            Span("k_scale", "0.01", "100", "9", "log"),
            Span("acceleration", spacing="list", listed="none,anderson"),
        ),
        "iterations_to_force@0.1",
    )
    query = query_of(DEFAULTS, question=question) + "&tab=what if"
    assert question_from_query(query) == question
    assert settings_from_query(query)[1] == ""
    assert sight_from_query(query)[0].tab == "What if"
    assert question_from_query("?vary=friction=1:2:3") is None
    foolish = question_from_query("?vary=::::=::log&of=x")
    assert foolish is not None
    assert set(foolish.refusals(DEFAULTS)) == {"0", "of"}


def test_another_setting_brings_its_own_values_and_a_list_begins_with_the_range() -> None:
    span = changed_span(DEFAULTS, Span("friction", "0.1", "0.3", "3"), {"name": "k_scale"})
    assert (span.low, span.high, span.spacing) == ("0.01", "100", "log")
    listed = changed_span(DEFAULTS, Span("friction", "0.1", "0.3", "3"), {"spacing": "list"})
    assert listed.listed == "0.1,0.2,0.3"
    typed = changed_span(DEFAULTS, listed, {"listed": "0.1, 0.5"})
    assert typed.text == "friction=0.1,0.5"
    assert changed_span(DEFAULTS, typed, {"spacing": "even"}).text == "friction=0.1:0.3:3"


def test_rows_become_values_and_states_whatever_came_of_them() -> None:
    plan = tiny(["friction=0.1:0.5:5"], ["iterations_to_force@0.1"])
    rows = [
        Row(4, "converged", "", (3.0,)),
        Row(0, "exhausted", "Raise max_iterations.", (12.0,)),
        Row(1, "converged", "", (math.inf,)),
        Row(2, "refused", "no", (math.nan,)),
    ]
    found = drawn(plan, rows)
    assert found["values"] == [12.0, None, None, None, 3.0]
    said = [found["words"][state] for state in found["states"]]
    assert said == ["exhausted: Raise max_iterations.", "never", "refused: no", "waiting", ""]


def test_shares_are_drawn_in_per_cent() -> None:
    plan = tiny(["friction=0.1,0.2"], ["slipped_share"])
    assert drawn(plan, [Row(0, "converged", "", (0.25,))])["values"] == [25.0, None]
    assert described(plan)["quantity"]["unit"] == "%"


@pytest.mark.parametrize(
    ("vary", "across", "is_map", "steps"),
    [
        (["friction=0.1:0.5:5"], "friction", False, [1]),
        (["friction=0.1:0.5:5", "peak=100:900:9"], "friction", True, [9, 1]),
        (["friction=0.1:0.5:5", "peak=100,900"], "friction", False, [2, 1]),
        (["acceleration=none,anderson", "peak=100:900:9"], "peak", False, [1, 9]),
        (["multiscale=true,false"], "multiscale", False, [1]),
    ],
)
def test_two_numbers_make_a_map_and_names_or_few_values_make_curves(
    vary: list[str], across: str, is_map: bool, steps: list[int]
) -> None:
    plan = tiny(vary, ["seconds"])
    chart = described(plan)
    assert (chart["axes"][0]["name"], chart["map"]) == (across, is_map)
    assert [axis["step"] for axis in chart["axes"]] == steps
    for number in range(plan.size):
        point = plan.point(number)
        for axis in chart["axes"]:
            value = point[axis["name"]]
            value = ("off", "on")[value] if isinstance(value, bool) else value
            assert axis["values"][number // axis["step"] % len(axis["values"])] == value


def test_present_settings_stand_on_the_axes_and_others_are_told_from_them() -> None:
    plan = tiny(["acceleration=none,anderson", "peak=100:900:9"], ["seconds"])
    settings = plan.settings
    assert stands(plan, settings.replace(peak=450.0)) == [450.0, "anderson"]
    assert is_of(plan, settings.replace(peak=450.0))
    assert not is_of(plan, settings.replace(friction=0.1))
    other = CATALOGUE["strand"].settings.checked({})
    assert stands(plan, other) == []
    assert not is_of(plan, other)
