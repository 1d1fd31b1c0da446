"""Every lesson says what the engine does, in words that the page has a place for."""

from __future__ import annotations

import functools
from pathlib import Path

import pytest

from app.views.catalogue import CARDS
from solver.lessons.checking import CheckedClaim, Said, check
from solver.lessons.command import line
from solver.lessons.lesson import Control, Lesson, Value, pieces
from solver.lessons.reading import lesson_from_file
from solver.scenes import discretise

FOLDER = Path(__file__).resolve().parents[1] / "app" / "lessons"
LESSONS = {path.stem: lesson_from_file(path) for path in sorted(FOLDER.glob("*.toml"))}
CHECKPOINTS = [
    pytest.param(name, number, id=f"{name}: {one.claim}")
    for name, lesson in LESSONS.items()
    for number, one in enumerate(lesson.checkpoints)
]
each = pytest.mark.parametrize("lesson", LESSONS.values(), ids=list(LESSONS))


@functools.cache
def outcomes(name: str) -> list[CheckedClaim | Said]:
    """Give all of a lesson's at once, because they share runs."""
    return list(check(LESSONS[name]))


@pytest.mark.parametrize(("name", "number"), CHECKPOINTS)
def test_what_a_lesson_claims_is_measured(name: str, number: int) -> None:
    found = outcomes(name)[number]
    assert found.holds, line(found)


@each
def test_the_interface_that_plots_are_of_is_there(lesson: Lesson) -> None:
    assert {lesson.interface} <= {"", *discretise(lesson.settings).rubbing}


@each
def test_the_views_of_a_lesson_are_there_and_fit_its_run(lesson: Lesson) -> None:
    shown = {kind.name for card in CARDS for kind in card if kind.applies(lesson.settings)}
    assert set(lesson.views) <= shown


@each
def test_every_control_stands_in_a_sentence_of_the_explanation(lesson: Lesson) -> None:
    places = [piece for paragraph in lesson.explanation for piece in pieces(paragraph)]
    assert {one.setting for one in places if isinstance(one, Control)} == set(lesson.controls)
    assert any(isinstance(one, Value) for one in places)


@each
def test_nothing_before_the_choice_can_be_moved(lesson: Lesson) -> None:
    places = [piece for paragraph in lesson.text for piece in pieces(paragraph)]
    assert not [one for one in places if isinstance(one, Control)]
