"""A run that follows a slider starts from the last answer, and ends as any other."""

from __future__ import annotations

import math
import re
import sys
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_scenes import SMALL

from app.frame import Frame
from app.messages import Needs, NewFrame, Start
from app.state import SEARCH, PageState, answer, default_settings
from app.status import status_line
from app.views.errors import Convergence
from app.worker.references import LastAnswer, ReferenceCache
from app.worker.runner import Runner
from solver.latin import Answer
from solver.reference.incremental import reference_of
from solver.reference.rules import States
from solver.scenes import CATALOGUE
from solver.settings.scene import Settings

MOVED = {
    "bar": ("friction", "peak", "pressure"),
    "block": ("friction", "top_normal_displacement", "radius"),
    "layers": ("friction", "pressure", "deflection"),
    "rope": ("friction", "curvature", "tension"),
    "strand": ("friction", "peak", "pressure"),
    "wall": ("friction", "displacement", "pressure"),
}
"""Settings that sliders move, by scene."""
EQUAL = 1e-9
"""Largest difference of two answers, over the largest value."""


def of(scene: str, **changes: Any) -> Settings:
    return answer(CATALOGUE[scene].checked(SMALL[scene] | SEARCH | changes))


def dragged(settings: Settings, before: States | None = None) -> Runner:
    runner = Runner(
        Start(1, settings, math.inf, is_dragged=True),
        ReferenceCache(),
        lambda: False,
        before=before,
    )
    while runner.status is None:
        runner.advance()
    return runner


@cache
def begun(scene: str) -> Runner:
    """The run of a small scene, from nothing."""
    return dragged(of(scene))


def states_after(runner: Runner, settings: Settings) -> States | None:
    assert runner.answer is not None
    order = Start(2, settings, math.inf, is_dragged=True)
    return runner.answer.start_of(order, Needs())


def assert_same(one: Runner, other: Runner) -> None:
    mine = one.iterate
    its = other.iterate
    assert isinstance(mine, Answer)
    assert isinstance(its, Answer)
    for name in ("contact_force", "displacement"):
        size = np.abs(getattr(its, name)).max()
        apart = np.abs(getattr(mine, name) - getattr(its, name)).max()
        assert apart <= EQUAL * size, name
    assert np.array_equal(mine.status, its.status)


factors = st.floats(0.7, 1.4)


@pytest.mark.parametrize("scene", list(MOVED))
@given(data=st.data())
@settings(max_examples=4)
def test_wherever_a_slider_goes_the_answer_is_that_of_a_run_from_nothing(
    scene: str, data: st.DataObject
) -> None:
    begin = of(scene)
    name = data.draw(st.sampled_from(MOVED[scene]))
    value = begin.values()[name]
    moved = begin.with_change(name, value * data.draw(factors))
    before = states_after(begun(scene), moved)
    assert before is not None
    assert_same(dragged(moved, before), dragged(moved))


@pytest.mark.parametrize("scene", list(MOVED))
def test_a_small_move_is_answered_without_an_iteration(scene: str) -> None:
    begin = of(scene)
    moved = begin.with_change("friction", 1.02 * begin.values()["friction"])
    runner = dragged(moved, states_after(begun(scene), moved))
    assert len(runner.history) == 1
    assert runner.history[0].iteration == 1
    assert runner.status is not None
    assert "without an iteration" in runner.status.advice
    state = PageState(moved)
    state.newest = state.frame = runner.frame(Needs())
    words = re.sub("<[^>]*>", "", status_line(state))
    assert "answer: 0 iterations · certified" in words


def test_what_is_said_of_an_answer_that_follows_comes_with_its_reference() -> None:
    """Its picture waits for none of it, and remarks of before stay until then."""
    soft = of("bar", young=1e9)
    moved = soft.with_change("friction", 1.02 * soft.friction)
    runner = dragged(moved, states_after(dragged(soft), moved))
    first = runner.frame(Needs())
    assert first.is_followed
    assert not first.remarks
    assert math.isnan(first.last("indicator"))
    while runner.rest() is not None:
        runner.advance()
    second = runner.frame(Needs())
    assert "this model does not hold" in second.remarks[0]
    for name in ("indicator", "behaviour", "estimated_error", "error_force"):
        assert second.last(name) < EQUAL, name

    state = PageState(soft)
    view = Convergence(state)

    def show(frame: Frame) -> list[float]:
        state.drag("friction", moved.friction)
        run = replace(frame.run, number=state.number)
        state.take(NewFrame(replace(frame, run=run)))
        view.figure  # noqa: B018  # it is made when it is first asked for
        view.update(state.frame, state.selection, state.ghost)
        return list(view.sources["indicator"].data["y"])

    assert show(first) == []
    assert not state.frame.remarks
    assert len(show(second)) == 1
    assert show(first) == []
    assert state.frame.remarks == second.remarks


