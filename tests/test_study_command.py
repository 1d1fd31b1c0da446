"""`python -m solver study` measures what it says, and its tables follow from its numbers."""

from __future__ import annotations

import csv
import os
import re
import subprocess
import sys
import time
from dataclasses import replace
from itertools import count

import numpy as np
import pytest

from solver import report_commands
from solver.cli import main
from solver.running.machine import LIMITS
from solver.scenes import CATALOGUE
from solver.scenes.bar import BarSettings
from solver.study.chart import HUES
from solver.study.page import NO_CHARTS
from solver.study.speed.error_against_time import (
    INCREMENTAL,
    LEVELS,
    ErrorCurve,
    Study,
    error_against_time,
    forms_of,
)
from solver.study.speed.growth import MEASURED, Growth, Size, growth
from solver.study.speed.study_report import error_panels, growth_table, table, winners

FORMS = list(forms_of(BarSettings.checked({})))
TINY = ["study", "bar", "--set", "elements=12", "--set", "instants=11", "--set", "substructures=3"]
TINY += ["--repeats", "1", "--no-growth"]


def rows(file):
    with file.open(encoding="utf-8", newline="") as text:
        return list(csv.DictReader(text))


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """Give the folder that the command fills, and the study behind it."""
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
    return ErrorCurve(method, steps, np.array(seconds), np.array(errors), np.array(errors))


def study_of(*courses):
    return Study(BarSettings.checked({"method": "paper"}), 1, "machine", courses)


def test_tables_and_a_page_that_stands_alone_are_written(measured):
    folder, study = measured
    assert {file.name for file in folder.iterdir()} == {
        "curves.csv",
        "levels.csv",
        "map.csv",
        "study.html",
    }
    page = (folder / "study.html").read_text(encoding="utf-8")
    assert page.count("data-root-id") == 3
    assert not re.search(r"<link|<script src|<img|@import", page)
    cells = {f"<td>{cell}</td>" for row in winners(study)[1:] for cell in row}
    for words in (*FORMS, INCREMENTAL, "BLAS threads: 1", *cells):
        assert words in page


def test_the_curves_have_every_method_with_times_that_increase(measured):
    found = rows(measured[0] / "curves.csv")
    assert list(found[0]) == [
        *("method", "kind", "step", "seconds", "error_displacement", "error_force")
    ]
    assert {row["method"] for row in found} == {*FORMS, INCREMENTAL}
    for method in FORMS:
        seconds = [float(row["seconds"]) for row in found if row["method"] == method]
        assert (np.diff(seconds) > 0.0).all()
        assert len(seconds) > 1


def test_the_first_iteration_pays_for_the_set_up(measured):
    for one in measured[1].curves:
        assert one.seconds.min() > 0.0
        if one.kind == "latin":
            assert one.seconds[0] > one.seconds_per_iteration


def test_accelerated_forms_end_below_a_millionth(measured):
    for one in measured[1].curves:
        if "Anderson" in one.method:
            assert one.error_force[-1] <= 1e-6
            assert one.error_displacement[-1] <= 1e-6


def test_one_clock_bills_all_methods(monkeypatch):
    seconds = map(float, count())
    monkeypatch.setattr(time, "perf_counter", lambda: next(seconds))
    monkeypatch.setattr("solver.study.speed.growth.MEASURED", MEASURED[:1])
    settings = BarSettings.checked({"elements": 6, "instants": 6, "substructures": 3})
    for one in error_against_time(settings, 1).curves:
        assert (one.seconds >= 1.0).all()
    sizes = [size for one in growth(settings) if one.setting == "instants" for size in one.sizes]
    assert all(size.seconds >= 1.0 for size in sizes)


def test_the_levels_agree_with_the_curves(measured):
    curves = rows(measured[0] / "curves.csv")
    for row in rows(measured[0] / "levels.csv"):
        times = [
            float(point["seconds"])
            for point in curves
            if point["method"] == row["method"]
            and float(point["error_force"]) <= float(row["level"])
        ]
        assert row["seconds"] == (str(min(times)) if times else "")


def test_the_table_names_the_first_of_the_levels(measured):
    folder, study = measured
    for level, found in zip(LEVELS.values(), winners(study)[1:], strict=True):
        times = {
            row["method"]: float(row["seconds"])
            for row in rows(folder / "levels.csv")
            if float(row["level"]) == level and row["seconds"]
        }
        assert found[1] == min(times, key=times.get)


def test_where_the_incremental_solver_wins_the_report_says_by_how_much():
    study = study_of(
        course("LATIN multiscale", [0.01, 0.03, 0.2], [0.5, 0.05, 1e-7]),
        course(INCREMENTAL, [0.02], [0.0]),
    )
    head, coarse, *_, fine = winners(study)
    assert head[-1] == f"LATIN / {INCREMENTAL}"
    assert coarse[1:] == [INCREMENTAL, "20", "LATIN multiscale", "30", "1.5"]
    assert fine[-2:] == ["200", "10"]


