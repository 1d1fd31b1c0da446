"""A case shows what is known beside its run, and is the start of one's own."""

from __future__ import annotations

from dataclasses import replace
from itertools import chain
from types import SimpleNamespace
from typing import Any

import panel as pn
import pytest

from app.frame import Frame
from app.lessons.catalogue import CASES, LESSONS, PENDING, readings_of, settings_of
from app.lessons.guide import Guide
from app.live import Card
from app.messages import Needs
from app.state import PageState, default_settings
from app.views.catalogue import CARDS
from app.worker.sampling import Sampler
from solver.scenes import discretise
from solver.study.quantities.finished import finished_run
from solver.study.trade_case import Case

each = pytest.mark.parametrize("case", CASES.values(), ids=list(CASES))
NAME = "lap-joint"


def panel_of(state: PageState) -> Guide:
    player: Any = SimpleNamespace(play=lambda until: None, stop=lambda: None)
    panel = Guide(state, player, lambda: None, lambda: None)
    panel.show()
    return panel


def words_of(panel: Guide) -> str:
    return " ".join(pane.object for pane in panel.view.select(pn.pane.Markdown))


@pytest.fixture(scope="module")
def frame() -> Frame:
    """The answer of a case, with the quantity that it asks for."""
    case = CASES[NAME]
    run = finished_run(case.settings, errors=False)
    sampler = Sampler(discretise(case.settings), case.settings, 1)
    needs = Needs(readings=(case.quantity.name,))
    return sampler.frame(run.iterate, run.solution.records, run.solution.status, needs)


@each
def test_every_plot_that_a_case_brings_to_the_front_says_something_of_its_run(
    case: Case,
) -> None:
    kinds = chain.from_iterable(CARDS)
    shown = {kind.name for kind in kinds if kind.applies(case.settings)}
    assert set(case.views) <= shown


@each
def test_a_case_brings_its_run_its_words_and_the_settings_to_change(case: Case) -> None:
    state = PageState(default_settings("incline"))
    panel = panel_of(state)
    panel.open("case", case.name)
    assert state.settings.values() == settings_of(case).values()
    assert state.readings == [case.quantity.name]
    assert panel.view.visible
    words = words_of(panel)
    assert case.source in words
    assert PENDING in words
    assert tuple(control.name for control in panel._controls) == case.controls


def test_the_runs_own_number_stands_beside_the_known_one(frame: Frame) -> None:
    state = PageState(settings_of(CASES[NAME]), case=NAME)
    panel = panel_of(state)
    state.frame = frame
    assert "known **56.44 mJ**, this run **56.44 mJ** (0.0 % off)" in words_of(panel)
    state.settings = state.settings.replace(elements=50, k_scale=3.0)
    panel.update()
    assert " % off" in words_of(panel)
    state.settings = state.settings.replace(friction=0.3)
    state.frame = replace(frame, readings={})
    assert "known before the change **56.44 mJ**, this run **…**" in words_of(panel)


def test_a_page_is_in_a_lesson_or_in_a_case() -> None:
    state = PageState(default_settings("bar"))
    panel = panel_of(state)
    for _ in range(2):
        panel.open("lesson", "leaf-spring")
        assert (state.case, state.plots) == ("", [])
        assert state.readings == readings_of(LESSONS["leaf-spring"])
        panel.open("case", NAME)
        assert state.lesson == ""
        assert state.readings == [CASES[NAME].quantity.name]


def test_another_scene_ends_the_case() -> None:
    state = PageState(settings_of(CASES[NAME]), case=NAME)
    panel = panel_of(state)
    state.choose_scene("rope")
    assert (state.case, panel.view.visible, state.readings) == ("", False, [])


def test_a_plot_that_only_the_next_run_has_comes_to_the_front() -> None:
    state = PageState(default_settings("bar"))
    card = Card(CARDS[1], state)
    card.fit()
    cycled = state.settings.replace(load="cycles")
    state.param.update(settings=cycled, plots=["Energy a cycle"])
    card.fit()
    assert card.seen is not None
    assert card.seen.name == "Energy a cycle"