@pytest.mark.parametrize("scene", list(MOVED))
def test_states_that_are_wrong_everywhere_do_no_harm(scene: str) -> None:
    cold = begun(scene)
    assert cold.answer is not None
    wrong = np.where(cold.answer.states == 0, 1, 0).astype(np.int8)
    assert_same(dragged(of(scene), wrong), cold)


@pytest.mark.parametrize(
    "changes",
    [
        {"scene": "bar", "friction_law": "slip-dependent", "friction_ratio": 0.7},
        {"scene": "block", "friction_law": "general", "cohesion": 1e4},
        {"scene": "bar", "elements": 12},
    ],
)
def test_where_several_solutions_may_exist_or_states_do_not_fit_a_run_starts_anew(
    changes: dict[str, Any],
) -> None:
    scene = changes.pop("scene")
    moved = of(scene, **changes)
    before = states_after(begun(scene), moved)
    assert before is not None
    assert len(dragged(moved, before).history) > 1


def order_of(settings: Settings, **options: Any) -> Start:
    pace = options.pop("pace", math.inf)
    return Start(2, settings, pace, **options)


BAR = answer(default_settings("bar"))


@pytest.mark.parametrize(
    ("order", "is_warm"),
    [
        (order_of(BAR.replace(friction=0.4), is_dragged=True), True),
        (order_of(BAR.replace(friction=0.4)), True),
        (order_of(BAR), False),
        (order_of(BAR.replace(friction=0.4, k_scale=2.0), is_dragged=True), False),
        (order_of(BAR.replace(substructures=5)), False),
        (order_of(BAR.replace(friction=0.4), pace=0.0, steps=1), False),
        (order_of(answer(default_settings("rope"))), False),
    ],
)
def test_what_is_there_to_be_seen_from_its_start_starts_from_nothing(
    order: Start, is_warm: bool
) -> None:
    last = LastAnswer(order_of(BAR), np.zeros((1, 1), dtype=np.int8))
    assert (last.start_of(order, Needs()) is not None) is is_warm
    # The run of the value at which a slider is released keeps its picture.
    let_go = LastAnswer(order_of(BAR, is_dragged=True), last.states)
    assert let_go.start_of(order_of(BAR), Needs()) is not None
    counting = Needs(readings=("iterations",))
    assert let_go.start_of(order_of(BAR), counting) is None


def test_a_run_that_follows_a_slider_is_compared_with_its_own_solution(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begin = of("block")
    moved = begin.with_change("friction", 1.02 * begin.values()["friction"])
    found = dragged(moved, states_after(begun("block"), moved))
    fresh = reference_of(found.sampler.problem)

    def refuse(*arguments: Any) -> None:
        raise AssertionError("the solution was found a second time")

    monkeypatch.setattr(sys.modules[ReferenceCache.__module__], "reference_of", refuse)
    assert not found.frame(Needs()).run.is_compared
    while found.rest() is not None:
        found.advance()
    run = found.frame(Needs()).run
    assert run.is_compared
    assert math.isnan(run.reference_seconds)
    assert run.reference_loop is not None
    loop = np.stack(found.sampler.loop.along(fresh))
    # A frame has single precision.
    shown = run.reference_loop.shape[1]
    assert shown == loop.shape[1]
    assert np.allclose(run.reference_loop, loop, rtol=1e-6, atol=0.0)


def test_an_answer_starts_as_the_fast_method_does_and_a_chosen_start_stays() -> None:
    assert answer(default_settings("bar")).start == "nested"
    assert answer(default_settings("block")).start == "zero"
    belt = default_settings("belt")
    assert answer(belt).start == "zero"
    assert answer(belt.replace(start="nested")).start == "nested"
