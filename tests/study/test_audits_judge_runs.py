"""The stability of extreme and random runs: how they are judged, and what is written."""

from __future__ import annotations

import csv
import dataclasses
import math
import re
import warnings

import pytest
from small_scenes import SMALL

from solver.commands import reports as report_commands
from solver.commands.cli import main
from solver.latin import Ending
from solver.reference.distance import kkt_residual
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.study.quantities.finished import BROKEN, REFUSED
from solver.study.random_runs import draw, random_case
from solver.study.stability import (
    AT_ROUNDING,
    COLUMNS,
    METHODS,
    Outcome,
    StabilityCase,
    Verdict,
    counts,
    extreme_cases,
    judge,
    judged_runs,
    last_lines,
    row_of,
)

GOOD = Outcome(
    ending=Ending.CONVERGED,
    advice="Both indicators are low.",
    iterations=10,
    seconds=0.1,
    indicator=1e-21,
    behaviour=1e-9,
    error_displacement=1e-9,
    error_force=1e-8,
)


def changed(**changes):
    return dataclasses.replace(GOOD, **changes)


@pytest.mark.parametrize(
    ("outcome", "verdict"),
    [
        (GOOD, Verdict.RIGHT),
        (changed(error_force=1e-5), Verdict.WRONG),
        (changed(error_displacement=0.5), Verdict.WRONG),
        (changed(error_force=0.5, ending=Ending.EXHAUSTED), Verdict.UNSOLVED),
        (changed(error_force=0.5, ending=Ending.EXHAUSTED, advice=""), Verdict.WRONG),
        (changed(ending=Ending.STALLED), Verdict.RIGHT),
        (changed(error_force=math.nan), Verdict.WRONG),
        (changed(error_displacement=math.nan), Verdict.WRONG),
        (changed(doubt="it is one of several", error_force=math.nan), Verdict.UNCLEAR),
        (changed(doubt="it is one of several", ending=BROKEN), Verdict.WRONG),
        (Outcome(REFUSED, "load = 1 is refused"), Verdict.REFUSED),
        (Outcome(BROKEN, "RuntimeWarning: overflow"), Verdict.WRONG),
        (changed(error_force=0.5, certified=True, residual=1e-13), Verdict.WRONG),
        (changed(error_force=0.5, doubt="one", certified=True, residual=1e-13), Verdict.RIGHT),
        (changed(certified=True, residual=2.0 * AT_ROUNDING), Verdict.WRONG),
        (changed(certified=True, residual=3e-7, floor=3e-7), Verdict.RIGHT),
        (changed(certified=True), Verdict.WRONG),
    ],
)
def test_the_verdict_follows_from_errors_and_status(outcome, verdict):
    assert judge(outcome, 1e-6, 1e-6) is verdict


def test_a_warning_breaks_a_run(monkeypatch):
    def warns(problem, stop):
        warnings.warn("overflow", RuntimeWarning, stacklevel=1)

    monkeypatch.setattr("solver.study.quantities.finished.reference_of", warns)
    (row,) = judged_runs([StabilityCase("zero", "bar", {"peak": 0.0})])
    assert row["ending"] == BROKEN
    assert "overflow" in row["advice"]
    assert row["verdict"] == Verdict.WRONG


def rows_in(folder):
    with (folder / "stability.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_the_command_writes_a_table_and_a_page_that_stands_alone(tmp_path, monkeypatch, capsys):
    given = [
        StabilityCase("zero <N>", "bar", {"peak": 0.0, **own}, method=method)
        for method, own in METHODS.items()
    ]
    monkeypatch.setattr(report_commands, "extreme_cases", lambda scene, quick: given)
    folder = tmp_path / "made by" / "the command"
    assert main(["stability", "--quick", "--out", str(folder)]) == 0
    assert {file.name for file in folder.iterdir()} == {"stability.csv", "stability.html"}
    found = rows_in(folder)
    assert [row["method"] for row in found] == list(METHODS)
    assert all(row["verdict"] == "right" for row in found)
    assert tuple(found[0]) == COLUMNS
    page = (folder / "stability.html").read_text(encoding="utf-8")
    assert "zero &lt;N&gt;" in page
    assert not re.search(r"https?:|src=|href|@import|<script|url\(", page)
    for text in (page, capsys.readouterr().out):
        assert "2 of 2 runs pass" in text


def test_scenes_and_random_runs_can_be_asked(tmp_path, capsys):
    assert {case.scene for case in extreme_cases(["strand"])} == {"strand"}
    assert main(["stability", "cable", "--out", str(tmp_path)]) == 2
    assert ", ".join(CATALOGUE) in capsys.readouterr().err
    command = ["stability", "bar", "--random", "3", "--seed", "1", "--out", str(tmp_path)]
    assert main(command) == 0
    assert [row["case"] for row in rows_in(tmp_path)] == [f"row {n} of seed 1" for n in range(3)]


@pytest.mark.parametrize("scene", CATALOGUE)
def test_a_row_is_drawn_alike_whatever_was_drawn_before(scene):
    assert draw(scene, 3, 7).values() == draw(scene, 3, 7).values()
    assert draw(scene, 3, 7).values() != draw(scene, 3, 8).values()
    assert draw(scene, 3, 7).values() != draw(scene, 4, 7).values()


@pytest.mark.parametrize("scene", SMALL)
def test_the_equations_alone_tell_a_solution_from_what_is_near_it(scene):
    problem = discretise(CATALOGUE[scene].checked(SMALL[scene]))
    found = reference_of(problem)
    weaker = dataclasses.replace(found, contact_force=0.999 * found.contact_force)
    further = dataclasses.replace(found, displacement=1.001 * found.displacement)
    assert kkt_residual(found, problem) < AT_ROUNDING
    assert kkt_residual(weaker, problem) > 100.0 * AT_ROUNDING
    assert kkt_residual(further, problem) > 100.0 * AT_ROUNDING


def test_a_wrong_row_is_listed_with_what_repeats_it():
    wrong, right = (
        row_of(random_case(draw("bar", 9, row), 9, row), changed(error_force=error))
        for row, error in ((4, 0.5), (5, 0.0))
    )
    text = "\n".join(last_lines([wrong, right]))
    assert wrong["command"] in text
    assert right["command"] not in text
    assert "1 of 2 runs pass" in text
    counted = {verdict: runs for verdict, runs, _ in counts([wrong, right])[1:]}
    assert counted == {"right": "1", "unsolved": "0", "refused": "0", "unclear": "0", "wrong": "1"}
