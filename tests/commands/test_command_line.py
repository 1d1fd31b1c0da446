"""The command line runs, lists, writes and refuses as its contract says."""

from __future__ import annotations

import errno
import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from bars import SMALL_BAR as SMALL

from solver.commands.cli import main
from solver.files.saved import settings_from_toml
from solver.scenes import CATALOGUE
from solver.scenes.bar import BarSettings
from solver.settings.definitions import CurveParameter, help_of, properties_of
from solver.settings.load_paths import DECAY, PRESETS, PULLS
from solver.settings.values import SettingError, allowed

ROOT = Path(__file__).resolve().parents[2]
PAPER = ["--set", "method=paper"]
FIGURES = ["scene", "status", "advice", "iterations", "indicator", "behaviour"]
FIGURES += ["estimated_error", "certified", "residual"]
FIGURES += ["error_displacement", "error_force", "seconds"]
FIGURES += ["displacement", "force", "slipped_share", "dissipation"]


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


def test_the_version_is_that_of_the_package(capsys):
    with pytest.raises(SystemExit) as end:
        main(["--version"])
    assert end.value.code == 0
    package = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert capsys.readouterr().out == f"slipfront {package['version']}\n"


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
    more = ["key_figures", "tables", "settings"]
    assert list(found) == [*FIGURES[:3], "remarks", *FIGURES[3:], *more]
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
    kind = CATALOGUE[scene]
    definitions = kind.definitions()
    paper = kind.of_method("paper")
    rest = iter(lines)
    for name, definition in definitions.items():
        head = next(rest)
        text = next(rest)
        assert head.split()[0] == name
        assert head.split()[1] == (properties_of(definition).unit or "-")
        assert f"default {json.dumps(definition.default)}" in head
        differs = paper.get(name, definition.default) != definition.default
        assert (f"(method=paper: {json.dumps(paper.get(name))})" in head) == differs
        assert head.endswith(allowed(definition))
        assert text.strip() == definition.doc
        for preset, line in properties_of(definition).presets.items():
            assert next(rest).strip() == f"{preset or 'nothing'}: {line}"
    assert next(rest, None) is None


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_every_preset_of_a_path_or_a_table_has_a_line_of_its_own(scene):
    for name, definition in CATALOGUE[scene].definitions().items():
        lines = properties_of(definition).presets
        if isinstance(definition, CurveParameter):
            assert list(lines) == list(definition.presets)
            assert len(set(lines.values())) == len(lines)
        elif name.endswith("_load"):
            assert list(lines) == list(definition.objects)
        for preset, line in lines.items():
            assert 5 < len(line) < 140
            assert "\n" not in line
            assert not line.endswith(".")
            assert f"{preset or 'nothing'}: {line}." in help_of(definition)


@pytest.mark.parametrize(
    ("presets", "name", "numbers"),
    [
        (PRESETS, "decaying", DECAY),
        (PULLS, "decaying", 0.5 + 0.5 * DECAY[:-1]),
    ],
)
def test_numbers_in_the_line_on_a_preset_are_those_of_its_path(presets, name, numbers):
    said = [
        float(number) for number in re.findall(r"-?\d\.?\d*", presets[name].description)
    ]
    assert said[: len(numbers)] == pytest.approx(numbers)
    assert presets[name].points(0)[0][-1] == 1.0


@pytest.mark.parametrize("kind", ["table", "settings", "lesson"])
def test_a_long_file_is_read_no_further_than_any_may_be_long(kind, capsys, tmp_path):
    long = tmp_path / "long.toml"
    endless = tmp_path / "endless.toml"
    with long.open("wb") as file:
        file.truncate(2_000_000_000)
    endless.symlink_to("/dev/zero")
    for path, why in ((long, "more than 4 MB"), (endless, "it is a pipe or a device")):
        command = {
            "table": ["run", "bar", "--set", f"load={path}"],
            "settings": ["run", str(path)],
            "lesson": ["lesson", str(path)],
        }[kind]
        assert main(command) == 2
        assert why in capsys.readouterr().err
    with pytest.raises(SettingError, match="more than 4 MB"):
        settings_from_toml("#" * 5_000_000)


