"""A lesson asks before it tells, and has its plots, its run and its quantities."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import panel as pn
import panel_material_ui as pmui
import pytest
from frames import ran

from app.frame import Frame
from app.lessons.catalogue import (
    LESSONS,
    PENDING,
    filled,
    kinds_of,
    parts_of,
    readings_of,
    settings_of,
    without_controls,
)
from app.lessons.guide import WITHOUT, Guide, kinds_beside
from app.lessons.handout import _drawn, handout
from app.messages import Needs
from app.state import PageState, Poll, default_settings
from app.views.scene import Scene
from app.worker.sampling import Sampler
from solver.scenes import discretise
from solver.study.lessons import Lesson
from solver.study.quantities import reading
from solver.study.scene_run import finished_run

each = pytest.mark.parametrize("lesson", LESSONS.values(), ids=list(LESSONS))
NAME = "how-fast-how-big"


class Player:
    """A transport that only tells how far it plays."""

    until = 0.0

    def play(self, until: float = 1.0, *, by_itself: bool = False) -> None:
        self.until = until

    def stop(self) -> None:
        self.until = 0.0


def panel_of(state: PageState) -> tuple[Guide, Player]:
    player: Any = Player()
    panel = Guide(state, player, lambda: None, lambda: None)
    panel.show()
    return panel, player


def words_of(panel: Guide) -> str:
    panes = [*panel.view.select(pn.pane.Markdown)]
    return " ".join(pane.object for pane in panes)


@pytest.fixture(scope="module")
def frame() -> Frame:
    """The answer of a small bar, with what a lesson names."""
    settings = default_settings("bar").replace(load="cycle", elements=20, instants=21)
    run = finished_run(settings)
    sampler = Sampler(discretise(settings), settings, 1)
    needs = Needs(readings=("dissipation@1", "error_force", "iterations_to_force@0.1"))
    return sampler.frame(run.iterate, run.solution.records, run.solution.status, needs)


@each
def test_every_plot_of_a_lesson_says_something_of_its_run(lesson: Lesson) -> None:
    assert all(
        kind.applies(lesson.settings) for kind in kinds_of(lesson, is_answered=True)
    )


@each
def test_a_lesson_on_the_method_shows_the_search_from_nothing(lesson: Lesson) -> None:
    settings = settings_of(lesson)
    if lesson.subject == "mechanics":
        # A number in its sentences would be one of an iterate.
        assert settings.finish == "at-once"
    else:
        assert settings.start == "zero"
        assert settings.finish in {"accuracy", "none"}


@each
def test_the_answer_comes_after_the_choice_and_a_search_is_watched_anew(
    lesson: Lesson,
) -> None:
    state = PageState(settings_of(lesson), lesson=lesson.name)
    panel, player = panel_of(state)
    number = state.number
    assert lesson.why not in words_of(panel)
    assert player.until == lesson.until
    assert kinds_beside(state) == kinds_of(lesson, is_answered=False)
    wrong = (lesson.right + 1) % len(lesson.choices)
    panel.predict(wrong)
    assert kinds_beside(state) == kinds_of(lesson, is_answered=True)
    assert player.until == 0.0
    assert state.selection.phase == lesson.instant
    shown = [control.name for control in panel._controls]
    assert sorted(shown) == sorted(lesson.controls)
    # A solution stays.
    assert (state.number != number) is (lesson.subject == "method")
    says_what_is_right(panel, lesson, wrong)


def says_what_is_right(panel: Guide, lesson: Lesson, choice: int) -> None:
    """The verdict names the choice, then what is right, then why."""
    (verdict,) = panel.view.select(pmui.Alert)
    chosen = verdict.object.index(lesson.choices[choice])
    right = verdict.object.index(lesson.choices[lesson.right])
    assert chosen < right < verdict.object.index(lesson.why)


def test_a_lesson_brings_its_scene_and_asks_anew_each_time() -> None:
    state = PageState(default_settings("bar"))
    panel, _ = panel_of(state)
    panel.open("lesson", "shakedown")
    assert (state.settings.scene, state.is_asked) == ("block", True)
    panel.predict(WITHOUT)
    assert not state.is_asked
    panel.open("lesson", "leaf-spring")
    assert (state.settings.scene, state.is_asked) == ("layers", True)


def test_another_scene_ends_the_lesson() -> None:
    state = PageState(settings_of(LESSONS[NAME]), lesson=NAME)
    panel, _ = panel_of(state)
    state.choose_scene("rope")
    assert (state.lesson, kinds_beside(state), panel.is_open) == ("", None, False)


def test_in_a_class_the_answer_waits_for_the_leader() -> None:
    state = PageState(settings_of(LESSONS[NAME]), lesson=NAME, poll=Poll(False, 0, 3))
    panel, _ = panel_of(state)
    panel.predict(1)
    assert state.is_asked
    state.poll = Poll(False, 1, 3, is_answered=True)
    assert not state.is_asked
    assert kinds_beside(state) == kinds_of(LESSONS[NAME], is_answered=True)


def buttons_of(panel: Guide) -> dict[str, pmui.Button]:
    return {made.label: made for made in panel.view.select(pmui.Button)}


@pytest.mark.parametrize("leads", [True, False])
def test_buttons_of_a_question_stay_while_others_predict(leads: bool) -> None:
    lesson = LESSONS[NAME]
    poll = Poll(leads, 0, 3)
    state = PageState(settings_of(lesson), lesson=NAME, poll=poll)
    panel, _ = panel_of(state)
    before = buttons_of(panel)
    state.poll = replace(poll, predicted=1)
    state.poll = replace(poll, predicted=3, counts=(1, 0, 0, 2))
    assert buttons_of(panel) == before
    bars = " ".join(pane.object for pane in panel.view.select(pn.pane.HTML))
    assert "3 of 3 have predicted." in bars
    assert "1 of 3" in bars
    assert "2 of 3" in bars
    assert before["Open the counts"].visible is False


def test_ones_own_choice_is_filled_and_may_be_another() -> None:
    lesson = LESSONS[NAME]
    state = PageState(settings_of(lesson), lesson=NAME, poll=Poll(False, 0, 3))
    panel, _ = panel_of(state)
    for choice in (2, 0):
        panel.predict(choice)
        buttons = buttons_of(panel)
        looks = [buttons[label].variant for label in lesson.choices]
        others = len(looks) - 1
        assert looks.pop(choice) == "contained"
        assert looks == ["outlined"] * others


def test_a_drawn_curve_stays_and_the_measured_one_comes_after_the_choice() -> None:
    lesson = LESSONS["best-k"]
    state = PageState(settings_of(lesson), lesson=lesson.name)
    panel, _ = panel_of(state)
    curve = panel._curve
    assert curve is not None
    curve.drawn.data = {"xs": [[0.01, 100.0]], "ys": [[100.0, 10.0]]}
    assert not len(curve.measured.data["x"])
    panel.predict(0)
    assert panel._curve is curve
    assert list(curve.measured.data["text"]) == ["never", "", "", "", "never"]
    assert list(curve.measured.data["y"][1:4]) == [302, 28, 294]


def test_a_frame_brings_the_quantities_that_a_lesson_names(frame: Frame) -> None:
    assert frame.readings["dissipation@1"] == reading("dissipation@1")(
        finished_run(frame.run.settings)
    )
    assert "**" in filled("{value:dissipation@1}", frame)
    assert PENDING in filled("{value:dissipation@1}", None)
    # An iterate of a search is not what a text tells of.
    searching = replace(frame, status=None)
    assert PENDING in filled("{value:dissipation@1}", searching)
    known = replace(searching, readings={"error_force@10": 0.2})
    assert "20 %" in filled("{value:error_force@10}", known)


def test_what_may_still_come_is_not_called_never(frame: Frame) -> None:
    name = "iterations_to_force@0.1"
    open_frame = replace(frame, status=None, readings={name: math.inf})
    assert PENDING in filled(f"{{value:{name}}}", open_frame)
    ended = replace(frame, readings={name: math.inf})
    assert "more than" in filled(f"{{value:{name}}}", ended)


def test_a_control_stands_in_its_sentence_and_not_on_paper() -> None:
    text = "Move k: {control:k_scale}. It takes {value:iterations} iterations."
    before, control, after = parts_of(text)
    assert (before, control) == ("Move k: ", "k_scale")
    assert after == "It takes {value:iterations} iterations."
    assert without_controls(text) == "It takes {value:iterations} iterations."


def test_a_round_arch_is_round_on_paper() -> None:
    lesson = LESSONS["standing-arch"]
    frame = ran(lesson.settings.replace(voussoirs=6, instants=5))
    state = PageState(frame.run.settings, frame=frame)
    figure = _drawn(Scene(state), state, lesson, 660)
    assert figure.x_range.end / figure.width == figure.y_range.end / figure.height


def test_a_handout_asks_in_front_and_answers_overleaf(frame: Frame) -> None:
    lesson = LESSONS[NAME]
    state = PageState(frame.run.settings, lesson=NAME, frame=frame)
    text = handout(state, lesson, None)
    front, back = text.split('class="overleaf"')
    assert lesson.question in front
    assert lesson.why in back
    assert "localhost" not in text.split("<body>")[1]
    assert "Pull harder" not in text
    assert " src=" not in text.split("<style>")[0].rsplit("</script>", 1)[1]
    assert "static/extensions" not in text
    assert readings_of(lesson)
