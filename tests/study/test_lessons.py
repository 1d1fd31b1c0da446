"""Lesson files are read as meant, or refused in a line; the engine agrees with them."""

from __future__ import annotations

import functools
import re
from itertools import chain
from pathlib import Path
from typing import Any

import pytest

from app.lessons.catalogue import LESSONS
from app.views.catalogue import CARDS
from solver.commands.cli import main
from solver.scenes import discretise
from solver.settings.values import SettingError
from solver.study.lessons import Lesson, check, lesson_from_file

PARTS: dict[str, str] = {
    "title": '"A title"',
    "order": "1",
    "subject": '"method"',
    "question": '"What?"',
    "choices": '["this", "that"]',
    "right": "2",
    "why": '"Because."',
    "scene": '"bar"',
    "settings": "{ elements = 10, instants = 11, substructures = 2 }",
    "controls": '["peak"]',
    "views": '["Friction force"]',
    "instant": "0.75",
    "text": '"One {value:error_force@3} and\\n\\ntwo."',
    "explanation": '"Move {control:peak}."',
}
CLAIM: dict[str, str] = {
    "claim": '"It ends."',
    "settings": "{ peak = 600 }",
    "quantity": '"iterations"',
    "expected": "[1, 100]",
}


def written(parts: dict[str, str | None], claim: dict[str, str | None]) -> str:
    """A small lesson with some parts changed, or left out where they are None."""
    lines = [
        f"{key} = {value}"
        for key, value in (PARTS | parts).items()
        if value is not None
    ]
    own = [
        f"{key} = {value}"
        for key, value in (CLAIM | claim).items()
        if value is not None
    ]
    return "\n".join([*lines, "[[checkpoints]]", *own, ""])


def lesson(folder: Path, **parts: str | None) -> Path:
    path = folder / "small.toml"
    path.write_text(written(parts, {}), encoding="utf-8")
    return path


def refusal(folder: Path, text: str) -> str:
    path = folder / "small.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SettingError) as refused:
        lesson_from_file(path)
    return str(refused.value)


def test_a_lesson_is_what_its_file_says(tmp_path: Path) -> None:
    found = lesson_from_file(lesson(tmp_path))
    assert (found.name, found.order, found.right) == ("small", 1, 1)
    assert found.settings.values()["elements"] == 10
    assert found.text == ("One {value:error_force@3} and", "two.")
    assert (found.instant, found.interface) == (0.75, "")
    (one,) = found.checkpoints
    assert one.settings.values() == {**found.settings.values(), "peak": 600.0}


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("colour", '"red"', ['colour = "red"', "title, order", "no such key"]),
        ("why", None, ["why = null", "this key is needed"]),
        ("order", '"first"', ['order = "first"', "a whole number"]),
        ("subject", '"music"', ['subject = "music"', "mechanics, method"]),
        ("choices", '["this"]', ["right = 2", "at least two choices"]),
        ("right", "3", ["right = 3", "there are 2"]),
        ("scene", '"moon"', ['scene = "moon"', "bar, block"]),
        ("settings", "{ peek = 3 }", ["settings: peek = 3", "did you mean peak ("]),
        ("controls", '["k"]', ['controls = "k"', "k_scale"]),
        ("controls", '["seed"]', ['controls = "seed"', "does something"]),
        ("controls", '["peak", "friction", "pressure"]', ["at most 2 settings"]),
        ("instant", "1.5", ["instant = 1.5", "from 0 to 1"]),
        ("draw", '"peak"', ['draw = "peak"', "3 checkpoints"]),
        (
            "text",
            '"{control:friction}"',
            ["text: placeholder", "{control:peak}, {value:"],
        ),
        ("text", '"{value:luck}"', ['quantity = "luck"', "iterations, seconds"]),
        (
            "explanation",
            '"{value:indicator@x}"',
            ["explanation: quantity", "indicator@ and"],
        ),
    ],
)
def test_errors_in_a_lesson_are_reported_with_file_key_value_and_allowed_values(
    tmp_path: Path, key: str, value: str | None, words: list[str]
) -> None:
    said = refusal(tmp_path, written({key: value}, {}))
    assert said.startswith("small.toml: ")
    assert "\n" not in said
    assert not [word for word in words if word not in said], said


