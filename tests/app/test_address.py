"""An address says what is shown, and a part of it that is refused leaves the rest."""

from __future__ import annotations

import pickle
from itertools import product
from typing import Any

import numpy as np
import pytest

from app.browser import Browser
from app.lessons.catalogue import CASES, plots_of, settings_of
from app.link import (
    LESSONS,
    LONGEST,
    Link,
    link_of,
    query_of,
    read,
    show,
    shown_by,
)
from app.messages import Needs, Pace, Start
from app.state import PageState, default_settings
from app.worker.references import ReferenceCache
from app.worker.runner import Runner
from solver.files.tables import read_table
from solver.scenes import CATALOGUE
from solver.settings.definitions import CurveParameter
from solver.settings.scene import Settings
from solver.study.comparison import CAN, results_in

LOOKED_AT: dict[str, Any] = {
    "tab": "What if",
    "question": "friction=0.2:0.4:3 peak=600:900:2 dissipation",
    "instant": 0.25,
    "interface": "contact 2-3",
    "iteration": 12,
    "pace": "5 a second",
    "plots": ["Convergence", "Singular values"],
    "view": "present",
}


@pytest.mark.parametrize("scene", CATALOGUE)
def test_an_address_says_every_setting_that_is_not_the_default(scene: str) -> None:
    settings = default_settings(scene)
    for name, definition in settings.definitions().items():
        if isinstance(definition, CurveParameter):
            settings = settings.replace(**{name: settings.points(name)})
    settings = settings.with_change("friction", 0.45).with_change("method", "paper")
    place, refusal = read(query_of({"settings": settings}))
    assert not refusal
    assert place["settings"].values() == settings.values()


def test_an_address_says_what_is_looked_at() -> None:
    place, refusal = read(query_of({"settings": default_settings("bar"), **LOOKED_AT}))
    assert not refusal
    assert {name: place[name] for name in LOOKED_AT} == LOOKED_AT


def test_what_begins_a_scene_needs_no_words() -> None:
    for scene in CATALOGUE:
        assert query_of({"settings": default_settings(scene)}) == f"?scene={scene}"


@pytest.mark.parametrize("name", sorted(LESSONS))
def test_a_lesson_is_its_name_and_what_was_changed(name: str) -> None:
    place, refusal = read(f"?lesson={name}&k_scale=3")
    assert not refusal
    assert place["settings"].k_scale == 3.0
    assert read(query_of(place))[0]["settings"].values() == place["settings"].values()
    assert query_of(place) == f"?lesson={name}&k_scale=3.0"


@pytest.mark.parametrize("name", CASES)
def test_a_case_is_its_name_and_what_was_changed(name: str) -> None:
    place, refusal = read(f"?case={name}&friction=0.25")
    assert not refusal
    assert place["plots"] == plots_of(name)
    assert query_of(place) == f"?case={name}&friction=0.25"
    assert read(query_of(place))[0]["settings"].values() == place["settings"].values()
    assert read(f"?case={name}&plots=Convergence")[0]["plots"] == ["Convergence"]


def test_the_way_back_from_a_case_shows_nothing_in_between() -> None:
    state = PageState(settings_of(CASES["crate"]), case="crate")
    seen: list[str] = []
    watched = ["settings", "case", "plots"]
    state.param.watch(lambda *events: seen.append(query_of(shown_by(state))), watched)
    show(state, read("?scene=bar&peak=800.0")[0])
    assert seen == ["?scene=bar&peak=800.0"]


@pytest.mark.parametrize(
    ("query", "told"),
    [
        ("friction=-1", "Friction coefficient μ cannot be −1"),
        ("frction=0.5", "did you mean friction ("),
        ("substructures=60", "raise Elements"),
        ("scene=moon", "there is no scene moon"),
        ("lesson=moon", "there is no lesson moon: choose one under Lessons"),
        ("case=moon", "there is no case moon: choose one under Cases"),
        ("case=bolted-lap-joint", "did you mean lap-joint?"),
        ("tab=Moon", "Live, What if"),
        ("instant=2", "from 0 to 1"),
        ("plots=Convergence,Moon", "there is no plot Moon"),
        ("tab=What if&question=moon", "the question moon cannot be asked here"),
        ("pace=", "5 a second"),
        ("file=load", "open its file"),
        ("=3", "3 has no name: write a name before it"),
        ("k_scale=2&k_scale=3", "k_scale has 2 values: the last one is taken"),
        ("scene=b%00r", "there is no scene b%00r"),
        ("friction=%E2%80%AE5", "cannot be “%E2%80%AE5”"),
        ("moon%0Asun=3", "moon%0Asun: there is no such setting"),
    ],
)
def test_a_part_that_is_refused_is_told_and_the_rest_holds(
    query: str, told: str
) -> None:
    place, refusal = read(f"?peak=1100&{query}&view=present")
    assert told in refusal
    assert refusal.startswith("From the address: ")
    assert refusal[-1] in ".?"
    assert refusal[-2] not in ".?"
    assert (place["settings"].peak, place["view"]) == (1100.0, "present")


@pytest.mark.parametrize(
    "query", ["&&", "=", "=%20", "scene=bar&scene=bar", "utm_source=mail&fbclid=Iw"]
)
def test_what_says_nothing_to_the_page_is_passed_over(query: str) -> None:
    place, refusal = read(f"?{query}&peak=1100")
    assert (place["settings"].peak, refusal) == (1100.0, "")


