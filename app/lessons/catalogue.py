"""All lessons and cases: settings, plots, and texts with quantities of a frame."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from itertools import chain
from pathlib import Path

from app.frame import Frame
from app.state import SEARCH
from app.units import percent
from app.views.catalogue import CARDS
from app.views.view import View
from solver.files.amounts import number, unit_for
from solver.settings.scene import Settings
from solver.study.lessons import SUBJECTS, Lesson, lesson_from_file
from solver.study.quantities import reading
from solver.study.trade_case import Case, cases_by_name

_IN_ORDER = sorted(
    map(lesson_from_file, Path(__file__).parent.glob("*.toml")),
    key=lambda lesson: (SUBJECTS.index(lesson.subject), lesson.order),
)
LESSONS = {lesson.name: lesson for lesson in _IN_ORDER}
"""Lessons by name, in order, those of a subject together."""
CASES = cases_by_name()
"""Cases by name, in order."""
KNOWN: dict[str, Mapping[str, Lesson | Case]] = {"lesson": LESSONS, "case": CASES}
"""Lessons and cases, by their kind as addresses and states call it."""
VALUE = re.compile(r"\{value:(.*?)\}")
"""Pattern of a quantity in the text of a lesson."""
PENDING = "…"
"""Text in place of a quantity that only the rest of the run will tell."""
KINDS = {kind.name: kind for kind in chain.from_iterable(CARDS)}
"""Classes of the plots, by name."""


def settings_of(lesson: Lesson | Case) -> Settings:
    """Settings with which a page begins a lesson or a case.

    In lessons on the method the search is watched in place of an answer at once; what
    is said in cases and in lessons on mechanics is said of the solution. Other ways to
    finish stay: with the paper's method every iterate is shown as it is.
    """
    settings = lesson.settings
    is_on_method = isinstance(lesson, Lesson) and lesson.subject == "method"
    if not is_on_method or settings.finish != "at-once":
        return settings
    return settings.replace(**SEARCH)


def plots_of(case: str) -> list[str]:
    """Names of the plots shown first in a case; empty without a case.

    The one with the flag at the known number comes before the others.
    """
    if case not in CASES:
        return []
    names = list(CASES[case].views)
    flag = CASES[case].flag
    if flag is not None:
        names.insert(0, flag.plot)
    return list(dict.fromkeys(names))


def kinds_of(lesson: Lesson, *, is_answered: bool) -> tuple[type[View], ...]:
    """The plots of a lesson; before the choice those that do not show the answer."""
    names = lesson.beside
    if is_answered:
        names = lesson.views
    return tuple(KINDS[name] for name in names)


def readings_of(lesson: Lesson) -> list[str]:
    """Names of the quantities in the texts of a lesson."""
    names = VALUE.findall(" ".join((*lesson.text, *lesson.explanation)))
    # Each once, in their order.
    return list(dict.fromkeys(names))


def parts_of(paragraph: str) -> list[str]:
    """Parts of a paragraph: Markdown, and names of settings with a control, in turn."""
    # A sentence ends with its control: its full stop would stand alone.
    return re.split(r"\{control:(.*?)\}[ .:]*", paragraph)


def without_controls(paragraph: str) -> str:
    """A paragraph without sentences with a control, for paper."""
    sentences = re.split(r"(?<=[.?!]) +", paragraph)
    return " ".join(sentence for sentence in sentences if "{control:" not in sentence)


def filled(text: str, frame: Frame | None) -> str:
    """Markdown with the quantities of a frame filled in."""
    text = VALUE.sub(lambda match: f"**{_value(frame, match[1])}**", text)
    return re.sub(r"\^(\d+)", r"<sup>\1</sup>", text)


def _value(frame: Frame | None, name: str) -> str:
    """A quantity of a frame with its unit, or a placeholder until it is known."""
    if frame is None or name not in frame.readings:
        return PENDING
    value = frame.readings[name]
    quantity = reading(name)
    is_of_result = quantity.reads is None
    # What an iterate loses to friction, say, is none of the cases that texts tell of.
    if frame.status is None and (is_of_result or not math.isfinite(value)):
        return PENDING
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        # All that is counted and may never come are iterations.
        if quantity.unit:
            return "not reached"
        return f"more than {frame.iteration}"
    if quantity.is_share:
        return percent(value)
    if quantity.unit:
        return unit_for(abs(value), quantity.unit)(value)
    return number(value)
