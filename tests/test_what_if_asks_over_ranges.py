"""What the tab *What if* asks can be run, or is refused beside its field."""

from __future__ import annotations

import math

import pytest
from sweeps import tiny

from app.shell.address import query_of, settings_from_query, sight_from_query
from app.whatif.charted import is_of, stands
from app.whatif.question import (
    Question,
    Span,
    askable,
    changed_quantity,
    changed_span,
    offered,
    question_from_query,
    usual_span,
)
from app.whatif.ready import READY, bathtub, fretting_map, shakedown
from solver.scenes import CATALOGUE
from solver.scenes.bar import BarSettings
from solver.settings import Settings
from solver.study.sweep import Row
from solver.study.sweep.chart import chart_of

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
    made = {title: question for title, (_, make) in READY.items() if (question := make(settings))}
    assert READY.keys() - made.keys() <= {"The fretting map", "The shakedown limit"}
    for question in made.values():
        assert question.refusals(settings) == {}, question.vary


def test_the_fretting_map_is_offered_where_a_load_goes_to_and_fro() -> None:
    loads = {"bar": "load", "block": "top_tangential_load", "layers": "bend_load"}
    for scene, load in loads.items():
        settings = CATALOGUE[scene].settings.checked({load: "cycles"})
        question = fretting_map(settings)
        assert question is not None
        assert question.of == "sliding_share"
        assert question.refusals(settings) == {}, question.vary
    assert fretting_map(DEFAULTS) is None


def test_the_shakedown_limit_is_offered_where_there_is_one_that_no_mesh_makes() -> None:
    held = {"gap": "flat", "top_tangential_load": "cycles"}
    cycles = {"load": "cycles", "friction_law": "compliant"}
    for scene, changes in (("block", held), ("layers", {"bend_load": "cycles"}), ("bar", cycles)):
        settings = CATALOGUE[scene].settings.checked(changes)
        question = shakedown(settings)
        assert question is not None
        assert question.refusals(settings) == {}, question.vary
    for scene, changes in (("bar", {"load": "cycles"}), ("block", {**held, "gap": "parabola"})):
        assert shakedown(CATALOGUE[scene].settings.checked(changes)) is None


@pytest.mark.parametrize(
    ("span", "words"),
    [
        (Span("friction", "0.1", "7e9", "5"), "any number from 0 on (to 1·10⁶)"),
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


def test_present_settings_stand_on_the_axes_and_others_are_told_from_them() -> None:
    plan = tiny(["acceleration=none,anderson", "peak=100:900:9"], ["seconds"])
    settings = plan.settings
    assert settings.acceleration == "anderson"
    chart = chart_of(plan, [Row(14, "converged", "", (3.0,))])
    assert plan.point(14) == {"acceleration": "anderson", "peak": 600.0}
    assert stands(plan, chart, settings.replace(peak=600.0)) == (600.0, 3.0)
    between = stands(plan, chart, settings.replace(peak=450.0))
    assert between is not None
    assert between[0] == 450.0
    assert math.isnan(between[1])
    assert stands(plan, chart, settings.replace(peak=50.0)) is None
    assert is_of(plan, settings.replace(peak=450.0))
    assert not is_of(plan, settings.replace(friction=0.1))
    other = CATALOGUE["strand"].settings.checked({})
    assert stands(plan, chart, other) is None
    assert not is_of(plan, other)