def test_where_latin_wins_or_never_arrives_the_report_says_so():
    study = study_of(
        course("LATIN multiscale", [0.01, 0.02], [0.05, 0.005]),
        course(INCREMENTAL, [0.04], [0.0]),
    )
    _, first, second, third, _ = winners(study)
    assert first == ["10 %", "LATIN multiscale", "10", "LATIN multiscale", "10", "0.25"]
    assert second[-1] == "0.5"
    assert third[3:] == ["none gets there", "-", "-"]
    assert table(study)[1][3] == "not reached"


@pytest.mark.parametrize(
    ("words", "name"),
    [
        (["--repeats", "0"], "--repeats"),
        (["--set", "elements=x"], "elements"),
        (["--set", "colour=1"], "colour"),
    ],
)
def test_bad_input_is_refused_in_one_line(tmp_path, capsys, words, name):
    assert main(["study", "bar", "--out", str(tmp_path / "out"), *words]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
    assert name in err
    assert not (tmp_path / "out").exists()


def test_a_folder_that_cannot_be_made_is_refused_before_anything_is_measured(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr(
        report_commands, "error_against_time", lambda *given: pytest.fail("measured")
    )
    (tmp_path / "file").write_text("in the way", encoding="utf-8")
    assert main([*TINY, "--out", str(tmp_path / "file")]) == 2
    assert "a folder that can be made and written to" in capsys.readouterr().err


@pytest.mark.parametrize("trouble", [KeyboardInterrupt, MemoryError])
def test_what_was_measured_by_then_stays_when_a_study_is_ended(
    trouble, tmp_path, monkeypatch, measured
):
    def end(*given, **options):
        raise trouble

    monkeypatch.setattr(report_commands, "error_against_time", lambda *given: measured[1])
    monkeypatch.setattr(report_commands, "crossover", end)
    assert main([*TINY, "--out", str(tmp_path)]) == (130 if trouble is KeyboardInterrupt else 3)
    for name in ("curves.csv", "levels.csv"):
        assert rows(tmp_path / name) == rows(measured[0] / name)


def test_without_matplotlib_the_page_is_whole_and_without_who_draws_it_says_so(
    tmp_path, monkeypatch, capsys, measured
):
    monkeypatch.setattr(report_commands, "error_against_time", lambda *given: measured[1])
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert main([*TINY, "--out", str(tmp_path)]) == 0
    page = (tmp_path / "study.html").read_text(encoding="utf-8")
    assert page.count("data-root-id") == 3
    assert NO_CHARTS not in capsys.readouterr().out
    monkeypatch.setattr("solver.study.page.entry_points", lambda group: ())
    assert main([*TINY, "--out", str(tmp_path)]) == 0
    assert NO_CHARTS in capsys.readouterr().out.splitlines()
    names = {file.name for file in tmp_path.iterdir()}
    assert names == {"curves.csv", "levels.csv", "map.csv", "study.html"}


def test_the_exponent_is_the_slope_and_needs_two_sizes():
    sizes = tuple(Size(n, 1e-6 * n**1.5, None, None) for n in (10, 20, 40))
    assert Growth("elements", "a", sizes).exponent.value == pytest.approx(1.5)
    assert Growth("elements", "a", sizes[:1]).exponent is None
    assert growth_table([Growth("elements", "a", sizes)])[1][2] == "1.50 ± 0.00"


def test_growth_leaves_out_the_sizes_that_a_scene_cannot_have(monkeypatch):
    sizes = {"elements": (2, 8, 16), "substructures": (1, 4)}
    monkeypatch.setitem(CATALOGUE, "bar", replace(CATALOGUE["bar"], sizes=sizes))
    found = growth(
        BarSettings.checked({"method": "paper", "elements": 8, "instants": 5, "substructures": 3})
    )
    assert {one.setting: [size.size for size in one.sizes] for one in found} == {
        "elements": [8, 16],
        "substructures": [1, 4],
    }
    assert all(size.seconds > 0.0 for one in found for size in one.sizes)


PROGRAM = "import solver.__main__, solver.running.machine as found; print(found.machine())"


@pytest.mark.parametrize(("given", "stated"), [(None, "1"), ("2", "2")])
def test_the_report_states_the_threads_that_the_command_line_sets(given, stated):
    surroundings = {name: value for name, value in os.environ.items() if name not in LIMITS}
    surroundings |= dict.fromkeys(LIMITS, given) if given else {}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        env=surroundings,
        capture_output=True,
        text=True,
        check=True,
    )
    assert f"BLAS threads: {stated};" in done.stdout


def test_every_method_of_a_study_has_a_color_of_its_own():
    names = [*FORMS, INCREMENTAL]
    curves = [course(name, [0.1, 0.2], [0.1, 0.01]) for name in names]
    for panel in error_panels(study_of(*curves)):
        hues = [curve.hue for curve in panel.curves]
        assert len(set(hues)) == len(hues) == len(names)
        assert max(hues) <= len(HUES)
