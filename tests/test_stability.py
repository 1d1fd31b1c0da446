"""The stability matrix: what it finds, how it judges, and what the command writes."""

from __future__ import annotations

import csv
import dataclasses
import math
import re
import warnings

import numpy as np
import pytest

from solver import report_commands
from solver.cli import main
from solver.latin import Ending
from solver.reference.assembly import assembled_stiffness
from solver.reference.incremental import incremental
from solver.scenes import CATALOGUE, discretise
from solver.scenes.bar import BarSettings
from solver.scenes.block import BlockSettings
from solver.study.quantities.finished import BROKEN
from solver.study.quantities.finished import REFUSED as REFUSED_RUN
from solver.study.stability.all_cases import by_all_methods, cases_of
from solver.study.stability.case import (
    METHODS,
    MUST_REFUSE,
    NOT_WRONG,
    PASSING,
    RIGHT,
    UNCLEAR,
    UNSOLVED,
    Case,
    Verdict,
    graded,
)
from solver.study.stability.outcome import (
    Outcome,
    condition_of_structure,
    condition_of_substructures,
)
from solver.study.stability.plane_cases import PRESSED
from solver.study.stability.report import COLOURS, COLUMNS, NOTES, TITLE, StabilityReport
from solver.study.stability.units import SAME_UP_TO, invariance, is_same
from solver.study.stability.verdict import JudgedRun, judge, judged_runs

GOOD = Outcome(
    ending=Ending.CONVERGED,
    advice="Both indicators are low.",
    iterations=10,
    seconds=0.1,
    indicator=1e-21,
    behaviour=1e-9,
    error_displacement=1e-9,
    error_force=1e-8,
    finite=True,
    condition_structure=1e3,
    condition_substructure=10.0,
)
KNOWN_UNSOLVED = {
    ("k_scale", "0.001"): "k is a thousandth of the stiffness in play",
    ("contrast", "1e6"): "one k does not suit six decades",
    ("layers", "as it is"): "the paper's k is that of a body as short as it is thick",
    ("k_scale", "1e-06"): "k is a millionth of the stiffness in play",
    ("k_scale", "1e+06"): "k is a million times the stiffness in play",
    ("stiffness contrast", "1e+08 towards the load"): "one k does not suit eight decades",
    ("friction", "1e-12"): "friction is 1e-12 of the load, which rounding leaves four digits of",
}


@pytest.fixture(scope="module")
def rows():
    """Give each quick case by one of the methods, in turns; the whole report runs all by both."""
    trials = by_all_methods(cases_of(quick=True))
    pairs = zip(trials[::2], trials[1::2], strict=True)
    return list(judged_runs([pair[place % 2] for place, pair in enumerate(pairs)], conditions=True))


def changed(**changes):
    return dataclasses.replace(GOOD, **changes)


def test_every_quick_case_comes_to_what_is_expected(rows):
    assert [row for row in rows if not row.passed] == []
    assert len(rows) == len(cases_of(quick=True))
    assert {row.case.method for row in rows} == set(METHODS)
    assert {row.case.scene for row in rows} == set(CATALOGUE)


def test_only_known_cases_end_without_the_answer_and_their_status_says_so(rows):
    for row in rows:
        place = (row.case.group, row.case.name)
        if row.verdict is Verdict.REFUSED:
            assert row.case.expected == MUST_REFUSE
            assert "is refused; allowed: " in row.outcome.advice
        elif row.verdict is Verdict.UNSOLVED:
            assert place in KNOWN_UNSOLVED
            assert row.outcome.ending in {Ending.STALLED, Ending.EXHAUSTED}
        else:
            assert row.verdict is Verdict.RIGHT


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
        (changed(finite=False, ending=Ending.DIVERGED), Verdict.WRONG),
        (changed(doubt="it is one of several", error_force=math.nan), Verdict.UNCLEAR),
        (changed(doubt="it is one of several", finite=False), Verdict.WRONG),
        (Outcome(REFUSED_RUN, "load = 1 is refused"), Verdict.REFUSED),
        (Outcome(BROKEN, "RuntimeWarning: overflow"), Verdict.WRONG),
    ],
)
def test_the_verdict_follows_from_errors_and_status(outcome, verdict):
    assert judge(outcome, 1e-6, 1e-6) is verdict


