"""The command `python -m solver lesson`, which tests what lessons claim."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any

from solver.lessons.checking import CheckedClaim, Said, check
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


def line(outcome: CheckedClaim | Said) -> str:
    """Say in a line what was claimed, measured and expected."""
    sign = "+" if outcome.holds else "-"
    if isinstance(outcome, Said):
        said = outcome.checkpoint
        return f"{sign} {said.claim} The run says: {outcome.words}; expected {said.says}"
    one = outcome.checkpoint
    unit = one.reading.quantity.unit
    measured = _written(outcome.value, unit)
    if outcome.seen is not None and not one.expected.holds(outcome.seen):
        measured += f", but {_written(outcome.seen, unit)} at the instant of the plots"
    return f"{sign} {one.claim} {one.reading.title}: {measured}; expected {one.expected.words}"


def _written(value: float, unit: str) -> str:
    return "never" if math.isinf(value) else f"{value:.4g} {unit}".strip()
