"""Back and forth go through all iterates, though not each was shown."""

from __future__ import annotations

import itertools
import math
import pickle
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any
from weakref import WeakSet

import numpy as np
import pytest

import app.display
import app.worker.runner
from app.display import Display
from app.frame import Frame
from app.history import History
from app.messages import (
    Costly,
    Earlier,
    Failed,
    Needs,
    NewFrame,
    Ready,
    Show,
    Start,
    Step,
)
from app.state import PageState, default_settings
from app.status import status_line
from app.worker.references import ReferenceCache
from app.worker.runner import Runner
from app.worker.sampling import Sampler
from solver.refusal import RefusedError
from solver.scenes import discretise
from solver.settings.scene import Settings


@pytest.fixture(scope="module")
def answer() -> Frame:
    """The last frame of a run."""
    settings = default_settings("bar").replace(elements=10, instants=11)
    runner = Runner(Start(0, settings, math.inf), ReferenceCache(), lambda: False)
    while runner.rest() is not None:
        runner.advance()
    return runner.frame(Needs())


def test_iterates_that_were_not_shown_come_from_the_worker() -> None:
    settings = default_settings("bar").replace(elements=10, instants=11)
    runner = Runner(Start(0, settings, math.inf), ReferenceCache(), lambda: False)
    state = PageState(settings)
    frames = {}
    while runner.rest() is not None:
        runner.advance()
        frames[len(runner.history)] = runner.frame(Needs())
    asked = []

    def answer(order: object) -> None:
        if isinstance(order, Show):
            asked.append(order.iteration)
            state.take(Earlier(runner.earlier(order.iteration, Needs())))

    state.send = answer
    newest = runner.frame(Needs())
    for frame in (frames[1], frames[4], newest):
        state.take(NewFrame(frame))
    seen = []
    state.seek(1)
    while state.frame is not newest:
        number = state.frame.iteration
        seen.append(number)
        assert np.array_equal(state.frame.loop, frames[number].loop)
        assert len(state.frame.history["indicator"]) == number
        # The local stage of the next iterate, and its linear one.
        state.step()
        state.step()
    assert seen == list(range(1, newest.iteration + newest.is_answer))
    assert asked == [number for number in seen if number not in (1, 4)]
    state.seek(3)
    state.seek(5)
    assert len(asked) == len(seen) - 2


def test_an_iterate_that_is_gone_holds_nobody_up(answer: Frame) -> None:
    state = PageState(answer.run.settings)
    first = replace(answer, iteration=1, is_answer=False, status=None)
    state.history = History()
    for frame in (first, answer):
        state.history.add(frame)
    state.newest = answer
    state.seek(1)
    for _ in range(2 * answer.iteration):
        state.step()
    assert state.frame is answer


def test_a_step_is_a_stage_and_the_worker_does_both_at_once(answer: Frame) -> None:
    state = PageState(answer.run.settings)
    state.number = answer.run.number
    orders: list[object] = []
    state.send = orders.append

    def come(number: int) -> None:
        frame = replace(answer, iteration=number, is_answer=False, status=None)
        state.take(NewFrame(frame))

    def shown() -> tuple[int, str]:
        return state.frame.iteration, state.selection.stage

    come(1)
    state.step()
    # Until the worker has done the iteration the one before is shown.
    assert shown() == (1, "linear")
    come(2)
    assert shown() == (2, "local")
    state.step()
    assert shown() == (2, "linear")
    assert orders.count(Step()) == 1
    # Who does not wait for the local stage sees the linear one.
    state.step()
    state.step()
    come(3)
    assert shown() == (3, "linear")
    assert orders.count(Step()) == 2
    state.step()
    come(4)
    state.seek(3)
    assert shown() == (3, "linear")
    state.step()
    assert shown() == (4, "local")
    state.go_on()
    assert shown() == (4, "linear")


