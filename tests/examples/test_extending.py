"""Steps of `solver/EXTENDING.md`, followed to the letter, have what it promises."""

from __future__ import annotations

import math
import re
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.frame import Selection
from app.messages import Needs, Start
from app.state import PageState, default_settings
from app.worker.references import ReferenceCache
from app.worker.runner import Runner
from solver import solve
from solver.commands.cli import main
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.definitions import LOAD
from solver.study.quantities import cycles
from solver.study.quantities.quantity import quantity
from solver.study.scene_run import finished_run

PAGE = Path(__file__).resolve().parents[2] / "solver" / "EXTENDING.md"
KINDS = (
    "setting",
    "scene",
    "structure",
    "quantity",
    "law",
    "view",
    "lesson",
    "case",
)
PAGES = dict(
    zip(
        KINDS,
        re.split(r"^## An? \w+$", PAGE.read_text("utf-8"), flags=re.MULTILINE)[1:],
        strict=True,
    )
)


def blocks(kind: str) -> list[str]:
    """Programs and files on the page of a kind."""
    found: list[str] = re.findall(r"^```\w+\n(.*?)^```", PAGES[kind], re.M | re.S)
    return found


def test_a_setting_needs_its_definition_and_its_use() -> None:
    definition, use = blocks("setting")
    known = {"LOAD": LOAD}
    kind = CATALOGUE["incline"]
    exec(f"class With(kind):\n{definition}", known | {"kind": kind}, known)
    settings: Any = known["With"].checked({"buoyancy": 0.5})  # type: ignore[attr-defined]
    assert settings.buoyancy == 0.5
    assert "share of the weight" in settings.definitions()["buoyancy"].doc.lower()
    exec(f"if True:\n{use}", {"self": settings}, known)
    density = settings.weight / (settings.length * settings.height)
    assert known["density"] == pytest.approx(0.5 * density)


def test_a_scene_is_solved_as_its_closed_form_has_it() -> None:
    (program,) = blocks("scene")
    known: dict[str, Any] = {"__name__": "anchor"}
    exec(compile(program, "anchor", "exec", dont_inherit=True), known)
    kind = known["AnchorSettings"]
    settings = kind.checked({"elements": 100, "substructures": 5, "load": "ramp"})
    run = solve(discretise(settings), method_of(settings), watch=False)
    assert run.is_certified
    strength = settings.friction * settings.pressure
    exact = settings.peak**2 / (2.0 * settings.young * settings.section * strength)
    assert run.iterate.displacement[-1, -1] == pytest.approx(exact, rel=1e-6)
    assert kind.checked(kind.SMALL).elements == 20
    assert "pulled" in settings.sentence()


def test_a_structure_is_bodies_and_their_joints(
    capsys: pytest.CaptureFixture[str],
) -> None:
    (program,) = blocks("structure")
    exec(compile(program, "wedge", "exec", dont_inherit=True), {"__name__": "wedge"})
    ending, friction = capsys.readouterr().out.split()
    assert ending == "converged"
    assert float(friction) == pytest.approx(1e3 * math.sin(0.3), rel=1e-6)


def test_a_quantity_is_a_function_of_a_run() -> None:
    (program,) = blocks("quantity")
    known: dict[str, Any] = {
        "quantity": quantity,
        "math": math,
        "np": np,
        "FinishedRun": object,
    }
    exec(program, known | {"slips_of": cycles.slips_of}, known)
    found = known["friction_power"]
    settings = CATALOGUE["bar"].checked({"load": "ramp", "elements": 100})
    run = finished_run(settings)
    strength: Any = settings.values()["friction"] * settings.values()["pressure"]
    values = settings.values()
    stiffness = values["young"] * values["section"]
    # The energy F^3 / (6 E S q) grows as time to the third power, F = peak t.
    steps = run.problem.instants[-2:]
    energy = (values["peak"] * steps) ** 3 / (6.0 * stiffness * strength)
    expected = np.diff(energy) / np.diff(steps)
    assert found(run) == pytest.approx(float(expected[0]), rel=0.02)
    assert (found.name, found.unit) == ("friction_power", "W")
    assert math.isnan(found(finished_run(settings.replace(instants=1))))


def test_a_law_is_a_local_stage(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (program,) = blocks("law")
    file = tmp_path / "law.py"
    file.write_text(program, encoding="utf-8")
    runpy.run_path(str(file))
    ending, moved = capsys.readouterr().out.split()
    assert ending == "converged"
    assert float(moved) == pytest.approx(4.5e-4, rel=0.01)


def test_a_view_is_a_figure_and_its_filling() -> None:
    (program,) = blocks("view")
    known: dict[str, Any] = {}
    exec(compile(program, "view", "exec", dont_inherit=True), known)
    settings = default_settings("bar").replace(elements=20, max_iterations=6)
    runner = Runner(Start(1, settings, math.inf), ReferenceCache(), lambda: False)
    runner.advance()
    frame = runner.frame(Needs())
    state = PageState(settings)
    view = known["LoadPath"](state)
    assert view.figure is not None
    state.newest = state.frame = frame
    view.update(frame, Selection(), None)
    drawn = view.sources["force"].data
    assert len(drawn["y"]) == len(frame.run.instants)
    assert max(drawn["y"]) == pytest.approx(settings.peak, rel=1e-3)


@pytest.mark.parametrize(("kind", "command"), [("lesson", "lesson"), ("case", "proof")])
def test_lessons_and_cases_hold(kind: str, command: str, tmp_path: Path) -> None:
    (text,) = blocks(kind)
    file = tmp_path / "mine.toml"
    file.write_text(text, encoding="utf-8")
    options = []
    if command == "proof":
        options = ["--out", str(tmp_path / "proof")]
    assert main([command, str(file), *options]) == 0