@pytest.mark.parametrize(
    "part",
    ["", "k_scale=", "scene=", "case=", "tab=", "scene=mesh&sides=", "file=", "load=["],
)
def test_a_refusal_of_a_long_text_is_short(part: str) -> None:
    _, refusal = read(f"?{part}{15_000 * 'x'}")
    assert 0 < len(refusal) < 400


def test_of_thousands_of_unknown_names_few_are_looked_for_and_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """An address of 16 000 characters kept the server, and all pages, for 47 s."""
    replaced = []
    replace = Settings.replace

    def counted(settings: Settings, **values: Any) -> Settings:
        replaced.append(values)
        return replace(settings, **values)

    monkeypatch.setattr(Settings, "replace", counted)
    names = "&".join([f"a{number}=1" for number in range(1000)])
    place, refusal = read(f"?{names}&peak=1100")
    assert place["settings"].peak == 1100.0
    assert refusal.endswith("; and 990 more.")
    assert len(refusal) < 4000
    # Once for each name that is looked for, and once for the rest.
    assert len(replaced) == 11


def test_a_question_that_another_scene_has_waits_for_it_in_silence() -> None:
    question = "peak=600:900:2 dissipation"
    place, refusal = read(f"?scene=wall&question={question}")
    assert (place["question"], refusal) == (question, "")


def test_settings_whose_path_was_refused_go_to_the_worker_all_the_same() -> None:
    place, refusal = read("?load=[[0,0],[0,1]]&peak=800")
    assert refusal
    assert pickle.loads(pickle.dumps(place["settings"])).peak == 800.0


def test_settings_that_hold_together_may_stand_in_any_order() -> None:
    place, refusal = read("?substructures=80&elements=100")
    assert not refusal
    assert place["settings"].substructures == 80


def test_a_value_of_the_page_that_does_not_go_with_the_address_is_told() -> None:
    present = default_settings("bar").replace(elements=200, substructures=100)
    place, refusal = read("?peak=1100&file=substructures", present)
    assert "raise Elements" in refusal
    assert place["settings"].peak == 1100.0
    place, refusal = read("?elements=200&file=substructures", present)
    assert not refusal
    assert place["settings"].substructures == 100


def test_what_is_too_long_is_left_out_and_said_and_stays_while_the_page_does() -> None:
    path = tuple(
        (t, 900.0 * t * (1.0 - t)) for t in np.linspace(0.0, 1.0, 200).tolist()
    )
    state = PageState(default_settings("bar").replace(load=path))
    link, message = link_of(state)
    assert len(link) < LONGEST
    assert message.endswith("Path of the force at the right end.")
    assert read(link)[0]["settings"].load == "sine"
    assert read(link, state.settings)[0]["settings"].load == path


def test_going_back_brings_settings_back_and_leaves_no_new_address() -> None:
    state = PageState(default_settings("bar"))
    link = Link(state, Browser())
    before = query_of(shown_by(state))
    state.change(peak=1200.0)
    state.choose_scene("rope")
    link.go("?scene=bar&peak=1200.0")
    assert (state.settings.scene, state.settings.peak) == ("bar", 1200.0)
    link.go(before)
    assert state.settings.values() == default_settings("bar").values()


def test_going_back_to_a_class_opens_its_page() -> None:
    state = PageState(default_settings("rope"))
    browser = Browser()
    link = Link(state, browser)
    link.go("?class=ABCD")
    assert browser.destination == "?class=ABCD"
    assert (state.settings.scene, state.room) == ("rope", "")


def test_a_slider_that_is_dragged_writes_no_address_until_it_is_let_go() -> None:
    state = PageState(default_settings("bar"))
    link = Link(state, Browser())
    before = link.query
    state.drag("peak", 700.0)
    assert link.query == before
    state.change(peak=700.0)
    assert link.query == "?scene=bar&peak=700.0"


def test_an_address_with_an_iteration_runs_up_to_it() -> None:
    state = PageState(default_settings("bar"))
    orders: list[Any] = []
    state.send = orders.append
    show(state, read("?instant=0.5")[0])
    assert state.selection.phase == 0.5
    state.reset(7)
    start = orders[-1]
    assert isinstance(start, Start)
    runner = Runner(start, ReferenceCache(), lambda: False)
    while runner.rest() is not None:
        runner.advance()
    assert runner.status is None
    assert runner.frame(Needs()).iteration == 7
    assert not any(isinstance(order, Pace) for order in orders)


def test_results_of_another_program_come_with_the_frame_and_their_distance() -> None:
    settings = default_settings("bar").replace(start="nested", finish="at-once")
    runner = Runner(Start(1, settings, float("inf")), ReferenceCache(), lambda: False)
    while runner.status is None:
        runner.advance()
    assert runner.iterate is not None
    law = next(iter(runner.sampler.problem.contacts.values()))
    problem = runner.sampler.problem
    force = runner.iterate.contact(next(iter(problem.contacts))).tangential_force
    density = force / law.by_point(law.weights)[:, None]
    points = product(law.positions.tolist(), problem.instants.tolist())
    rows = [
        f"{x!r},{t!r},{1.1 * value!r}"
        for (x, t), value in zip(points, density.ravel(), strict=True)
    ]
    table = (
        "\n".join(["x,t,friction force", *rows])
        .replace("np.float64(", "")
        .replace(")", "")
    )
    brought = results_in(read_table(table, "other.csv", "the results", CAN), settings)
    frame = runner.frame(Needs(frozenset({"beside"}), brought=brought))
    beside = frame.extras["beside"]
    assert beside["distance"] == pytest.approx(0.1 / 1.1, rel=1e-6)
    assert len(beside["brought"].values) == len(rows)
    assert runner.frame(Needs(frozenset({"beside"}))).extras["beside"] is None
