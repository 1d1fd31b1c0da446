"""The command line refuses in one line, and says what a run does not heed."""

from __future__ import annotations

import pytest
from bars import SMALL_BAR as SMALL

from solver.cli import main


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["bar", "--set", "friktion=0.3"], ["friktion", "0.3", "did you mean friction?"]),
        (["bar", "--set", "peak=much"], ["peak", "much", "any number (at most 1e15 N in size)"]),
        (["bar", "--set", "relaxation=2"], ["relaxation", "2", "a number from 0.01 to 1"]),
        (["bar", "--set", "peak=nan"], ["peak", "NaN", "any number"]),
        (["bar", "--set", "elements=true"], ["elements", "true", "a whole number from 1"]),
        (["bar", "--set", "elements=3"], ["substructures", "10", "1 to elements (3)"]),
        (["bar", "--set", "load=none.csv"], ["load", "none.csv", "ramp, triangle"]),
        (["bar", "--set", "load=bad.csv"], ["load", "bad.csv", "line 2"]),
        (["bar", "--set", "peak"], ["--set", "NAME=VALUE"]),
        (["bridge"], ["scene", "bridge", "bar"]),
        (["none.toml"], ["settings file", "none.toml"]),
        (["broken.toml"], ["settings file", "TOML"]),
        (["bar", "--out", "nowhere/x.npz"], ["--out", "nowhere/x.npz", "existing folder"]),
        (["bar", "--out", "."], ["--out", "existing folder"]),
    ],
    ids=lambda case: " ".join(case),
)
def test_refused_input_prints_one_line_exits_2_and_writes_nothing(
    tmp_path, monkeypatch, capsys, arguments, words
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.csv").write_text("0,0\n1,much\n", encoding="utf-8")
    (tmp_path / "broken.toml").write_text("scene = bar\n", encoding="utf-8")
    before = sorted(tmp_path.iterdir())
    out = [] if "--out" in arguments else ["--out", "result.npz"]
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


def test_settings_of_an_unknown_scene_are_refused(capsys):
    assert main(["settings", "bridge"]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


@pytest.mark.parametrize(
    ("assignments", "words"),
    [
        (["linear_stage=pgd", "acceleration=anderson"], "acceleration does nothing"),
        (["load=[[0,0],[5,900]]"], "set duration=5"),
        (["load=[[0,0],[5,900]]", "duration=5"], ""),
        (["acceleration=none", "peak=10"], ""),
        (["method=paper", "linear_stage=pgd", "acceleration=anderson"], "acceleration does"),
        (["method=paper", "linear_stage=pgd", "finish=status"], ""),
        (["linear_stage=pgd", "acceleration=none", "finish=none"], ""),
        (["linear_stage=pgd", "method=paper"], ""),
    ],
)
def test_what_a_run_does_not_heed_is_said(capsys, assignments, words):
    changes = [text for assignment in assignments for text in ("--set", assignment)]
    main(["run", "bar", *SMALL, "--set", "max_iterations=2", *changes])
    printed = capsys.readouterr()
    assert words in printed.err
    assert bool(printed.err) == bool(words)
    assert "iterations" in printed.out


def test_a_structure_on_which_nothing_acts_is_said_to_be_idle(capsys):
    assert main(["run", "block", "--set", "top=traction", "--set", "instants=5"]) == 0
    assert "nothing acts on the structure" in capsys.readouterr().err
