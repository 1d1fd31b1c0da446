"""`python -m solver study` measures what it says:
errors against time, and who is first where.
"""

from __future__ import annotations

import csv
import os
import re
import subprocess
import sys
from itertools import chain, product
from typing import Any

import numpy as np
import pytest

from solver.commands import reports as report_commands
from solver.commands.cli import main
from solver.scenes import CATALOGUE
from solver.scenes.bar import BarSettings
from solver.study import measured_times as measuring
from solver.study.measured_times import (
    FACTORS,
    INCREMENTAL,
    LEVELS,
    ErrorCurve,
    forms_of,
    times_at_sizes,
)
from solver.study.page import NO_CHARTS
from solver.study.study_report import sizes_table, table
from solver.study.sweep.executors import LIMITS

TINY = [
    "study",
    "bar",
    "--set",
    "elements=12",
    "--set",
    "instants=11",
    "--set",
    "substructures=3",
]
TINY += ["--repeats", "1"]


def rows(file):
    with file.open(encoding="utf-8", newline="") as text:
        return list(csv.DictReader(text))


@pytest.fixture(scope="module", autouse=True)
def one_repeat():
    """Each size is measured once: how often changes no row."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(measuring, "REPEATS", 1)
        yield


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """Folder that the command fills, and the curves behind it."""
    kept = []
    folder = tmp_path_factory.mktemp("study") / "made"
    with pytest.MonkeyPatch.context() as patch:
        original = report_commands.error_against_time
        for limit in LIMITS:
            patch.setenv(limit, "1")
        patch.setattr(
            report_commands,
            "error_against_time",
            lambda *given: kept.append(original(*given)) or kept[0],
        )
        assert main([*TINY, "--out", str(folder)]) == 0
    return folder, kept[0]


def course(method, seconds, errors):
    steps = np.arange(1.0, len(seconds) + 1.0)
    return ErrorCurve(
        method, steps, np.array(seconds), np.array(errors), np.array(errors)
    )


def test_tables_and_a_page_that_stands_alone_are_written(measured):
    folder, curves = measured
    assert {file.name for file in folder.iterdir()} == {
        "curves.csv",
        "levels.csv",
        "map.csv",
        "study.html",
    }
    page = (folder / "study.html").read_text(encoding="utf-8")
    assert page.count("data-root-id") == 2
    assert not re.search(r"<link|<script src|<img|@import", page)
    cells = {f">{cell}</td>" for cell in chain.from_iterable(table(curves)[1:])}
    for words in (*forms_of(BarSettings()), INCREMENTAL, "BLAS threads: 1", *cells):
        assert words in page


def test_the_table_marks_the_first_of_the_levels(measured):
    folder, curves = measured
    for column, level in enumerate(LEVELS.values(), start=1):
        reached = [row for row in rows(folder / "levels.csv") if row["seconds"]]
        times = {
            row["method"]: float(row["seconds"])
            for row in reached
            if float(row["level"]) == level
        }
        first = [row[0] for row in table(curves) if row[column].endswith("*")]
        assert first == [min(times, key=times.get)]


def test_where_the_incremental_solver_wins_the_report_says_by_how_much():
    curves = [
        course("LATIN multiscale", [0.01, 0.03, 0.2], [0.5, 0.05, 1e-7]),
        course(INCREMENTAL, [0.02], [0.0]),
    ]
    _, latin, incremental, ratios = table(curves)
    assert latin[1:3] == ["30 ms (2)", "200 ms (3)"]
    assert incremental[1:3] == ["20 ms *", "20 ms *"]
    assert ratios[:3] == [f"best LATIN / {INCREMENTAL}", "1.5", "10"]


@pytest.mark.parametrize("trouble", [KeyboardInterrupt, MemoryError])
def test_measured_times_are_kept_when_a_study_is_interrupted(
    trouble, tmp_path, monkeypatch, measured
):
    def end(*given, **options):
        raise trouble

    monkeypatch.setattr(
        report_commands, "error_against_time", lambda *given: measured[1]
    )
    monkeypatch.setattr(report_commands, "times_at_sizes", end)
    assert main([*TINY, "--out", str(tmp_path)]) == (
        130 if trouble is KeyboardInterrupt else 3
    )
    for name in ("curves.csv", "levels.csv"):
        assert rows(tmp_path / name) == rows(measured[0] / name)


def test_a_report_without_a_renderer_says_so(tmp_path, monkeypatch, capsys, measured):
    monkeypatch.setattr(
        report_commands, "error_against_time", lambda *given: measured[1]
    )
    monkeypatch.setattr("solver.study.page.entry_points", lambda group: ())
    assert main([*TINY, "--out", str(tmp_path)]) == 0
    assert NO_CHARTS in capsys.readouterr().out.splitlines()
    names = {file.name for file in tmp_path.iterdir()}
    assert names == {"curves.csv", "levels.csv", "map.csv", "study.html"}


PROGRAM = (
    "import solver.__main__, solver.study.sweep.executors as found; "
    "print(found.machine())"
)


def test_the_report_states_the_threads_as_given_and_one_set_by_the_command_line():
    surroundings = {
        name: value for name, value in os.environ.items() if name not in LIMITS
    }
    surroundings[LIMITS[1]] = "2"
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        env=surroundings,
        capture_output=True,
        text=True,
        check=True,
    )
    assert "BLAS threads: 1, 2;" in done.stdout


SMALL_ONES: dict[str, dict[str, Any]] = {
    "bar": {"elements": 12, "instants": 11, "substructures": 3},
    "strand": {"elements": 6, "instants": 5, "substructures": 2, "wires": 4},
    "layers": {"elements": 8, "instants": 5, "layers": 4, "substructures": 1},
}


@pytest.mark.parametrize("scene", ["bar", "layers"])
def test_the_present_size_and_its_multiples_are_measured(scene: str) -> None:
    settings = CATALOGUE[scene].checked(SMALL_ONES[scene])
    measured = times_at_sizes(settings)
    name = CATALOGUE[scene].GROWS[0]
    sizes = [round(factor * getattr(settings, name)) for factor in FACTORS]
    instants = [round(factor * (settings.instants - 1)) + 1 for factor in FACTORS]
    at = {(times.size, times.instants): times for times in measured}
    assert at.keys() == set(product(sizes, instants))
    assert all(times.ratio > 0.0 and not times.message for times in measured)
    assert len(sizes_table(settings, measured)) == 1 + len(measured)


def test_sizes_that_take_too_long_are_left_out_with_a_note(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    settings = CATALOGUE["strand"].checked({**SMALL_ONES["strand"], "wires": 2})
    monkeypatch.setattr(measuring, "LONGEST", 0.0)
    found = times_at_sizes(settings)
    said = {one.size: one.message for one in found}
    assert list(said) == [1, 2, 4]
    assert said[1] == "there is no such size"
    assert said[2].startswith("left out: it would take about")
    assert any(
        row[0] == "4" and "left out" in row[-1] for row in sizes_table(settings, found)
    )
