"""A lesson asks before it tells, starts its run, and has its values of what is shown."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from typing import Any

import panel as pn
import pytest
from lone_link import LoneLink
from shown_pages import ALL, Shown

from app.lessons.lesson import LESSONS, NO_CHOICE, content, parts, readings
from app.picture.units import measured
from app.session.pages import Pages
from app.session.report_executor import ReportExecutor
from app.session.session import Session
from app.shell.address import Sight, query_of, settings_from_query, sight_from_query
from app.shell.dashboard import Dashboard
from app.teaching.teaching import CHOICE
from app.wire.orders import Run, Seek
from solver.lessons.lesson import Lesson
from solver.study.quantities.finished import finished_run
from solver.study.quantities.quantities import reading

SMALL: dict[str, Any] = {"elements": 20, "instants": 21, "method": "paper", "max_iterations": 12}
each = pytest.mark.parametrize("lesson", LESSONS.values(), ids=list(LESSONS))


@pytest.fixture
def link() -> LoneLink:
    return LoneLink()


@pytest.fixture
def session(link: LoneLink) -> Iterator[Session]:
    pn.extension(notifications=True)
    settings = LESSONS["coarse-problem"].settings
    with closing(Session(Pages(9), ReportExecutor(), settings, link.hire)) as made:
        yield made


@pytest.fixture
def page(session: Session) -> Dashboard:
    made = Dashboard(session, sight=Sight(lesson="coarse-problem"))
    made.loaded()
    return made


def tell(page: Dashboard, name: str, value: Any) -> None:
    """Have the lesson's own component say something."""
    page._teaching._hear(name, value, False, 1.0)


def drawn(page: Dashboard) -> set[str]:
    """Give the views that are drawn."""
    return set(page.session.look.views)


@each
def test_before_the_choice_neither_answer_nor_control_is_on_the_page(lesson: Lesson) -> None:
    asked, told = content(lesson, None), content(lesson, NO_CHOICE)
    assert set(told) - set(asked) == {"choice", "right", "why", "explanation", "items", "next"}
    assert not asked.get("curve", {}).get("values")
    assert not [part for paragraph in asked["text"] for part in paragraph if part[0] == "control"]
    assert [item["name"] for item in told["items"]] == list(lesson.controls)
    assert set(readings(lesson, None)) <= set(readings(lesson, NO_CHOICE))


def test_lessons_lead_from_one_to_the_next_as_far_as_the_last() -> None:
    following = [content(one, 0)["next"] for one in LESSONS.values()]
    assert [one[0] for one in following[:-1]] == list(LESSONS)[1:]
    assert following[-1] == []


def test_a_sentence_falls_into_what_a_browser_shows() -> None:
    found = parts("*So* F^2 is {value:error_force@3}{control:peak}")
    title = "Error of the contact force at iteration 3"
    assert found == [
        ["em", "So"],
        ["text", " F"],
        ["sup", "2"],
        ["text", " is "],
        ["value", "error_force@3.0", title],
        ["control", "peak"],
    ]


@each
def test_a_lesson_is_opened_by_its_address_alone(lesson: Lesson) -> None:
    settings, complaint = settings_from_query(f"?lesson={lesson.name}")
    assert (settings.values(), complaint) == (lesson.settings.values(), "")
    sight, complaint = sight_from_query(f"?lesson={lesson.name}")
    assert (sight, complaint) == (Sight(lesson=lesson.name, instant=lesson.instant), "")
    assert query_of(settings, sight) == f"?lesson={lesson.name}"


@pytest.mark.parametrize("changes", [{"method": "fast"}, {"substructures": 5}, {"start": "nested"}])
def test_an_address_comes_back_to_what_was_changed_in_a_lesson(changes: dict[str, Any]) -> None:
    sight = Sight("Study", 0.5, "5", "more-substructures")
    settings = LESSONS["more-substructures"].settings.replace(**changes)
    query = query_of(settings, sight)
    assert settings_from_query(query)[0].values() == settings.values()
    assert sight_from_query(query) == (sight, "")


def test_a_lesson_that_there_is_not_and_another_scene_in_it_are_refused_in_words() -> None:
    assert settings_from_query("?lesson=luck&seed=3")[0].values()["seed"] == 3
    sight, complaint = sight_from_query("?lesson=luck")
    assert sight == Sight()
    assert all(part in complaint for part in ('lesson = "luck"', "best-k", "broken-wire"))
    settings, complaint = settings_from_query("?lesson=broken-wire&scene=bar")
    assert settings.scene == "strand"
    assert 'scene = "bar" is refused; allowed: strand' in complaint


def test_nothing_is_drawn_and_only_the_text_is_measured_until_a_choice_is_made(
    page: Dashboard,
) -> None:
    lesson = LESSONS["coarse-problem"]
    assert "asks" in page._live.css_classes
    assert not page.page.sidebar_open
    assert drawn(page) == set()
    assert page.session.look.readings == ("error_displacement@10.0", "error_force@10.0")
    tell(page, CHOICE, 1)
    assert "asks" not in page._live.css_classes
    assert drawn(page) == set(lesson.views)
    assert "iterations_to_force@0.01" in page.session.look.readings
    assert page._teaching.view.lesson["choice"] == 1
    tell(page, CHOICE, 0)
    assert page._teaching.view.lesson["choice"] == 1


