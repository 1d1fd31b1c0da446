"""What the page has of the lessons: all of them, and what each says before and after the choice."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

from app.components.form import item_of
from app.languages.language import LESSON as OPEN
from app.languages.language import Language
from app.picture.glossary import ENGLISH
from solver.definitions import about
from solver.lessons.lesson import SUBJECTS, Control, Lesson, Value, pieces
from solver.lessons.reading import lesson_from_file
from solver.phrases import Phrase

FOLDER = Path(__file__).parent
LESSONS = {
    one.name: one
    for one in sorted(
        map(lesson_from_file, FOLDER.glob("*.toml")),
        key=lambda one: (SUBJECTS.index(one.subject), one.order),
    )
}
"""All lessons by their names, in order, those of one subject together."""
NO_CHOICE = -1
"""Stands for the choice of who wants to see and not to predict."""
MARKS = re.compile(r"\*+(.+?)\*+|\^(\d+)")
KINDS = "text", "em", "sup"
"""Of what stands between the marks, and in either of them."""


def offered(say: Language) -> list[list[str]]:
    """Give name, title, question and subject of every lesson."""
    return [[one.name, say(one.title), say(one.question), one.subject] for one in LESSONS.values()]


def content(lesson: Lesson, choice: int | None, say: Language = ENGLISH) -> dict[str, Any]:
    """Say what the page shows of a lesson; the answer and the controls come after the choice.

    Parameters
    ----------
    lesson
        The one that is open.
    choice
        Index of what was predicted, or `NO_CHOICE`; None before the choice.
    say
        Says it in the page's language.
    """
    place = list(LESSONS).index(lesson.name)
    found: dict[str, Any] = {
        "name": lesson.name,
        "place": say(Phrase("Lesson {} of {}", place + 1, len(LESSONS))),
        "title": say(lesson.title),
        "text": [parts(say(one, OPEN)) for one in lesson.text],
        "question": say(lesson.question),
        "choices": [say(one, OPEN) for one in lesson.choices],
    }
    if lesson.draw:
        found["curve"] = axes(lesson, is_answered=choice is not None)
    if choice is None:
        return found
    definitions = lesson.settings.definitions()
    return {
        **found,
        "choice": choice,
        "right": lesson.right,
        "why": say(lesson.why, OPEN),
        "explanation": [parts(say(one, OPEN)) for one in lesson.explanation],
        "items": [item_of(name, definitions[name]) for name in lesson.controls],
        "next": offered(say)[place + 1][:2] if place + 1 < len(LESSONS) else [],
    }


def axes(lesson: Lesson, *, is_answered: bool) -> dict[str, Any]:
    """Say over what a curve is drawn, and once it is, what was measured.

    Infinite values become null: they lie beyond the axis.
    """
    places, values = zip(*lesson.curve, strict=True)
    largest = max(one for one in values if math.isfinite(one))
    shown = [one if math.isfinite(one) else None for one in values]
    return {
        "across": about(lesson.settings.definitions()[lesson.draw]).title,
        "up": lesson.drawn_quantity,
        "places": list(places),
        "top": 10.0 ** math.ceil(math.log10(largest)),
        "values": shown if is_answered else [],
    }


def readings(lesson: Lesson, choice: int | None) -> tuple[str, ...]:
    """Give the names of the quantities in what is shown of a lesson."""
    shown = lesson.text if choice is None else (*lesson.text, *lesson.explanation)
    every = (piece for paragraph in shown for piece in pieces(paragraph))
    return tuple(dict.fromkeys(one.reading.name for one in every if isinstance(one, Value)))


def parts(paragraph: str) -> list[list[str]]:
    """Split a paragraph into parts of one kind.

    These are "text", "em" and "sup" with their words, "control" with a setting, and "value" with
    the name of a quantity and what it is called.
    """
    found = []
    for piece in pieces(paragraph):
        match piece:
            case Control(setting):
                found.append(["control", setting])
            case Value(reading):
                found.append(["value", reading.name, reading.title])
            case words:
                split = enumerate(MARKS.split(words))
                found.extend([KINDS[number % 3], text] for number, text in split if text)
    return found
