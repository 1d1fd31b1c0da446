"""The command line runs and lists as its contract says."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from bars import SMALL_BAR as SMALL

from app.link import read
from solver.checked import dump
from solver.cli import main
from solver.definitions import SettingError, about, allowed
from solver.files import settings_from_toml
from solver.scenes import CATALOGUE
from solver.scenes.bar import BarSettings

ROOT = Path(__file__).resolve().parents[1]
PAPER = ["--set", "method=paper"]
FIGURES = ["scene", "status", "advice", "iterations", "indicator", "behaviour"]
FIGURES += ["estimated_error", "certified", "residual"]
FIGURES += ["error_displacement", "error_force", "seconds"]


def printed_figures(text):
    return dict(line.split(maxsplit=1) for line in text.splitlines())


def test_run_prints_the_key_figures_and_exits_0_when_converged(capsys):
    assert main(["run", "bar", *SMALL]) == 0
    out, err = capsys.readouterr()
    figures = printed_figures(out)
    assert list(figures) == FIGURES
    assert (figures["scene"], figures["status"]) == ("bar", "converged")
    assert int(figures["iterations"]) > 1
    assert figures["certified"] == "True"
    assert 0.0 < float(figures["residual"]) < 1e-8
    assert float(figures["estimated_error"]) == float(figures["residual"])
    assert float(figures["error_displacement"]) < 1e-9
    assert float(figures["error_force"]) < 1e-9
    assert float(figures["seconds"]) > 0.0
    assert err == ""


def test_the_papers_method_ends_where_its_indicator_says_and_gives_no_certificate(capsys):
    assert main(["run", "bar", *SMALL, *PAPER]) == 0
    figures = printed_figures(capsys.readouterr().out)
    assert list(figures) == FIGURES
    assert (figures["status"], figures["certified"]) == ("converged", "False")
    assert figures["residual"] == "None"
    assert 0.0 < float(figures["indicator"]) <= 1e-10
    assert 0.0 < float(figures["error_displacement"]) < 1e-3
    assert 0.0 < float(figures["error_force"]) < 1e-2
    assert float(figures["estimated_error"]) <= 1e-2


def test_run_exits_1_when_it_stops_otherwise(capsys):
    assert main(["run", "bar", *SMALL, *PAPER, "--set", "max_iterations=4"]) == 1
    figures = printed_figures(capsys.readouterr().out)
    assert (figures["status"], figures["iterations"]) == ("exhausted", "4")
    assert "max_iterations" in figures["advice"]


def test_json_is_strict_and_says_the_same_as_the_text(capsys):
    command = ["run", "bar", *SMALL, *PAPER, "--set", "tolerance=1e-6"]
    main(command)
    figures = printed_figures(capsys.readouterr().out)
    assert main([*command, "--json"]) == 0

    def refuse(word):
        raise AssertionError(f"{word} is no JSON")

    found = json.loads(capsys.readouterr().out, parse_constant=refuse)
    assert list(found) == [*FIGURES[:3], "remarks", *FIGURES[3:], "tables", "settings"]
    assert found["remarks"] == []
    assert found["iterations"] == int(figures["iterations"])
    assert found["indicator"] == pytest.approx(float(figures["indicator"]), rel=1e-5)
    assert (found["certified"], found["residual"]) == (False, None)
    assert BarSettings.checked(found["settings"]).tolerance == 1e-6


def test_scenes_lists_all_scenes_with_their_source(capsys):
    assert main(["scenes"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(CATALOGUE)
    for line, (name, entry) in zip(lines, CATALOGUE.items(), strict=True):
        assert line.startswith(name)
        assert entry.title in line
        assert entry.source in line


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_settings_lists_all_settings_with_unit_bounds_default_and_help(capsys, scene):
    assert main(["settings", scene]) == 0
    lines = capsys.readouterr().out.splitlines()
    kind = CATALOGUE[scene].settings
    definitions, paper = kind.definitions(), kind.of_method("paper")
    assert len(lines) == 2 * len(definitions)
    for head, text, (name, definition) in zip(
        lines[::2], lines[1::2], definitions.items(), strict=True
    ):
        assert head.split()[0] == name
        assert head.split()[1] == (about(definition).unit or "-")
        assert f"default {json.dumps(definition.default)}" in head
        differs = paper.get(name, definition.default) != definition.default
        assert (f"(method=paper: {json.dumps(paper.get(name))})" in head) == differs
        assert head.endswith(allowed(definition))
        assert text.strip() == definition.doc


def test_a_file_saved_by_one_front_is_run_by_the_other(tmp_path, capsys):
    place, _ = read(
        "?elements=12&instants=11&substructures=3&load=[[0,0],[1,700]]&friction_profile=rising"
    )
    chosen = place.settings
    saved = tmp_path / "slipfront.toml"
    saved.write_text(dump(chosen), encoding="utf-8")
    assert main(["run", str(saved), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert BarSettings.checked(found["settings"]).values() == chosen.values()
    again = settings_from_toml(saved.read_text(encoding="utf-8"))
    assert again.values() == chosen.values()


@pytest.mark.parametrize("kind", ["table", "settings", "lesson"])
def test_a_file_without_an_end_is_read_no_further_than_any_may_be_long(kind, capsys, tmp_path):
    endless = tmp_path / "endless.toml"
    endless.symlink_to("/dev/zero")
    command = {
        "table": ["run", "bar", "--set", f"load={endless}"],
        "settings": ["run", str(endless)],
        "lesson": ["lesson", str(endless)],
    }[kind]
    assert main(command) == 2
    assert "more than 4 MB" in capsys.readouterr().err
    with pytest.raises(SettingError, match="more than 4 MB"):
        settings_from_toml("#" * 5_000_000)


def test_a_reference_that_is_not_wanted_or_too_large_is_left_out(capsys, monkeypatch):
    assert main(["run", "bar", *SMALL, "--no-reference", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["error_force"] is None
    monkeypatch.setattr("solver.reference.contact.MOST_JUMPS", 100)
    many = ["wires=5", "elements=50", "instants=2", "max_iterations=1"]
    changes = [text for assignment in many for text in ("--set", assignment)]
    assert main(["run", "strand", *changes, "--json"]) == 1
    printed = capsys.readouterr()
    assert json.loads(printed.out)["error_force"] is None
    assert "at most 100" in printed.err
    assert main(["study", "strand", *changes]) == 2
    assert "nothing to compare with" in capsys.readouterr().err


def test_the_module_runs_as_a_program(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "solver", "run", "bar", "--json", "--out", tmp_path / "bar.npz"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["status"] == "converged"
    assert (tmp_path / "bar.npz").is_file()


@pytest.mark.parametrize(
    ("trouble", "code", "message"),
    [
        (MemoryError(), 3, "a coarser mesh"),
        (RuntimeError("SUPERLU_MALLOC fails for buf in intCalloc()"), 3, "a coarser mesh"),
        (KeyboardInterrupt(), 130, "ended"),
    ],
)
def test_what_ends_a_command_from_outside_takes_a_line_and_has_its_code(
    trouble, code, message, monkeypatch, capsys
):
    def fail(*given, **options):
        raise trouble

    monkeypatch.setattr("solver.cli.solve", fail)
    assert main(["run", "bar", *SMALL]) == code
    (line,) = capsys.readouterr().err.splitlines()
    assert message in line
    said = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    assert re.search(rf"Exit code 0: converged;.* {code}: ", said)


def test_a_fault_of_the_engine_is_no_lack_of_memory(monkeypatch):
    def fail(*given, **options):
        raise RuntimeError("of another kind")

    monkeypatch.setattr("solver.cli.solve", fail)
    with pytest.raises(RuntimeError, match="of another kind"):
        main(["run", "bar", *SMALL])
