"""Lessons: files that are read, tested by runs, and shown by the page.

A lesson is a question, a prediction, a run with one or two controls, and claims that
runs test.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from solver.files.saved import dump, scene_settings
from solver.files.toml_files import (
    check_controls,
    check_keys,
    fields_in,
    placed,
    read_toml,
    require,
)
from solver.refusal import is_number
from solver.settings.scene import Settings
from solver.settings.values import SettingError
from solver.study.quantities import reading
from solver.study.quantities.finished import FinishedRun
from solver.study.quantities.quantity import Quantity, written
from solver.study.scene_run import finished_run

SUBJECTS = "mechanics", "method"
OF_CHECKPOINT = {
    "claim": str,
    "settings": dict,
    "quantity": str,
    "expected": (int, float, list, str),
    "tolerance": (int, float),
}
"""Keys of a checkpoint; `settings` and `tolerance` may be left out."""
MOST_CONTROLS = 2
FEWEST_POINTS = 3
"""Smallest number of points of a curve that learners may draw."""


@dataclass(frozen=True, eq=False)
class Claim:
    """A claim of a lesson on a quantity of a run.

    Attributes
    ----------
    claim
        The claim in words.
    settings
        Settings of the run.
    quantity
        Quantity that is measured.
    low, high
        Range in which the claim holds, infinite for an event that never comes.
    expected
        This range in words.
    """

    claim: str
    settings: Settings
    quantity: Quantity
    low: float
    high: float
    expected: str

    def tested(self, run: FinishedRun, share: float) -> tuple[bool, str]:
        """Test the claim in a run: return whether it holds, and a sentence.

        A quantity of one instant has to be as expected at the instant of the plots,
        too, which is at a `share` of the interval.
        """
        quantity = self.quantity
        value = self.quantity(run)
        holds = self.low <= value <= self.high
        words = written(value, quantity.unit, 4)
        if quantity.when is not None:
            # What a learner sees in the plots must not contradict the claim.
            seen = quantity.of(run, round(share * (run.problem.n_instants - 1)))
            if not self.low <= seen <= self.high:
                holds = False
                at_plots = written(seen, quantity.unit, 4)
                words += f", but {at_plots} at the instant of the plots"
        return holds, f"{quantity.title}: {words}; expected {self.expected}"


@dataclass(frozen=True, eq=False)
class Lesson:
    """A lesson by its file, whose name it has.

    `app/lessons/README.md` explains the keys. `right` is the index of the right choice;
    text and explanation are in paragraphs. `instant` and `until` are shares of the
    interval. An empty `interface` means the first one.
    """

    name: str
    title: str
    order: int
    subject: str
    question: str
    choices: tuple[str, ...]
    right: int
    why: str
    settings: Settings
    controls: tuple[str, ...]
    views: tuple[str, ...]
    text: tuple[str, ...]
    explanation: tuple[str, ...]
    checkpoints: tuple[Claim, ...]
    instant: float
    interface: str = ""
    draw: str = ""
    beside: tuple[str, ...] = ()
    until: float = 1.0

    @property
    def curve(self) -> list[tuple[float, float]]:
        """Expected values over the setting `draw`, in its order.

        The points are those of the checkpoints that change this setting alone and ask
        for the quantity of the first of them: the middle of the range that is expected,
        infinite for never.
        """
        curve: dict[float, float] = {}
        given = self.settings.values()
        asked = ""
        for claim in self.checkpoints:
            values = claim.settings.values()
            # A claim with another change is a point of another curve.
            others = [name for name in given if name != self.draw]
            same = all(values[name] == given[name] for name in others)
            if self.draw in values and same and asked in ("", claim.quantity.name):
                asked = claim.quantity.name
                curve[values[self.draw]] = 0.5 * (claim.low + claim.high)
        return sorted(curve.items())


def check(lesson: Lesson) -> Iterator[tuple[bool, str]]:
    """Test the claims of a lesson; return whether each holds, and a line of text.

    Claims with equal settings share a run.
    """
    reads = {claim.quantity.reads for claim in lesson.checkpoints}
    errors = "errors" in reads
    indicators = "indicators" in reads
    # Claims often test several quantities of one run.
    runs: dict[str, FinishedRun] = {}
    for claim in lesson.checkpoints:
        key = dump(claim.settings)
        if key not in runs:
            runs[key] = finished_run(
                claim.settings, errors=errors, indicators=indicators
            )
        holds, words = claim.tested(runs[key], lesson.instant)
        mark = "-"
        if holds:
            mark = "+"
        yield holds, f"{mark} {claim.claim} {words}"


def lesson_from_file(path: Path) -> Lesson:
    """Read a lesson; the message of a refusal begins with the name of its file."""
    with placed(path.name):
        return _lesson(path.stem, read_toml(path, "lesson"))


def _lesson(name: str, table: Mapping[str, Any]) -> Lesson:
    """Make a lesson from the table of a file; refuse other tables."""
    kept = {
        "scene": str,
        "settings": dict,
        "text": str,
        "explanation": str,
        "checkpoints": list,
    }
    values = fields_in(Lesson, table, **kept)
    kind = scene_settings(values.pop("scene"))
    with placed("settings"):
        settings = kind.checked(values["settings"])
    controls = values["controls"]
    can = f"at most {MOST_CONTROLS} settings"
    # A learner who turns several controls at once learns of none of them.
    is_few = len(controls) <= MOST_CONTROLS
    require(is_few, "controls", controls, can, "a lesson is about one thing")
    check_controls(controls, settings)
    for key in ("text", "explanation"):
        with placed(key):
            values[key] = _paragraphs(values[key], controls)
    values["checkpoints"] = tuple(_checkpoints(values["checkpoints"], settings))
    values["settings"] = settings
    # Files count from 1.
    values["right"] -= 1
    lesson = Lesson(name=name, **values)
    _check(lesson)
    return lesson


def _check(lesson: Lesson) -> None:
    """Refuse numbers out of range, and unknown names."""
    right = lesson.right + 1
    count = len(lesson.choices)
    can = f"the number of one of at least two choices, of which there are {count}"
    require(1 <= right <= count >= 2, "right", right, can, "count from 1")
    subject = lesson.subject
    known = ", ".join(SUBJECTS)
    require(subject in SUBJECTS, "subject", subject, known, "say what it is about")
    instant = lesson.instant
    until = lesson.until
    can = "a share of the interval, from 0 to 1"
    require(0.0 <= instant <= 1.0, "instant", instant, can, "say where its plots stand")
    can += " and above 0"
    require(0.0 < until <= 1.0, "until", until, can, "say how far its picture moves")
    known = ", ".join(lesson.views)
    are_shown = {*lesson.beside} <= {*lesson.views}
    require(are_shown, "beside", lesson.beside, known, "choose some of its views")
    _check_curve(lesson)


def _check_curve(lesson: Lesson) -> None:
    """Refuse a curve to draw that has too few points."""
    points = []
    for position, value in lesson.curve:
        if position > 0.0 and math.isfinite(value):
            points.append(position)
    is_drawn = not lesson.draw or len(points) >= FEWEST_POINTS
    can = f"a setting that {FEWEST_POINTS} checkpoints with a number change alone"
    remedy = "write more checkpoints, or leave it out"
    require(is_drawn, "draw", lesson.draw, can, remedy)


def _paragraphs(text: str, controls: tuple[str, ...]) -> tuple[str, ...]:
    """Split a text into paragraphs; refuse unknown placeholders."""
    for placeholder in re.findall(r"\{(.*?)\}", text):
        kind, _, name = placeholder.partition(":")
        if kind == "value":
            reading(name)
        elif kind != "control" or name not in controls:
            known = ", ".join(f"{{control:{control}}}" for control in controls)
            can = f"{known}, {{value:QUANTITY}}"
            remedy = "correct what stands in braces"
            raise SettingError("placeholder", placeholder, can, remedy)
    return tuple(" ".join(part.split()) for part in text.split("\n\n") if part.strip())


def _checkpoints(values: list[Any], settings: Settings) -> Iterator[Claim]:
    """Make claims from the tables of checkpoints; refuse other entries."""
    remedy = "say what the lesson claims"
    require(bool(values), "checkpoints", values, "at least one", remedy)
    for number, entry in enumerate(values, start=1):
        with placed(f"checkpoint {number}"):
            is_table = isinstance(entry, dict)
            require(is_table, "checkpoints", entry, "a table", "write [[checkpoints]]")
            check_keys(entry, OF_CHECKPOINT, optional=("settings", "tolerance"))
            changed = settings.replace(**entry.get("settings", {}))
            quantity = reading(entry["quantity"])
            yield Claim(entry["claim"], changed, quantity, *_expected(entry))


def _expected(entry: Mapping[str, Any]) -> tuple[float, float, str]:
    """Low and high end of the expected range, and the text of the range.

    A range is given by a number and its tolerance, by two numbers, or by "never".
    """
    value = entry["expected"]
    tolerance = entry.get("tolerance")
    if value == "never" and tolerance is None:
        return math.inf, math.inf, "never"
    if isinstance(value, list) and tolerance is None and len(value) == 2:
        if all(map(is_number, value)) and value[0] <= value[1]:
            return value[0], value[1], f"{value[0]:g} to {value[1]:g}"
    elif is_number(value) and tolerance is not None:
        if not 0.0 <= tolerance < 1.0:
            raise SettingError(
                "tolerance", tolerance, "a share from 0 to below 1", "mend it"
            )
        off = abs(value) * tolerance
        return value - off, value + off, f"{value:g} within {100 * tolerance:g} %"
    allowed = 'a number with a tolerance, a range [low, high], or "never"'
    remedy = "write a tolerance beside a number, and only there"
    raise SettingError("expected", value, allowed, remedy)