def test_a_case_that_should_be_right_does_not_pass_when_it_is_only_told():
    wrong = changed(error_force=0.5, ending=Ending.STALLED)
    unclear = changed(doubt="the reference finds no solution", error_force=math.nan)
    refused = Outcome(REFUSED_RUN, "load = 1 is refused")
    for found, passing in (
        (wrong, {UNSOLVED, UNCLEAR, NOT_WRONG}),
        (unclear, {UNCLEAR, NOT_WRONG}),
        (refused, {MUST_REFUSE, NOT_WRONG}),
        (GOOD, {RIGHT, UNSOLVED, UNCLEAR, NOT_WRONG}),
    ):
        for expected in PASSING:
            row = JudgedRun(Case("a", "b", {}, expected).by("fast"), found)
            assert row.passed is (expected in passing)


def test_one_failure_fails_the_whole():
    right, bad = (
        JudgedRun(Case("a", "b").by("fast"), found) for found in (GOOD, changed(error_force=1.0))
    )
    assert StabilityReport([right], TITLE, NOTES).passes
    assert not StabilityReport([right, bad], TITLE, NOTES).passes


def test_a_warning_breaks_a_run(monkeypatch):
    def warns(problem):
        warnings.warn("overflow", RuntimeWarning, stacklevel=1)

    monkeypatch.setattr("solver.study.stability.outcome.reference_of", warns)
    trial = Case("load", "zero", {"peak": 0.0}).by("fast")
    (row,) = judged_runs([trial], conditions=True)
    assert row.outcome.ending == BROKEN
    assert "overflow" in row.outcome.advice
    assert row.verdict is Verdict.WRONG


def test_the_matrix_covers_the_ranges():
    groups = {case.group for case in cases_of(["bar"])}
    assert groups >= {"k_scale", "young", "length", "friction", "pressure", "load", "relaxation"}
    assert groups >= {"substructures", "instants", "nodes", "stiffness contrast"}
    for name in ("k_scale", "young", "length"):
        tried = [case.values[name] for case in cases_of(["bar"]) if case.group == name]
        low, high = BarSettings.definitions()[name].bounds
        assert (min(tried), max(tried)) == (low, high)


def test_units_change_no_iterate():
    found = invariance()
    assert len(found) == 2 * len(METHODS)
    assert is_same(found)
    assert not is_same({**found, "inches": 2.0 * SAME_UP_TO})


def test_condition_numbers_are_those_of_the_dense_matrices():
    uneven = {"elements": 9, "substructures": 3, "section_profile": graded(50.0, 9)}
    problem = discretise(BarSettings.checked({"method": "paper", **uneven}))
    k = 3.0 * problem.direction
    whole, largest = np.zeros((10, 10)), 0.0
    for part in problem.substructures:
        own = part.elasticity.stiffness.toarray()
        whole[np.ix_(part.dofs, part.dofs)] += own
        trace = np.eye(len(part.dofs))[part.elasticity.trace]
        largest = max(largest, np.linalg.cond(own + trace.T @ np.diag(k[part.rows]) @ trace))
    assert condition_of_structure(problem) == pytest.approx(np.linalg.cond(whole[1:, 1:]))
    assert condition_of_substructures(problem, k) == pytest.approx(largest)


def test_condition_numbers_in_the_plane_are_those_of_the_skeleton():
    sizes = {"elements": 6, "elements_up": 4, "substructures": 2, "substructures_up": 1}
    held = discretise(BlockSettings.checked({**sizes, "instants": 1}))
    whole = assembled_stiffness(held).toarray()
    free = np.setdiff1d(np.arange(held.n_dofs), held.prescribed[0])
    assert condition_of_structure(held) == pytest.approx(np.linalg.cond(whole[np.ix_(free, free)]))
    loose = BlockSettings.checked({**sizes, **PRESSED, "instants": 1})
    assert condition_of_structure(discretise(loose)) == np.inf


