"""Time and memory of a run are estimated from counts, and said before it begins."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from solver.cli import main
from solver.latin import run_cost as costs
from solver.latin.run_cost import LARGE, LONG, RunCost, run_cost
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.study.other_programs import fclib

LONG_ONES: dict[str, dict[str, Any]] = {
    "strand": {"wires": 200},
    "layers": {"layers": 50},
    "bar": {"elements": 16_000, "instants": 1500},
}


def cost(scene: str, *, with_reference: bool = True, **values: Any) -> RunCost:
    settings = CATALOGUE[scene].settings.checked(values)
    most = settings.max_iterations
    return run_cost(discretise(settings), method_of(settings), most, with_reference=with_reference)


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_the_scenes_defaults_are_neither_long_nor_large(scene: str) -> None:
    found = cost(scene)
    assert 0.0 < found.seconds < 0.1 * LONG
    assert 0.0 < found.memory < 0.1 * LARGE


@pytest.mark.parametrize("scene", list(LONG_ONES))
def test_what_takes_minutes_or_gigabytes_is_told(scene: str) -> None:
    assert cost(scene, **LONG_ONES[scene]).is_large


@pytest.mark.parametrize(
    ("scene", "name", "sizes"),
    [
        ("bar", "elements", (50, 400, 3200)),
        ("bar", "instants", (51, 401, 3201)),
        ("strand", "wires", (3, 9, 27)),
        ("layers", "layers", (4, 8, 16)),
        ("block", "elements", (24, 48, 96)),
    ],
)
def test_more_of_anything_takes_more(scene: str, name: str, sizes: tuple[int, ...]) -> None:
    found = [cost(scene, **{name: size}) for size in sizes]
    assert found[0].seconds < found[1].seconds < found[2].seconds
    assert found[0].memory < found[1].memory < found[2].memory


def test_without_a_reference_only_its_share_is_left_out() -> None:
    whole, alone = (cost("layers", layers=20, with_reference=one) for one in (True, False))
    assert alone.reference == 0.0 < whole.reference
    assert whole.seconds == pytest.approx(alone.seconds + whole.reference)


def test_the_command_says_that_its_limit_comes_first(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(costs, "LONG", 0.0)
    small = ["--set", "elements=24", "--set", "instants=5", "--no-reference"]
    main(["run", "layers", *small, "--limit", "1e-3"])
    assert "; --limit ends it after 0.001 s" in capsys.readouterr().err
    main(["run", "layers", *small, "--limit", "1000"])
    assert "--limit" not in capsys.readouterr().err


@pytest.mark.parametrize("options", [[], ["--no-reference"]])
def test_the_command_says_it_in_one_line(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, options: list[str]
) -> None:
    monkeypatch.setattr(costs, "LONG", 0.0)
    small = ["--set", "layers=3", "--set", "elements=24", "--set", "instants=5"]
    assert main(["run", "layers", *small, *options]) in (0, 1)
    line = capsys.readouterr().err
    assert line.startswith("slipfront: this will take about ")
    assert line.count("\n") == 1


@pytest.mark.parametrize("command", ["compare", "fclib"])
def test_commands_that_run_a_scene_for_others_say_it_too(
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    command: str,
) -> None:
    monkeypatch.setattr(costs, "LONG", 0.0)
    monkeypatch.setattr(fclib, "can_write", lambda: True)
    theirs = tmp_path / "theirs.csv"
    theirs.write_text("x,t,friction force\n" + "0.01,0.5,1\n" * 4)
    scene, *options = {
        "compare": ("bar", "--with", str(theirs)),
        "fclib": ("incline", "--out", str(tmp_path / "one.hdf5")),
    }[command]
    main([command, scene, *options, "--set", "pgd_modes=3"])
    lines = capsys.readouterr().err.splitlines()
    assert any("pgd_modes does nothing" in line for line in lines)
    assert any(line.startswith("slipfront: this will take about ") for line in lines)


def test_the_command_says_what_no_reference_would_save(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(costs, "LONG", 0.0)
    monkeypatch.setattr(costs, "BEGINNING", 0.0)
    values = ["--set", "elements=96", "--set", "instants=5", "--set", "max_iterations=1"]
    main(["run", "layers", *values])
    assert "for the reference, which --no-reference leaves out" in capsys.readouterr().err


def test_times_are_written_with_the_one_digit_that_they_have() -> None:
    texts = [str(RunCost(seconds, 2.34e9, 0.0)) for seconds in (4.4, 34.0, 81.0, 99.0, 7400.0)]
    assert texts == [
        "4 s and 2 GB",
        "30 s and 2 GB",
        "80 s and 2 GB",
        "2 min and 2 GB",
        "2 h and 2 GB",
    ]
