"""The command `python -m solver lesson`, which tests what lessons claim."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any

from solver.lessons.checking import Outcome, check
from solver.lessons.reading import lesson_from_file


def add_lesson(commands: Any) -> None:
    """Add the command that checks lessons."""
    lesson = commands.add_parser("lesson", help="test what lessons claim")
    lesson.add_argument("files", nargs="+", type=Path, metavar="FILE", help="lessons (.toml)")
    lesson.set_defaults(command=_lesson)


def _lesson(chosen: argparse.Namespace) -> int:
    lessons = [lesson_from_file(path) for path in chosen.files]
    missed = 0
    for lesson in lessons:
        print(f"{lesson.name}: {lesson.title}")
        for outcome in check(lesson):
            print(f"  {line(outcome)}", flush=True)
            missed += not outcome.holds
    return int(missed > 0)


def line(outcome: Outcome) -> str:
    """Say in a line what was claimed, measured and expected."""
    one = outcome.checkpoint
    sign = "+" if outcome.holds else "-"
    measured = f"{outcome.value:.4g} {one.reading.quantity.unit}".strip()
    if math.isinf(outcome.value):
        measured = "never"
    return f"{sign} {one.claim} {one.reading.title}: {measured}; expected {one.expected.words}"