def test_a_reference_that_is_not_wanted_or_too_large_is_left_out(
    capsys, monkeypatch, tmp_path
):
    assert main(["run", "bar", *SMALL, "--no-reference", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["error_force"] is None
    monkeypatch.setattr("solver.reference.contact.MOST_JUMPS", 100)
    many = ["wires=5", "elements=50", "instants=2", "max_iterations=1"]
    changes = [f"--set={assignment}" for assignment in many]
    assert main(["run", "strand", *changes, "--json"]) == 1
    printed = capsys.readouterr()
    assert json.loads(printed.out)["error_force"] is None
    assert "at most 100" in printed.err
    monkeypatch.chdir(tmp_path)
    assert main(["study", "strand", *changes]) == 2
    assert "nothing to compare with" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("trouble", "code", "message"),
    [
        (MemoryError(), 3, "a coarser mesh"),
        (KeyboardInterrupt(), 130, "ended"),
    ],
)
def test_interrupts_end_a_command_with_a_line_and_their_code(
    trouble, code, message, monkeypatch, capsys
):
    def fail(*given, **options):
        raise trouble

    monkeypatch.setattr("solver.commands.single_run.solve", fail)
    assert main(["run", "bar", *SMALL]) == code
    (line,) = capsys.readouterr().err.splitlines()
    assert message in line


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["stability", "--random", "few"], '--random = "few" is refused'),
        (["stability", "--random", "1", "--seed", "1e400"], '--seed = "1e400" is'),
        (["stability", "--seed", "-1"], '--seed = "-1" is refused'),
        (["study", "bar", "--repeats", "1.5"], "write a whole number"),
        (["sweep", "bar", "--of", "force", "--limit", "x"], "seconds above 0"),
        (["sweep", "bar", "--of", "force", "--vary", "elements=2.5:9:3"], "two ends"),
        (["mesh", "bar", "--of", "seconds"], "peak_displacement, displacement, force,"),
        (["compare", "bar", "--with", "loop.csv", "--interface", "x"], "--interface"),
    ],
    ids=lambda case: " ".join(case),
)
def test_foolish_options_are_refused_by_name(
    tmp_path, monkeypatch, capsys, arguments, words
):
    monkeypatch.chdir(tmp_path)
    rows = [f"{1e-4 * row},{90.0 * row}" for row in range(8)]
    loop = "\n".join(["displacement,force", *rows])
    (tmp_path / "loop.csv").write_text(loop, encoding="utf-8")
    assert main(arguments) == 2
    message = capsys.readouterr().err.splitlines()[-1]
    assert words in message
    assert "; allowed: " in message


