"""Result files hold what the contract names, whole or not at all."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from bars import SMALL_BAR as SMALL

from solver.cli import main
from solver.scenes.bar import BarSettings

ROOT = Path(__file__).resolve().parents[1]


def test_the_result_file_holds_what_the_contract_names(tmp_path, capsys):
    file = tmp_path / "result.npz"
    assert main(["run", "bar", *SMALL, "--out", str(file), "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    with np.load(file, allow_pickle=False) as found:
        arrays = dict(found)
    points, iterations = 13, printed["iterations"]
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
    for name in ("indicator", "estimated_error", "error_displacement", "error_force", "seconds"):
        assert arrays[name][-1] == printed[name]
    assert arrays["determinate"].dtype == bool
    assert arrays["certified"] == printed["certified"]
    assert arrays["residual"] == printed["residual"]
    values = json.loads(str(arrays["settings"]))
    assert values.pop("scene") == "bar"
    assert BarSettings.checked(values).values() == printed["settings"]


def test_forces_in_the_result_are_in_newtons_and_act_on_the_bar(tmp_path):
    file = tmp_path / "result.npz"
    main(["run", "bar", *SMALL, "--set", "load=ramp", "--set", "peak=600", "--out", str(file)])
    with np.load(file) as found:
        force, status, displacement = (
            found[name] for name in ("friction_force", "status", "displacement")
        )
    assert force[:, -1].sum() == pytest.approx(-600.0, rel=1e-3)
    assert np.all(force[status > 0] < 0.0)
    assert not (status < 0).any()
    assert displacement[-1, -1] == pytest.approx(600.0**2 / (2 * 659_400.0 * 1500.0), rel=0.02)


def test_the_same_command_twice_gives_the_same_fields(tmp_path):
    fields = []
    for name in ("one.npz", "two.npz"):
        main(["run", "bar", *SMALL, "--out", str(tmp_path / name)])
        with np.load(tmp_path / name) as found:
            fields.append([found[key] for key in ("displacement", "friction_force", "indicator")])
    assert all(np.array_equal(one, two) for one, two in zip(*fields, strict=True))


def test_what_is_no_file_is_refused_before_the_run_and_left_as_it_is(capsys, tmp_path):
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
    assert [(one.name, one.read_bytes()) for one in tmp_path.iterdir()] == [(file.name, b"old")]


def test_whoever_reads_no_further_loses_no_file(tmp_path):
    file = tmp_path / "bar.npz"
    reader, writer = os.pipe()
    os.close(reader)
    command = [sys.executable, "-m", "solver", "run", "bar", *SMALL, "--json", "--out", file]
    few = ["--set", "max_iterations=1", "--set", "finish=none"]
    done = subprocess.run(
        [*command, *few], cwd=ROOT, stdout=writer, stderr=subprocess.PIPE, check=False
    )
    os.close(writer)
    assert (done.returncode, done.stderr) == (1, b"")
    with np.load(file) as found:
        assert len(found["indicator"]) == 1