def test_a_control_in_a_sentence_moves_the_run_and_shows_what_holds(page: Dashboard) -> None:
    tell(page, CHOICE, NO_CHOICE)
    assert {"", "multiscale"} <= set(page._teaching.view.shown)
    tell(page, "multiscale", False)
    assert page.session.wanted.values()["multiscale"] is False
    assert page._teaching.view.shown["multiscale"] is False
    assert "lesson=coarse-problem" in page.pulse.query


def test_the_next_lesson_starts_its_own_run_which_is_compared_with_none_before(
    page: Dashboard, link: LoneLink
) -> None:
    tell(page, "the-lesson", "small-indicator")
    lesson = LESSONS["small-indicator"]
    order = next(one for one in reversed(link.orders) if isinstance(one, Run))
    assert order.settings is lesson.settings
    assert (order.is_alone, order.label) == (True, "")
    assert page._sidebar.view.shown["the-lesson"] == "small-indicator"
    assert page.session.asks


def test_the_plots_of_a_lesson_stand_where_it_says(page: Dashboard) -> None:
    for name in ("broken-wire", "leaf-spring"):
        tell(page, "the-lesson", name)
        lesson, look = LESSONS[name], page.session.look
        assert (look.phase, look.interface) == (lesson.instant, lesson.interface)


def test_a_lesson_has_none_but_its_own_settings_dragged(page: Dashboard) -> None:
    tell(page, CHOICE, NO_CHOICE)
    assert page._gallery.sliders == {}
    tell(page, "the-lesson", "how-fast-how-big")
    tell(page, CHOICE, NO_CHOICE)
    assert set(page._gallery.sliders) == {"peak"}
    tell(page, "the-lesson", "")
    assert set(page._gallery.sliders) > {"peak", "pressure"}


def test_who_leaves_a_lesson_keeps_the_run_and_has_all_views_and_controls(page: Dashboard) -> None:
    begun, settings = page.session.ticket, page.session.wanted
    tell(page, "the-lesson", "")
    assert (page.session.ticket, page.session.wanted) == (begun, settings)
    assert page.page.sidebar_open
    assert page._live.css_classes == ["live"]
    assert drawn(page) > set(LESSONS["coarse-problem"].views)
    assert (page._teaching.view.lesson, page.session.look.readings) == ({}, ())


def test_another_scene_ends_a_lesson(page: Dashboard) -> None:
    page._sidebar.hear("the-scene", "strand", False, 1.0)
    assert page.session.lesson is None
    assert page._sidebar.view.shown["the-lesson"] == ""
    assert page.session.wanted.scene == "strand"


def told(names: list[str], **options: Any) -> Shown:
    """Do a run of which these quantities are told."""
    shown = Shown(replace(ALL, views=(), readings=tuple(names)))
    shown.run(1, "bar", SMALL, **options)
    return shown


def test_values_are_those_of_the_run_and_what_it_has_not_reached_says_so() -> None:
    names = ["error_force", "error_force@5", "iterations", "first_slip_time", "modes"]
    shown = told([*names, "iterations_to_force@1e-9", "seconds_to_force@1e-9", "indicator@99"])
    found = dict(shown.page["lesson"]["values"])
    run = finished_run(shown.recording.settings)
    assert found["error_force"] == f"{100 * reading('error_force')(run):.2g} %"
    assert found["error_force@5"] == f"{100 * reading('error_force@5')(run):.2g} %"
    assert found["error_force"] in shown.words
    assert found["iterations"] == "12"
    assert found["first_slip_time"] == measured(reading("first_slip_time")(run), "s")
    assert (found["modes"], found["indicator@99"]) == ("–", "–")
    assert found["iterations_to_force@1e-9"] == "more than 12"
    assert found["seconds_to_force@1e-9"] == "not reached"


def test_what_is_open_is_not_told_before_the_end_nor_of_an_iterate_that_one_goes_back_to() -> None:
    shown = told(["error_force", "error_force@5", "iterations_to_force@1e-9"], pause_after=3)
    (_, now), *others = shown.page["lesson"]["values"]
    assert now in shown.words
    assert [text for _, text in others] == ["…", "…"]
    shown = told(["iterations", "error_force@5"])
    shown.obey(Seek(1, 4))
    assert shown.page["lesson"]["values"] == [["iterations", "4"], ["error_force@5", "…"]]


def test_nothing_is_told_of_the_first_iterate_before_there_is_a_record_of_it() -> None:
    shown = told(["error_force", "seconds", "iterations"])
    assert shown.pictures[0].facts.iteration == 1
    assert {text for _, text in shown.models[0]["lesson"]["values"]} == {"…"}


def test_a_run_that_is_alone_has_nothing_before_it() -> None:
    shown = told([])
    shown.run(2, "bar", {**SMALL, "peak": 700})
    assert shown.scene().before is not None
    shown.run(3, "bar", SMALL, is_alone=True)
    assert shown.scene().before is None
    assert shown.scene().past == ()


def test_the_name_of_the_lessons_component_is_that_which_pictures_set(page: Dashboard) -> None:
    assert page._teaching.view.get_root().data.name == "lesson"