@pytest.mark.parametrize(
    ("claim", "words"),
    [
        ({"because": '"so"'}, ["checkpoint 1: because", "claim, settings, quantity"]),
        ({"settings": "{ elements = 0 }"}, ["checkpoint 1: elements = 0"]),
        ({"quantity": '"iterations_to_force"'}, ["iterations_to_force@ and a number"]),
        ({"expected": "3"}, ["expected = 3", "beside a number"]),
        ({"expected": "[3, 2]"}, ["expected = [3, 2]", "[low, high]"]),
        ({"expected": '"ever"'}, ['expected = "ever"', '"never"']),
        ({"expected": "3", "tolerance": "-1"}, ["tolerance = -1"]),
    ],
)
def test_errors_in_a_checkpoint_are_reported_with_its_number(
    tmp_path: Path, claim: dict[str, str | None], words: list[str]
) -> None:
    said = refusal(tmp_path, written({}, claim))
    assert said.startswith("small.toml: checkpoint 1: ")
    assert not [word for word in words if word not in said], said


def test_files_without_a_lesson_are_refused_in_a_line(tmp_path: Path) -> None:
    assert "small.toml: lesson" in refusal(tmp_path, "no TOML")
    claims_nothing = written({}, {}).partition("[[")[0] + "checkpoints = []"
    assert "checkpoints = []" in refusal(tmp_path, claims_nothing)
    with pytest.raises(SettingError, match="a file that can be read"):
        lesson_from_file(tmp_path / "none.toml")


def run(
    folder: Path, capsys: pytest.CaptureFixture[str], **claim: Any
) -> tuple[int, str, str]:
    path = folder / "small.toml"
    path.write_text(written({}, claim), encoding="utf-8")
    code = main(["lesson", str(path)])
    return (code, *capsys.readouterr())


def test_the_command_prints_what_it_measures_and_says_whether_all_holds(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code, printed, _ = run(tmp_path, capsys)
    assert code == 0
    assert printed.splitlines()[0] == "small: A title"
    assert printed.splitlines()[1].startswith("  + It ends. Iterations: ")
    code, printed, _ = run(tmp_path, capsys, expected='"never"')
    assert code == 1
    assert printed.splitlines()[1].startswith("  - It ends.")
    assert printed.endswith("expected never\n")


def test_the_command_refuses_what_is_no_lesson_and_runs_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    good = lesson(tmp_path)
    bad = tmp_path / "bad.toml"
    bad.write_text("title = 3", encoding="utf-8")
    assert main(["lesson", str(good), str(bad)]) == 2
    printed, said = capsys.readouterr()
    assert printed == ""
    assert said.startswith("slipfront: bad.toml: title = 3 is refused")
    assert said.count("\n") == 1


CHECKPOINTS = []
for title, taught in LESSONS.items():
    CHECKPOINTS += [
        pytest.param(title, number, id=f"{title}: {checkpoint.claim}")
        for number, checkpoint in enumerate(taught.checkpoints)
    ]
each = pytest.mark.parametrize("lesson", LESSONS.values(), ids=list(LESSONS))


@functools.cache
def outcomes(name: str) -> list[tuple[bool, str]]:
    """Outcomes of all claims of a lesson at once, since they share runs."""
    return list(check(LESSONS[name]))


@pytest.mark.parametrize(("name", "number"), CHECKPOINTS)
def test_claims_of_lessons_hold_in_runs(name: str, number: int) -> None:
    holds, line = outcomes(name)[number]
    assert holds, line


@each
def test_plots_and_controls_of_a_lesson_exist_and_its_answer_is_hidden_first(
    lesson: Lesson,
) -> None:
    assert {lesson.interface} <= {"", *discretise(lesson.settings).contacts}
    kinds = chain.from_iterable(CARDS)
    shown = {kind.name for kind in kinds if kind.applies(lesson.settings)}
    assert set(lesson.views) <= shown
    before = " ".join(lesson.text)
    after = " ".join(lesson.explanation)
    assert "{control:" not in before
    assert set(re.findall(r"\{control:(.*?)\}", after)) == set(lesson.controls)
    assert "{value:" in after