def test_what_never_comes_is_told_from_what_a_run_does_not_have(capsys):
    """A bar on strong ground never slips as a whole, and has no thrust."""
    names = "first_slip_time@1,thrust,force"
    command = ["run", "bar", *SMALL, "--no-reference", "--of", names]
    assert main([*command, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    never = "first_slip_time@1.0"
    assert (found["quantities"][never], found["quantities"]["thrust"]) == (None, None)
    assert found["quantities"]["force"] > 0.0
    assert found["never"] == [never]
    assert main(command) == 0
    figures = printed_figures(capsys.readouterr().out)
    assert figures[never] == "never"
    assert figures["thrust"] == "none"


def test_a_limit_is_read_as_a_setting_is(capsys):
    command = ["run", "bar", *SMALL, "--no-reference", "--slab", "41."]
    assert main([*command, "--limit", "2 min"]) == 0
    capsys.readouterr()
    assert main([*command, "--limit", "1e-6 ms"]) == 1


def test_a_closed_output_is_told_in_a_line():
    command = f"{sys.executable} -m solver run bar --set peak=0 >&-"
    done = subprocess.run(
        ["sh", "-c", command], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 2
    assert (
        done.stderr == "slipfront: nothing can be printed: standard output is closed\n"
    )


def test_a_fault_of_the_engine_is_no_lack_of_memory(monkeypatch):
    def fail(*given, **options):
        raise RuntimeError("of another kind")

    monkeypatch.setattr("solver.commands.single_run.solve", fail)
    with pytest.raises(RuntimeError, match="of another kind"):
        main(["run", "bar", *SMALL])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            ["bar", "--set", "friktion=0.3"],
            ["friktion", "0.3", "did you mean friction (Coefficient"],
        ),
        (
            ["bar", "--set", "peak=much"],
            ["peak", "much", "any number (at most 1e15 N in size)"],
        ),
        (["bar", "--set", "elements=3"], ["substructures", "10", "1 to elements (3)"]),
        (["bar", "--set", "load=bad.csv"], ["load", "bad.csv", "line 2"]),
        (["bar", "--set", "peak"], ["--set", "NAME=VALUE"]),
        (["bar", "--set", "=1"], ["--set", "NAME=VALUE", "write a name"]),
        (["bar", "--set", "load=[[0,0],[.5,9]"], ["load", "close each bracket"]),
        (["bar", "--limit", "soon"], ["--limit", "soon", "seconds above 0"]),
        (["bar", "--limit", "2 m"], ["--limit", "2 m", "write a number in s"]),
        (["bar", "--slab", "1.5"], ["--slab", "1.5", "write a whole number"]),
        (["bar", "--out", "x.csv"], ["--out", "x.csv", "FILE.npz"]),
        (["bridge"], ["scene", "bridge", "bar"]),
        (["none.toml"], ["settings file", "none.toml"]),
        (
            ["bar", "--out", "nowhere/x.npz"],
            ["--out", "nowhere/x.npz", "existing folder"],
        ),
        (["bar", "--out", "."], ["--out", "existing folder"]),
    ],
    ids=lambda case: " ".join(case),
)
def test_refused_input_prints_one_line_exits_2_and_writes_nothing(
    tmp_path, monkeypatch, capsys, arguments, words
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.csv").write_text("0,0\n1,much\n", encoding="utf-8")
    before = sorted(tmp_path.iterdir())
    if "--out" in arguments:
        out = []
    else:
        out = ["--out", "result.npz"]
    assert main(["run", *arguments, *out]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert len(printed.err.splitlines()) == 1
    for word in words:
        assert word in printed.err
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("arguments", [[], ["walk"], ["run"], ["run", "bar", "--fast"]])
def test_a_command_that_does_not_exist_exits_2(arguments, capsys):
    with pytest.raises(SystemExit) as end:
        main(arguments)
    assert end.value.code == 2
    assert "usage: python -m solver" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("assignments", "words"),
    [
        (["linear_stage=pgd", "acceleration=anderson"], "acceleration does nothing"),
        (["load=[[0,0],[5,900]]"], "set duration=5"),
        (["load=[[0,0],[5,900]]", "duration=5"], ""),
        (["linear_stage=pgd", "method=paper"], ""),
    ],
)
def test_ignored_settings_are_reported(capsys, assignments, words):
    changes = [f"--set={assignment}" for assignment in assignments]
    main(["run", "bar", *SMALL, "--set", "max_iterations=2", *changes])
    printed = capsys.readouterr()
    assert words in printed.err
    assert bool(printed.err) == bool(words)
    assert "iterations" in printed.out


def test_a_structure_on_which_nothing_acts_is_said_to_be_idle(capsys):
    assert main(["run", "block", "--set", "top=traction", "--set", "instants=5"]) == 0
    assert "nothing acts on the structure" in capsys.readouterr().err


def test_the_result_file_holds_what_the_contract_names(tmp_path, capsys):
    file = tmp_path / "result.npz"
    assert main(["run", "bar", *SMALL, "--out", str(file), "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    with np.load(file, allow_pickle=False) as found:
        arrays = dict(found)
    points = 13
    iterations = printed["iterations"]
    instants = BarSettings.checked(printed["settings"]).n_instants
    assert instants >= 11
    shapes = {name: array.shape for name, array in arrays.items()}
    assert shapes == {
        "x": (points,),
        "t": (instants,),
        "displacement": (points, instants),
        "friction_force": (points, instants),
        "determinate": (points, instants),
        "status": (points, instants),
        "indicator": (iterations,),
        "behaviour": (iterations,),
        "estimated_error": (iterations,),
        "seconds": (iterations,),
        "error_displacement": (iterations,),
        "error_force": (iterations,),
        "certified": (),
        "residual": (),
        "settings": (),
    }
    np.testing.assert_allclose(arrays["x"], np.linspace(0.0, 1.0, points))
    np.testing.assert_allclose(arrays["t"], np.linspace(0.0, 1.0, instants))
    assert set(np.unique(arrays["status"])) == {-1, 0, 1}
    assert np.all(np.diff(arrays["seconds"]) > 0.0)
    for name in (
        "indicator",
        "estimated_error",
        "error_displacement",
        "error_force",
        "seconds",
    ):
        assert arrays[name][-1] == printed[name]
    assert arrays["determinate"].dtype == bool
    assert arrays["certified"] == printed["certified"]
    assert arrays["residual"] == printed["residual"]
    values = json.loads(str(arrays["settings"]))
    assert values.pop("scene") == "bar"
    assert BarSettings.checked(values).values() == printed["settings"]


def test_the_same_command_twice_gives_the_same_fields(tmp_path):
    fields = []
    for name in ("one.npz", "two.npz"):
        main(["run", "bar", *SMALL, "--out", str(tmp_path / name)])
        with np.load(tmp_path / name) as found:
            fields.append(
                [found[key] for key in ("displacement", "friction_force", "indicator")]
            )
    assert all(np.array_equal(one, two) for one, two in zip(*fields, strict=True))


def test_unwritable_targets_are_refused_before_the_run_and_unchanged(capsys, tmp_path):
    link = tmp_path / "link.npz"
    link.symlink_to("/dev/full")
    for place in ("/dev/full", str(link)):
        assert main(["run", "bar", *SMALL, "--out", place]) == 2
        printed = capsys.readouterr()
        assert printed.out == ""
        assert "--out" in printed.err
        assert len(printed.err.splitlines()) == 1
    assert Path("/dev/full").is_char_device()
    assert link.is_symlink()


def test_a_result_is_written_whole_or_not_at_all_before_anything_is_said(
    capsys, tmp_path, monkeypatch
):
    file = tmp_path / "result.npz"
    file.write_bytes(b"old")

    def breaks(out, **arrays):
        out.write(b"half")
        assert file.read_bytes() == b"old"
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(np, "savez_compressed", breaks)
    assert main(["run", "bar", *SMALL, "--out", str(file)]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "No space left" in printed.err
    assert len(printed.err.splitlines()) == 1
    assert [(one.name, one.read_bytes()) for one in tmp_path.iterdir()] == [
        (file.name, b"old")
    ]


def test_a_closed_pipe_loses_no_file(tmp_path):
    file = tmp_path / "bar.npz"
    reader, writer = os.pipe()
    os.close(reader)
    command = [
        sys.executable,
        "-m",
        "solver",
        "run",
        "bar",
        *SMALL,
        "--json",
        "--out",
        file,
    ]
    few = ["--set", "max_iterations=1", "--set", "finish=none"]
    done = subprocess.run(
        [*command, *few], cwd=ROOT, stdout=writer, stderr=subprocess.PIPE, check=False
    )
    os.close(writer)
    assert (done.returncode, done.stderr) == (1, b"")
    with np.load(file) as found:
        assert len(found["indicator"]) == 1


def test_a_run_prints_any_quantity_and_a_sweep_of_nothing_is_a_run(capsys, tmp_path):
    names = "end_displacement,dissipation,peak_stress,error_force"
    assert main(["run", "bar", *SMALL, "--of", names]) == 0
    printed = printed_figures(capsys.readouterr().out)
    assert printed["peak_stress"] == "none"
    assert printed["end_displacement"].endswith(" m")
    assert main(["run", "bar", *SMALL, "--of", names, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    of = found["quantities"]
    assert list(of) == names.split(",")
    assert (of["peak_stress"], of["error_force"]) == (None, found["error_force"])
    assert found["displacement"] == pytest.approx(of["end_displacement"])
    assert found["dissipation"] == of["dissipation"]
    assert found["force"] == pytest.approx(900.0)
    assert 0.0 < found["slipped_share"] < 1.0
    assert main(["run", "bar", *SMALL, "--of", "nothing"]) == 2
    assert "quantity" in capsys.readouterr().err
    sweep = ["sweep", "bar", *SMALL, "--of", "end_displacement", "--out", str(tmp_path)]
    assert main([*sweep, "--on", "processes:1"]) == 0
    line = (tmp_path / "sweep.csv").read_text().splitlines()[-1]
    assert float(line.split(",")[2]) == pytest.approx(of["end_displacement"])
