"""What was set is undone step by step and done again: settings, scenes, comparisons, lessons."""

from __future__ import annotations

import pytest
from lone_link import lone_session

from app.controls.comparing import pair
from app.controls.sidebar import Sidebar
from app.lessons.lesson import LESSONS
from app.session.session import Session
from app.session.undo import MOST_STEPS, Undo
from solver.scenes.bar import BarSettings


@pytest.fixture
def session() -> Session:
    return lone_session(BarSettings.checked({}))


def lessons_of(session: Session) -> Undo:
    """Give what undoes the changes of a session that opens lessons, as a page does."""

    def take(name: str) -> None:
        session.param.update(lesson=LESSONS.get(name), choice=None)

    return Undo(session, take)


def peaks(session: Session, undo: Undo) -> list[float]:
    """Undo everything; give the peaks on the way."""
    found = [session.wanted.peak]
    while session.steps[0]:
        undo.undo()
        found.append(session.wanted.peak)
    return found


def test_changes_are_undone_and_done_again_until_another_one_is_made(session: Session) -> None:
    undo = lessons_of(session)
    assert session.steps == (False, False)
    undo.undo()
    session.change("peak", 910.0)
    session.change("friction", 0.4)
    undo.undo()
    assert (session.wanted.peak, session.wanted.friction) == (910.0, 0.3)
    assert session.steps == (True, True)
    undo.redo()
    assert session.wanted.friction == 0.4
    undo.undo()
    session.change("peak", 920.0)
    assert session.steps == (True, False)
    assert peaks(session, undo) == [920.0, 910.0, 900.0]


def test_a_drag_is_one_step_also_if_the_hand_rests(session: Session) -> None:
    undo = lessons_of(session)
    sidebar = Sidebar(session, lambda name: None)

    def drag(*values: float) -> None:
        for value in values:
            sidebar.hear("peak", value, True, 1)
            sidebar.obey()
            session.let_go()
        # What was not obeyed yet is when the slider is let go.
        sidebar.hear("peak", values[-1] + 5.0, True, 1)
        sidebar.hear("peak", None, False, 2)

    drag(910.0, 920.0, 930.0)
    drag(940.0, 950.0)
    assert peaks(session, undo) == [955.0, 935.0, 900.0]


def test_a_scene_a_comparison_and_a_lesson_are_steps(session: Session) -> None:
    undo = lessons_of(session)
    session.choose_scene("strand")
    session.choose_scene("bar")
    with session.together():
        session.twin, settings = pair("paper | fast", session.wanted)
        session.start(settings)
    lesson = LESSONS["best-k"]
    with session.together():
        session.start(lesson.settings, is_alone=True)
        session.lesson = lesson
    session.choice = 2
    undo.undo()
    assert session.lesson is None
    assert session.twin is not None
    assert session.twin.method == "paper"
    undo.redo()
    assert (session.lesson, session.choice, session.twin) == (lesson, 2, None)
    undo.undo()
    undo.undo()
    assert session.twin is None
    undo.undo()
    assert session.wanted.scene == "strand"
    undo.undo()
    assert (session.wanted.scene, session.steps) == ("bar", (False, True))


def test_no_more_steps_are_kept_than_somebody_would_take(session: Session) -> None:
    undo = lessons_of(session)
    for step in range(MOST_STEPS + 10):
        session.change("peak", 1000.0 + step)
    assert peaks(session, undo)[-1] == 1009.0


def test_what_a_class_shows_is_no_step_of_who_follows(session: Session) -> None:
    undo = lessons_of(session)
    leader = lone_session(BarSettings.checked({"peak": 800.0}))
    leader.attendance.lead(leader.wanted)
    room = leader.attendance.leads
    assert room is not None
    session.attendance.follow(room)
    session.start(room.settings)
    assert (session.wanted.peak, session.steps) == (800.0, (False, False))
    session.change("peak", 700.0)
    undo.undo()
    assert session.wanted.peak == 800.0
