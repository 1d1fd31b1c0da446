"""Scripts in `solver/examples` run, and what they print is known physics."""

from __future__ import annotations

import io
import os
import re
import runpy
import subprocess
import sys
from contextlib import chdir, redirect_stdout
from pathlib import Path

import pytest

from solver.commands.cli import main

SCRIPTS = Path(__file__).resolve().parents[2] / "solver" / "examples"
NAMES = sorted(path.stem for path in SCRIPTS.glob("*.py"))


def printed(name: str, folder: Path) -> dict[str, str]:
    """Lines that a script prints, by what stands before their colon.

    A process of its own would import for a second what this one has.
    """
    with redirect_stdout(io.StringIO()) as output, chdir(folder):
        runpy.run_path(str(SCRIPTS / f"{name}.py"), run_name="__main__")
    return by_name(output.getvalue())


def by_name(output: str) -> dict[str, str]:
    """Lines of an output by what stands before their colon."""
    lines = [line.partition(": ") for line in output.splitlines()]
    return {before: behind for before, _, behind in lines}


def printed_by_itself(name: str, folder: Path) -> dict[str, str]:
    """Lines that a script prints as a program, where it has processes."""
    done = subprocess.run(
        [sys.executable, SCRIPTS / f"{name}.py"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(SCRIPTS.parents[1])},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return by_name(done.stdout)


def test_waves_touch_at_their_crests_first_and_carry_at_most_friction(
    tmp_path: Path,
) -> None:
    lines = printed("waves", tmp_path)
    assert lines["status"] == "converged"
    assert 0.0 < float(lines["largest shear over friction"]) <= 1.0
    assert float(lines["share that is open at 0.025 s"]) > 0.5
    assert float(lines["share that is open at 0.25 s"]) == 0.0


def test_two_bricks_slide_at_what_friction_carries(tmp_path: Path) -> None:
    lines = printed("two_bricks", tmp_path)
    assert lines["certified"] == "True"
    ratio = float(lines["shear over mu p b at the end"])
    assert ratio == pytest.approx(1.0, rel=1e-9)


def test_a_broken_wire_regains_its_force_as_the_closed_form_has_it(
    tmp_path: Path,
) -> None:
    lines = printed("broken_wire", tmp_path)
    assert lines["status"] == "converged"
    assert float(lines["largest distance over the tension"]) < 1e-9


def test_a_law_of_ones_own_is_solved_and_has_no_reference(tmp_path: Path) -> None:
    lines = printed("viscous_law", tmp_path)
    assert lines["status"] == "converged"
    assert lines["certified"] == "False"
    assert "there is no reference" in lines["reference"]
    assert float(lines["distance over largest"]) < 1e-3


def test_methods_of_other_parts_come_to_one_solution(tmp_path: Path) -> None:
    lines = printed("method_of_parts", tmp_path)
    counts = {}
    for name, line in lines.items():
        found = re.fullmatch(r"converged in (\d+) iterations; ratio .*: (.*)", line)
        assert found is not None, line
        counts[name] = int(found[1])
        assert float(found[2]) == pytest.approx(1.0, abs=0.02)
    assert list(counts) == ["paper", "accelerated", "on modes", "status step"]
    assert counts["status step"] < counts["accelerated"] < counts["paper"]


def test_energy_grows_with_the_third_power_of_the_load(tmp_path: Path) -> None:
    lines = printed_by_itself("sweep_on_a_pool", tmp_path)
    assert float(lines["power"]) == pytest.approx(3.0, abs=0.01)
    assert float(lines["largest over closed form"]) == pytest.approx(1.0, abs=1e-3)


def test_a_fit_finds_the_friction_of_the_rig(tmp_path: Path) -> None:
    lines = printed("fit_from_a_file", tmp_path)
    friction, known = map(float, lines["friction"].split(" known: "))
    assert friction == pytest.approx(known, rel=1e-4)
    lower, upper = map(float, lines["margins"].split(" to "))
    assert lower < known < upper


def test_a_page_comes_to_the_closed_form(tmp_path: Path) -> None:
    lines = printed("page", tmp_path)
    assert float(lines["ratio to exact"]) == pytest.approx(1.0, abs=1e-3)


def test_every_script_has_a_test_here() -> None:
    text = Path(__file__).read_text(encoding="utf-8")
    assert set(NAMES) == set(re.findall(r'printed\w*\("(\w+)"', text))


def test_the_command_lists_examples_and_writes_one_but_over_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["example"]) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == NAMES
    assert main(["example", "waves"]) == 0
    written = tmp_path / "waves.py"
    assert written.read_bytes() == (SCRIPTS / "waves.py").read_bytes()
    written.write_text("mine")
    assert main(["example", "waves"]) == 2
    assert "waves.py" in capsys.readouterr().err
    assert written.read_text() == "mine"
    assert main(["example", "particles"]) == 2
    assert ", ".join(NAMES) in capsys.readouterr().err
