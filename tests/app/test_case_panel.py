"""A case shows what is known beside its run, and is the start of one's own."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import chain
from types import SimpleNamespace
from typing import Any

import numpy as np
import panel as pn
import pytest

from app.frame import Frame, Selection
from app.lessons.cases import formula_of
from app.lessons.catalogue import (
    CASES,
    KINDS,
    LESSONS,
    PENDING,
    plots_of,
    readings_of,
    settings_of,
)
from app.lessons.guide import Guide
from app.link import query_of, read
from app.live import Card, on_top
from app.messages import Needs, Start
from app.state import PageState, default_settings
from app.views.catalogue import CARDS, LARGE_CARDS
from app.views.scene import Scene
from app.views.view import View
from app.worker.references import ReferenceCache
from app.worker.runner import Runner
from app.worker.sampling import Sampler
from solver.scenes import discretise
from solver.study.scene_run import finished_run
from solver.study.trade_case import Case

each = pytest.mark.parametrize("case", CASES.values(), ids=list(CASES))
NAME = "lap-joint"


def panel_of(state: PageState) -> Guide:
    player: Any = SimpleNamespace(play=lambda until, **_: None, stop=lambda: None)
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
    assert panel.is_open
    words = words_of(panel)
    assert case.source in words
    assert PENDING in words
    assert tuple(control.name for control in panel._controls) == case.controls
    assert state.selection.phase == case.instant
    (formula,) = panel.view.select(pn.pane.LaTeX)
    assert formula.object == formula_of(case).object


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
    assert (state.case, panel.is_open, state.readings) == ("", False, [])


def test_a_plot_that_only_the_next_run_has_comes_to_the_front() -> None:
    state = PageState(default_settings("bar"))
    card = Card([kind(state) for kind in CARDS[1]], state)
    card.fit()
    cycled = state.settings.replace(load="cycles")
    state.param.update(settings=cycled, plots=["Energy a cycle"])
    card.fit()
    assert card.seen is not None
    assert card.seen.name == "Energy a cycle"


def sampled(case: Case) -> Frame:
    """An early iterate of a case."""
    start = Start(1, settings_of(case), 0.0)
    runner = Runner(start, ReferenceCache(), lambda: False)
    runner.advance()
    return runner.frame(Needs(extras=frozenset({"axial force", "cycles"})))


@each
def test_a_case_opens_with_the_plot_of_its_flag_in_front(case: Case) -> None:
    state = PageState(settings_of(case), case=case.name)
    if case.flag is not None:
        assert plots_of(case.name)[0] == case.flag.plot
        (group,) = (group for group in LARGE_CARDS if KINDS[case.flag.plot] in group)
        offered = [kind for kind in group if kind.applies(state.settings)]
        state.plots = plots_of(case.name)
        assert offered[on_top(offered, state)].name == case.flag.plot


def named_in(view: View) -> list[str]:
    """Entries of the legend of a view that are seen."""
    (legend,) = view.figure.legend
    return [item.label.value for item in legend.items if item.visible]


@pytest.mark.parametrize(
    "name", ["pile", "lap-joint", "pull-out", "fault", "church-arch"]
)
def test_the_known_number_is_a_flag_on_its_plot_until_the_case_is_changed(
    name: str,
) -> None:
    case = CASES[name]
    frame = sampled(case)
    state = PageState(frame.run.settings, frame=frame, case=name)
    assert case.flag is not None
    view = KINDS[case.flag.plot](state)
    _ = view.figure
    selection = Selection(case.instant)
    view.update(frame, selection, None)
    heights = [*view.sources["flag"].data["y"], *view.sources["level"].data["y"]]
    assert [view.y.si(y) for y in heights] == pytest.approx([case.flag.y], rel=1e-5)
    assert case.flag.text in named_in(view)
    changed = frame.run.settings.replace(friction=0.01)
    run = replace(frame.run, settings=changed)
    view.update(replace(frame, run=run), selection, None)
    assert not view.sources["flag"].data["y"]
    assert not view.sources["level"].data["y"]
    assert case.flag.text not in named_in(view)


@each
def test_the_address_of_a_case_opens_at_the_instant_of_its_number(case: Case) -> None:
    shown, _ = read(f"?case={case.name}")
    assert shown["instant"] == case.instant
    assert query_of(shown) == f"?case={case.name}"
    assert case.flag is None or case.flag.plot in KINDS


def pile() -> Scene:
    """The picture of the pile, higher than wide."""
    frame = sampled(CASES["pile"])
    view = Scene(PageState(frame.run.settings, frame=frame, case="pile"))
    view.figure.trigger("inner_width", 950.0, 260.0)
    view.figure.trigger("inner_height", 190.0, 420.0)
    view.update(frame, Selection(1.0), None)
    return view


def test_a_pile_stands_upright_in_its_soil() -> None:
    view = pile()
    frame = view.state.frame
    picture = view.picture
    assert picture is not None
    x, y = picture.page(picture.nodes).T
    assert np.ptp(y) > 2.5 * np.ptp(x)
    # Positions along the bar grow downwards.
    assert y[frame.run.geometry.nodes[:, 0].argmax()] == pytest.approx(y.min())
    assert "soil" in named_in(view)
    for data in (view.sources["ground"].data, view.sources["strokes"].data):
        across = np.concatenate([np.ravel(line) for line in data["xs"]])
        assert np.nanmin(across) > 0.0
        assert np.nanmax(across) < 260.0


def test_the_force_of_a_pile_is_dragged_where_it_stands_upright() -> None:
    view = pile()
    picture = view.picture
    assert picture is not None
    pressure = view.state.settings.pressure
    arrows = next(each for each in picture.draggable if each.setting == "pressure")
    start = picture.page(arrows.handle)
    half = picture.page(0.5 * (arrows.base[0] + arrows.handles[0]))
    view._hold(SimpleNamespace(x=start[0], y=start[1]))
    view._drag(SimpleNamespace(x=half[0], y=half[1]))
    assert view.state.settings.pressure == pytest.approx(0.5 * pressure, rel=1e-2)


@each
def test_the_sentence_of_a_case_is_its_own_and_says_what_is_changed(case: Case) -> None:
    own = case.settings.sentence()
    assert case.sentence_on(own) == case.sentence
    assert "table" not in case.sentence


def test_a_changed_case_says_what_it_has_now() -> None:
    case = CASES["rail"]
    changed = case.settings.replace(temperature_load="triangle")
    assert "table" not in case.sentence_on(changed.sentence())
    held = case.settings.replace(left_end="held")
    sentence = case.sentence_on(held.sentence())
    assert sentence.endswith("Now: free at its right end and held at its left end.")


@each
def test_the_formula_of_a_case_is_typeset_and_says_what_is_written(case: Case) -> None:
    pane = formula_of(case)
    assert pane.renderer == "katex"
    typeset = pane.object.replace(r"\displaystyle", "").strip("$ ")
    assert typeset.count("{") == typeset.count("}")
    # Browsers draw MathML, and no sign of a root without a font for mathematics.
    assert r"\sqrt" not in typeset
    # Each number and each Latin letter of the formula stands in both.
    written = re.sub(
        r"\b(sqrt|min|cos|cosh|sin|tanh|ln|the|largest|over)\b", "", case.formula
    )
    for sign in set(re.findall(r"[A-Za-z]|[\d.]+", written)):
        assert sign in typeset


def test_a_case_without_a_typeset_formula_has_it_as_it_is_written() -> None:
    case = replace(CASES[NAME], typeset="")
    assert formula_of(case).object == case.formula