def test_elements_in_a_row_stretch_by_the_inverse_of_their_stiffness():
    settings = BarSettings.checked(
        {
            "elements": 7,
            "substructures": 2,
            "friction": 0.0,
            "load": "ramp",
            "instants": 2,
            "section_profile": graded(1e6, 7),
        }
    )
    found = incremental(discretise(settings)).displacement[:, -1]
    stretch = np.diff(found)
    assert stretch[:-1] / stretch[1:] == pytest.approx(np.full(6, 10.0))


@pytest.fixture
def written(tmp_path, monkeypatch, capsys):
    few = [Case("load", "zero <N>", {"peak": 0.0}, quick=True), Case("friction", "0")]
    monkeypatch.setattr(report_commands, "cases_of", lambda scene, quick: few[: 1 if quick else 2])
    folder = tmp_path / "made by" / "the command"
    code = main(["stability", "--quick", "--out", str(folder)])
    return folder, code, capsys.readouterr()


def test_the_command_writes_a_table_and_a_page_that_stands_alone(written):
    folder, code, (out, err) = written
    assert (code, err) == (0, "")
    assert {file.name for file in folder.iterdir()} == {"stability.csv", "stability.html"}
    with (folder / "stability.csv").open(encoding="utf-8", newline="") as file:
        found = list(csv.DictReader(file))
    assert [row["method"] for row in found] == list(METHODS)
    assert all(row["verdict"] == "right" for row in found)
    assert tuple(found[0]) == COLUMNS
    page = (folder / "stability.html").read_text(encoding="utf-8")
    assert "zero &lt;N&gt;" in page
    assert "2 of 2 runs pass" in page
    assert "2 of 2 runs pass" in out
    assert not re.search(r"https?:|src=|href|@import|<script|url\(", page)


def test_every_verdict_has_its_own_colour_and_words(rows):
    assert set(COLOURS) == set(Verdict)
    assert len(set(COLOURS.values())) == len(Verdict)
    report = StabilityReport(rows, TITLE, NOTES)
    found = report.counts()[1:]
    assert [verdict for verdict, _, _ in found] == list(Verdict)
    assert len({meaning for _, _, meaning in found}) == len(Verdict)
    assert sum(int(runs) for _, runs, _ in found) == len(rows)
    assert report.summary == f"{len(rows)} of {len(rows)} runs pass."


def test_one_scene_alone_can_be_asked(tmp_path, capsys):
    assert {case.scene for case in cases_of(["strand"])} == {"strand"}
    assert main(["stability", "strand", "--quick", "--out", str(tmp_path)]) == 0
    assert "In other units" not in capsys.readouterr().out
    assert main(["stability", "cable", "--out", str(tmp_path)]) == 2
    assert ", ".join(CATALOGUE) in capsys.readouterr().err


def test_a_failure_gives_exit_code_one(tmp_path, monkeypatch):
    monkeypatch.setattr(
        report_commands,
        "cases_of",
        lambda scene, quick: [Case("load", "too few", {"max_iterations": 3})],
    )
    assert main(["stability", "--out", str(tmp_path)]) == 1
    assert "FAIL" in (tmp_path / "stability.csv").read_text(encoding="utf-8")


@pytest.mark.parametrize("obstacle", ["folder is a file", "page is a folder"])
def test_a_folder_that_cannot_be_written_to_is_refused_before_the_runs(
    tmp_path, monkeypatch, capsys, obstacle
):
    monkeypatch.setattr(
        report_commands, "judged_runs", lambda *rest, **options: pytest.fail("it ran")
    )
    folder = tmp_path / "out"
    if obstacle == "page is a folder":
        (folder / "stability.html").mkdir(parents=True)
        (folder / "stability.csv").mkdir()
    else:
        folder.write_text("in the way", encoding="utf-8")
    assert main(["stability", "--out", str(folder)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
    assert "a folder that can be made and written to" in err
