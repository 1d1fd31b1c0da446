"""Reading lesson files; what is wrong with one is said in a line."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from solver.definitions import SettingError
from solver.files import scene_settings
from solver.lessons.lesson import SUBJECTS, Claim, EndingClaim, Expected, Lesson
from solver.settings import Settings
from solver.study.quantities import reading
from solver.toml_files import check_keys, placed, read_toml

KEYS = {
    "title": str,
    "order": int,
    "subject": str,
    "question": str,
    "choices": list,
    "right": int,
    "why": str,
    "scene": str,
    "settings": dict,
    "controls": list,
    "views": list,
    "text": str,
    "explanation": str,
    "instant": (int, float),
    "interface": str,
    "draw": str,
    "beside": list,
    "until": (int, float),
    "checkpoints": list,
}
"""Keys of a lesson, and the type of each; `OPTIONAL` may be left out."""
OPTIONAL = "interface", "draw", "beside", "until"
OF_CHECKPOINT = {
    "claim": str,
    "settings": dict,
    "quantity": str,
    "expected": (int, float, list, str),
    "tolerance": (int, float),
}
"""Keys of a checkpoint; `settings` and `tolerance` may be left out."""
OF_VERDICT = {"claim": str, "settings": dict, "says": str}
"""Keys of one that tells with which words a run ends; `settings` may be left out."""
INTERVAL = "a share of the interval, from 0 to 1"
MOST_CONTROLS = 2
FEWEST_POINTS = 3
"""Of a curve that one may draw."""


def lesson_from_file(path: Path) -> Lesson:
    """Read a lesson.

    Raises
    ------
    SettingError
        For a file that cannot be read, or that is refused; the message begins with its name.
    """
    with placed(path.name):
        return _lesson(path.stem, read_toml(path, "lesson"))


def _lesson(name: str, values: Mapping[str, Any]) -> Lesson:
    check_keys(values, KEYS, optional=OPTIONAL)
    kind = scene_settings(values["scene"])
    with placed("settings"):
        settings = kind.checked(values["settings"])
    choices, controls, views = (_names(key, values) for key in ("choices", "controls", "views"))
    beside = _names("beside", values) if "beside" in values else ()
    right, until, subject = values["right"], values.get("until", 1.0), values["subject"]
    allowed = f"the number of one of at least two choices, of which there are {len(choices)}"
    for key, is_right, can, remedy in (
        ("right", len(choices) >= 2 and 1 <= right <= len(choices), allowed, "count from 1"),
        ("instant", 0.0 <= values["instant"] <= 1.0, INTERVAL, "say where its plots stand"),
        ("until", 0.0 < until <= 1.0, f"{INTERVAL} and above 0", "say how far its picture moves"),
        ("subject", subject in SUBJECTS, ", ".join(SUBJECTS), "say what it is about"),
        ("beside", set(beside) <= set(views), ", ".join(views), "choose some of its views"),
    ):
        if not is_right:
            raise SettingError(key, values.get(key), can, remedy)
    _check_controls(controls, settings)
    paragraphs = {}
    for key in ("text", "explanation"):
        with placed(key):
            paragraphs[key] = _paragraphs(values[key], controls)
    read = {
        **{key: value for key, value in values.items() if key != "scene"},
        **{"settings": settings, "choices": choices, "controls": controls, "views": views},
        **{"beside": beside, "right": right - 1, "until": until, **paragraphs},
        "checkpoints": tuple(_checkpoints(values["checkpoints"], settings)),
    }
    lesson = Lesson(name=name, **read)
    points = [place for place, value in lesson.curve if place > 0.0 and math.isfinite(value)]
    if lesson.draw and len(points) < FEWEST_POINTS:
        allowed = f"a setting that {FEWEST_POINTS} checkpoints with a number change alone"
        raise SettingError("draw", lesson.draw, allowed, "write more checkpoints, or leave it out")
    return lesson


def _names(key: str, values: Mapping[str, Any]) -> tuple[str, ...]:
    names = values[key]
    if not names or not all(isinstance(name, str) and name for name in names):
        raise SettingError(key, names, "a list of texts, at least one", "write them in quotes")
    return tuple(names)


def _check_controls(controls: tuple[str, ...], settings: Settings) -> None:
    """Refuse controls that are no settings, that do nothing, and more than a few."""
    if len(controls) > MOST_CONTROLS:
        allowed = f"at most {MOST_CONTROLS} settings"
        raise SettingError("controls", controls, allowed, "a lesson is about one thing")
    working = [name for name in settings.definitions() if settings.applies(name)]
    for name in controls:
        if name not in working:
            remedy = "name a setting that does something with the lesson's settings"
            raise SettingError("controls", name, ", ".join(working), remedy)


def _paragraphs(text: str, controls: tuple[str, ...]) -> tuple[str, ...]:
    """Paragraphs between empty lines; placeholders that stand for nothing are refused."""
    for place in re.findall(r"\{(.*?)\}", text):
        kind, _, name = place.partition(":")
        if kind == "value":
            reading(name)
        elif kind != "control" or name not in controls:
            known = ", ".join(f"{{control:{control}}}" for control in controls)
            remedy = "correct what stands in braces"
            raise SettingError("placeholder", place, f"{known}, {{value:QUANTITY}}", remedy)
    return tuple(" ".join(part.split()) for part in text.split("\n\n") if part.strip())


def _checkpoints(values: list[Any], settings: Settings) -> Iterator[Claim | EndingClaim]:
    if not values:
        raise SettingError("checkpoints", values, "at least one", "say what the lesson claims")
    for number, entry in enumerate(values, start=1):
        with placed(f"checkpoint {number}"):
            if not isinstance(entry, dict):
                raise SettingError("checkpoints", entry, "a table", "write [[checkpoints]]")
            yield _checkpoint(entry, settings)


def _checkpoint(entry: dict[str, Any], settings: Settings) -> Claim | EndingClaim:
    if "says" in entry:
        check_keys(entry, OF_VERDICT, optional=("settings",))
    else:
        check_keys(entry, OF_CHECKPOINT, optional=("settings", "tolerance"))
    claim, own = entry["claim"], settings.replace(**entry.get("settings", {}))
    if "says" in entry:
        return EndingClaim(claim, own, entry["says"])
    expected = _expected(entry["expected"], entry.get("tolerance"))
    return Claim(claim, own, reading(entry["quantity"]), expected)


def _expected(value: Any, tolerance: float | None) -> Expected:
    """Read what is expected: a number and its relative tolerance, a range, or "never"."""
    allowed = 'a number with a tolerance, a range [low, high], or "never"'
    if value == "never" and tolerance is None:
        return Expected(math.inf, math.inf, "never")
    if isinstance(value, list) and tolerance is None and len(value) == 2:
        if all(map(_is_number, value)) and value[0] <= value[1]:
            return Expected(value[0], value[1], f"{value[0]:g} to {value[1]:g}")
    elif _is_number(value) and tolerance is not None:
        if not 0.0 <= tolerance < 1.0:
            raise SettingError("tolerance", tolerance, "a share from 0 to below 1", "mend it")
        off = abs(value) * tolerance
        return Expected(value - off, value + off, f"{value:g} within {100 * tolerance:g} %")
    remedy = "write a tolerance beside a number, and only there"
    raise SettingError("expected", value, allowed, remedy)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
