"""All lessons, and the settings, plots and quantities that a page has of one."""

from __future__ import annotations

from pathlib import Path

from app.state import SEARCH
from app.views.catalogue import CARDS
from app.views.view import View
from solver.lessons.lesson import SUBJECTS, Lesson, Value, pieces
from solver.lessons.reading import lesson_from_file
from solver.settings import Settings

_READ = map(lesson_from_file, Path(__file__).parent.glob("*.toml"))
LESSONS = {
    lesson.name: lesson
    for lesson in sorted(_READ, key=lambda lesson: (SUBJECTS.index(lesson.subject), lesson.order))
}
"""By name, in order, those of one subject together."""
_KINDS = {kind.name: kind for card in CARDS for kind in card}


def settings_of(lesson: Lesson) -> Settings:
    """Settings with which a page begins a lesson: one sees the search, unless its file has another.

    Lessons with the paper's method show every iterate as it is.
    """
    settings = lesson.settings
    return settings.replace(**SEARCH) if settings.finish == "at-once" else settings


def kinds_of(lesson: Lesson, *, is_answered: bool) -> tuple[type[View], ...]:
    """The plots that stand beside a lesson; before the choice only those that leave it open."""
    names = lesson.views if is_answered else lesson.beside
    return tuple(_KINDS[name] for name in names)


def readings_of(lesson: Lesson) -> list[str]:
    """Names of the quantities in what a lesson says."""
    every = (piece for text in (*lesson.text, *lesson.explanation) for piece in pieces(text))
    return list(dict.fromkeys(piece.reading.name for piece in every if isinstance(piece, Value)))


def lesson_after(lesson: Lesson) -> Lesson | None:
    """The next one, if there is one."""
    names = list(LESSONS)
    place = names.index(lesson.name) + 1
    return LESSONS[names[place]] if place < len(names) else None