def test_after_the_local_stage_the_bodies_stand_where_the_iteration_before_put_them(
    answer: Frame,
) -> None:
    state = PageState(answer.run.settings)
    moved = replace(answer.deformed, nodes=2.0 * answer.deformed.nodes)
    before = replace(answer, iteration=1, is_answer=False, deformed=moved)
    after = replace(answer, iteration=2, is_answer=False)
    state.history.add(before)
    state.history.add(after)
    shown = state.before_linear(after)
    assert shown.deformed.nodes is moved.nodes
    assert shown.deformed.status is after.deformed.status
    # A search from nothing begins at rest; of other starts nothing is known.
    assert not state.before_linear(before).deformed.nodes.any()
    nested = replace(before.run, settings=before.run.settings.replace(start="nested"))
    assert state.before_linear(replace(before, run=nested)).deformed is moved


def displayed(frame: Frame, **values: Any) -> tuple[PageState, Display, list[object]]:
    """State of a page that shows a frame, its display, and the orders it sends."""
    state = PageState(frame.run.settings, **values)
    orders: list[object] = []
    state.send = orders.append
    display = Display(state, None, lambda: None)
    state.frame = frame
    return state, display, orders


def test_a_picture_whose_answer_got_lost_is_asked_for_again(
    answer: Frame, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, display, orders = displayed(answer)
    sent = display.pulse.sent
    display.catch_up()
    assert display.pulse.sent == sent
    # A message that may have another one go, which waits for it.
    assert display.pulse.looks == 1
    monkeypatch.setattr(app.display, "LOST", 0.0)
    display.catch_up()
    assert display.pulse.sent == sent + 1
    display.pulse.painted = display.pulse.sent
    assert orders == [Ready(), Ready()]
    display.catch_up()
    assert display.pulse.looks == 1


def test_of_many_pages_each_leaves_the_others_time(
    answer: Frame, monkeypatch: pytest.MonkeyPatch
) -> None:
    later: list[tuple[Callable[[], None], int]] = []
    document = SimpleNamespace(add_timeout_callback=lambda *call: later.append(call))
    state = PageState(answer.run.settings)
    display = Display(state, document, lambda: None)
    monkeypatch.setattr("app.display.time.thread_time", itertools.count().__next__)
    monkeypatch.setattr(app.display.PAGES, "count", 31)
    monkeypatch.setattr(app.display.PAGES, "opening", WeakSet())
    state.frame = answer
    state.frame = replace(answer)
    sent = display.pulse.sent
    display.pulse.painted = sent
    assert display.pulse.sent == sent
    ((go_on, milliseconds),) = later
    assert milliseconds > 20
    go_on()
    assert display.pulse.sent == sent + 1
    # More while they are made.
    others = [PageState(answer.run.settings) for _ in range(10)]
    for other in others:
        app.display.PAGES.opening.add(other)
    display.pulse.painted = display.pulse.sent
    state.frame = answer
    ((_, later_on),) = later[1:]
    assert later_on > 5 * milliseconds


def test_a_worker_makes_one_frame_ahead_and_none_for_a_page_that_is_hidden(
    answer: Frame, monkeypatch: pytest.MonkeyPatch
) -> None:
    state, display, orders = displayed(answer)
    assert orders == [Ready()]
    state.frame = replace(answer)
    assert orders == [Ready()]
    monkeypatch.setattr(app.display, "LOST", 0.0)
    display.catch_up()
    assert display.pulse.sent == 2
    assert orders == [Ready()]
    display.pulse.painted = display.pulse.sent
    assert orders == [Ready(), Ready()]


def test_a_run_that_follows_a_slider_is_compared_once_its_picture_is_seen(
    answer: Frame,
) -> None:
    _, display, orders = displayed(answer, is_dragged=True)
    assert orders == []
    display.pulse.painted = display.pulse.sent
    assert orders == [Ready()]
    start = Start(0, answer.run.settings, math.inf, is_dragged=True)
    runner = Runner(start, ReferenceCache(), lambda: False)
    while runner.rest(is_seen=False) is not None:
        runner.advance(is_seen=False)
    assert not runner.frame(Needs()).run.is_compared
    assert runner.rest(is_seen=False) is None
    while runner.rest() is not None:
        runner.advance()
    assert runner.frame(Needs()).run.is_compared


def test_a_first_picture_waits_for_a_reference_that_is_there_soon(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A bar was drawn ten times as far at first, as its first iterate moves little."""
    start = Start(0, default_settings("bar"), math.inf)
    runner = Runner(start, ReferenceCache(), lambda: False)
    runner.advance()
    assert not runner.is_presentable
    runner.advance()
    assert runner.is_presentable
    assert runner.frame(Needs()).run.reference_moved is not None
    monkeypatch.setattr(app.worker.runner, "SOON", 0.0)
    runner = Runner(start, ReferenceCache(), lambda: False)
    runner.advance()
    assert runner.is_presentable


def test_a_run_is_compared_with_others_of_its_scene_alone(answer: Frame) -> None:
    state = PageState(answer.run.settings)

    def show(settings: Settings) -> Frame | None:
        state.adopt(settings)
        run = replace(answer.run, number=state.number, settings=settings)
        state.take(NewFrame(replace(answer, run=run)))
        return state.ghost

    bar = answer.run.settings
    assert show(bar) is None
    first = state.frame
    assert show(bar.replace(friction=0.2)) is first
    state.pin()
    assert show(default_settings("rope")) is None
    assert show(bar).run.settings.friction == 0.2


def test_a_run_is_compared_with_none_of_another_structure(answer: Frame) -> None:
    state = PageState(answer.run.settings)

    def show(settings: Settings, *, stays: bool = False) -> Frame | None:
        state.adopt(settings)
        if state.frame is not None:
            assert state.is_stale
            assert "solving" in status_line(state)
        sampler = Sampler(discretise(settings), settings, state.number)
        state.take(NewFrame(replace(answer, run=sampler.run)))
        assert not state.is_stale
        return state.ghost

    bar = answer.run.settings
    assert show(bar) is None
    assert show(bar.replace(peak=0.0)) is not None
    assert show(bar) is not None
    assert show(bar.replace(length=2.0)) is None
    assert show(bar.replace(length=2.0, left_end="spring")) is None
    assert show(bar.replace(length=2.0, left_end="spring", young=1e11)) is not None


def test_a_run_that_the_engine_refuses_says_so_in_words_of_the_page() -> None:
    state = PageState(default_settings("mesh"))
    state.run()
    assert "starting" in status_line(state)
    assert state.change(sides="left held x, washers free")
    with pytest.raises(RefusedError) as refused:
        discretise(state.settings)
    state.take(Failed(state.number, pickle.loads(pickle.dumps(refused.value))))
    assert state.message.startswith("Sides cannot be displacements that leave free: ")
    assert "not run" in status_line(state)
    assert state.is_over
    state.change(sides="")
    assert not state.is_over
    assert not state.message


def test_a_run_that_waits_to_be_agreed_to_is_not_being_solved() -> None:
    state = PageState(default_settings("bar"))
    state.run()
    state.take(Costly(state.number, "2 minutes"))
    assert "not run yet" in status_line(state)


def test_what_is_dragged_does_not_fade(answer: Frame) -> None:
    state = PageState(answer.run.settings, frame=answer)
    state.drag("peak", 500.0)
    assert not state.is_stale


def test_why_a_dragged_value_is_refused_is_told_until_one_is_allowed() -> None:
    state = PageState(default_settings("belt"))
    present = state.settings
    state.drag("pull", 5000.0)
    assert "Pull above the tail force cannot be 5 kN" in state.refusal
    assert state.settings is present
    state.drag("pull", 1000.0)
    assert not state.refusal
