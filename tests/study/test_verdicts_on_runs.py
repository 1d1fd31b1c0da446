"""The stability of extreme and random runs:
how they are judged, and what is written.
"""

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
from solver.latin.end.status import Status
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE
from solver.study.outcomes import APART, AT_ROUNDING, Outcome
from solver.study.random_runs import draw, random_case
from solver.study.scene_run import BROKEN, REFUSED, finished_run
from solver.study.stability import (
    METHODS,
    StabilityCase,
    extreme_cases,
    judged_runs,
    row_of,
)
from solver.study.stability_report import COLUMNS, counted, last_lines
from solver.study.verdicts import JUDGES, MEANING, Judge, Verdict, judge

GOOD = Outcome(
    ending=Ending.CONVERGED,
    advice="Both indicators are low.",
    iterations=10,
    seconds=0.1,
    indicator=1e-21,
    behaviour=1e-9,
    error_displacement=1e-9,
    error_force=1e-8,
    laws=1e-5,
    reference_laws=1e-14,
)


def changed(**changes):
    return dataclasses.replace(GOOD, **changes)


@pytest.mark.parametrize(
    ("outcome", "verdict", "by"),
    [
        (GOOD, Verdict.RIGHT, Judge.REFERENCE),
        (changed(error_force=1e-5), Verdict.WRONG, Judge.REFERENCE),
        (changed(error_displacement=0.5), Verdict.WRONG, Judge.REFERENCE),
        (
            changed(error_force=0.5, ending=Ending.EXHAUSTED),
            Verdict.UNSOLVED,
            Judge.NOTHING,
        ),
        (
            changed(error_force=0.5, ending=Ending.EXHAUSTED, advice=""),
            Verdict.WRONG,
            Judge.NOTHING,
        ),
        (changed(ending=Ending.STALLED), Verdict.RIGHT, Judge.REFERENCE),
        (changed(error_force=math.nan), Verdict.WRONG, Judge.REFERENCE),
        (changed(error_displacement=math.nan), Verdict.WRONG, Judge.REFERENCE),
        (
            changed(doubt="one of several", error_force=math.nan),
            Verdict.UNCLEAR,
            Judge.NOTHING,
        ),
        (changed(doubt="one of several", ending=BROKEN), Verdict.WRONG, Judge.NOTHING),
        (Outcome(REFUSED, "load = 1 is refused"), Verdict.REFUSED, Judge.NOTHING),
        (Outcome(BROKEN, "RuntimeWarning: overflow"), Verdict.WRONG, Judge.NOTHING),
        # Laws alone judge who is certified: the reference is found in the same way.
        (changed(certified=True, laws=1e-13), Verdict.RIGHT, Judge.LAWS),
        (changed(certified=True, error_force=0.0), Verdict.WRONG, Judge.LAWS),
        (changed(certified=True, laws=2.0 * AT_ROUNDING), Verdict.WRONG, Judge.LAWS),
        (changed(certified=True, laws=math.nan), Verdict.WRONG, Judge.LAWS),
        # No more is claimed than the residual.
        (changed(certified=True, laws=1e-7, residual=2e-7), Verdict.RIGHT, Judge.LAWS),
        (changed(certified=True, laws=1e-7, residual=9e-8), Verdict.WRONG, Judge.LAWS),
        (changed(certified=True, laws=1e-7, residual=1e-3), Verdict.WRONG, Judge.LAWS),
        (
            changed(certified=True, laws=3e-7, reference_laws=3e-7, error_force=0.0),
            Verdict.WRONG,
            Judge.LAWS,
        ),
        (
            changed(error_force=0.5, certified=True, laws=1e-13),
            Verdict.RIGHT,
            Judge.LAWS,
        ),
        (changed(laws=1e-13, doubt="no reference"), Verdict.RIGHT, Judge.LAWS),
        # A reference that breaks a law is no judge, and says so in its doubt.
        (
            changed(reference_laws=1e-3, doubt="the reference breaks a law"),
            Verdict.UNCLEAR,
            Judge.NOTHING,
        ),
        (changed(reference_laws=math.nan), Verdict.WRONG, Judge.NOTHING),
    ],
)
def test_the_verdict_follows_from_laws_errors_and_status(outcome, verdict, by):
    assert judge(outcome, 1e-6, 1e-6) == (verdict, by)


def test_a_warning_breaks_a_run(monkeypatch):
    def warns(problem, stop):
        warnings.warn("overflow", RuntimeWarning, stacklevel=1)

    monkeypatch.setattr("solver.study.known_reference.reference_of", warns)
    (row,) = judged_runs([StabilityCase("zero", "bar", {"peak": 0.0})])
    assert row["ending"] == BROKEN
    assert "overflow" in row["advice"]
    assert row["verdict"] == Verdict.WRONG


def rows_in(folder):
    with (folder / "stability.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_the_command_writes_a_table_and_a_page_that_stands_alone(
    tmp_path, monkeypatch, capsys
):
    given = [
        StabilityCase("zero <N>", "bar", {"peak": 0.0, **own}, method=method)
        for method, own in METHODS.items()
    ]
    monkeypatch.setattr(report_commands, "extreme_cases", lambda scene, quick: given)
    folder = tmp_path / "made by" / "the command"
    assert main(["stability", "--quick", "--out", str(folder)]) == 0
    assert {file.name for file in folder.iterdir()} == {
        "stability.csv",
        "stability.html",
    }
    found = rows_in(folder)
    assert [row["method"] for row in found] == list(METHODS)
    assert all(row["verdict"] == "right" for row in found)
    assert tuple(found[0]) == COLUMNS
    page = (folder / "stability.html").read_text(encoding="utf-8")
    assert "zero &lt;N&gt;" in page
    # On a phone each value stands beside its head.
    assert page.count('data-head="verdict">right<') == 2
    # Where a row is wider than a window its words are not.
    assert len(re.findall(r'class="more below" colspan="\d+"><div>', page)) == 2
    # On paper each page of a table begins with the heads.
    assert page.count("<thead>") == page.count("<table") == 3
    assert not re.search(r"https?:|src=|href|@import|<script|url\(", page)
    for text in (page, capsys.readouterr().out):
        assert "2 of 2 runs pass" in text


def test_scenes_and_random_runs_can_be_asked(tmp_path, capsys):
    assert {case.scene for case in extreme_cases(["strand"])} == {"strand"}
    assert main(["stability", "cable", "--out", str(tmp_path)]) == 2
    assert ", ".join(CATALOGUE) in capsys.readouterr().err
    command = [
        "stability",
        "bar",
        "--random",
        "3",
        "--seed",
        "1",
        "--out",
        str(tmp_path),
    ]
    assert main(command) == 0
    assert [row["case"] for row in rows_in(tmp_path)] == [
        f"row {n} of seed 1" for n in range(3)
    ]


@pytest.mark.parametrize("scene", CATALOGUE)
def test_a_row_is_drawn_alike_whatever_was_drawn_before(scene):
    values = draw(scene, 3, 7).values()
    assert draw(scene, 3, 8).values() != values
    assert draw(scene, 4, 7).values() != values
    assert draw(scene, 3, 7).values() == values


@pytest.mark.parametrize("factor", [0.999, -1.0])
def test_a_certified_answer_that_was_spoiled_is_wrong(monkeypatch, factor):
    def spoiled_run(settings, **wanted):
        made = finished_run(settings, **wanted)
        iterate = made.iterate
        assert made.solution.is_certified
        spoiled = dataclasses.replace(iterate, force=factor * iterate.force)
        solution = dataclasses.replace(made.solution, iterate=spoiled)
        return dataclasses.replace(made, solution=solution)

    for scene in ("bar", "block"):
        case = StabilityCase("as it is", scene, SMALL[scene])
        assert [row["judged_by"] for row in judged_runs([case])] == [Judge.LAWS]
        with monkeypatch.context() as patch:
            patch.setattr("solver.study.outcomes.finished_run", spoiled_run)
            (row,) = judged_runs([case])
        assert row["verdict"] == Verdict.WRONG
        assert row["judged_by"] == Judge.LAWS


def test_an_iterate_is_judged_by_the_solution_that_it_came_to():
    """A block of four elements that is dragged has two solutions, 40 % apart."""
    case = random_case(draw("block", 99796577, 25), 99796577, 25)
    (row,) = judged_runs([case])
    assert row["error_force"] < case.error_force
    assert row["judged_by"] == Judge.REFERENCE
    assert row["verdict"] == Verdict.RIGHT


def test_an_iterate_far_from_every_solution_is_wrong(monkeypatch):
    def hasty_run(settings, **wanted):
        made = finished_run(settings, **wanted)
        status = Status(Ending.CONVERGED, "Both indicators are low.")
        solution = dataclasses.replace(made.solution, status=status)
        return dataclasses.replace(made, solution=solution)

    monkeypatch.setattr("solver.study.outcomes.finished_run", hasty_run)
    settings = draw("block", 99796577, 25)
    early = CATALOGUE["block"].checked({**settings.changed(), "max_iterations": 20})
    (row,) = judged_runs([random_case(early, 99796577, 25)])
    assert row["judged_by"] == Judge.REFERENCE
    assert row["verdict"] == Verdict.WRONG


def test_no_other_solution_is_sought_for_a_run_that_claims_nothing(monkeypatch):
    def sought(*_, **__):
        raise AssertionError("a status step was made")

    monkeypatch.setattr("solver.study.scene_run.status_step", sought)
    settings = draw("block", 99796577, 25)
    early = CATALOGUE["block"].checked({**settings.changed(), "max_iterations": 20})
    (row,) = judged_runs([random_case(early, 99796577, 25)])
    assert row["status"] == Ending.EXHAUSTED
    assert row["error_force"] > APART
    assert row["verdict"] == Verdict.UNSOLVED


def test_laws_hold_where_nothing_moves_but_by_rounding():
    """A rope whose cohesion holds each end where it is pulled."""
    held = {
        "friction_law": "general",
        "cohesion": 7e6,
        "substructures": 11,
        "pull": 305.0,
        "tail_force": 10.6,
        "elements": 59,
        "instants": 21,
    }
    (row,) = judged_runs([StabilityCase("cohesion", "belt", held)])
    assert row["certified"]
    assert row["verdict"] == Verdict.RIGHT


def test_a_reference_that_breaks_a_law_judges_nobody(monkeypatch):
    def weaker(problem, stop=None):
        found = reference_of(problem)
        return dataclasses.replace(found, contact_force=0.999 * found.contact_force)

    monkeypatch.setattr("solver.study.known_reference.reference_of", weaker)
    values = {**SMALL["bar"], "finish": "none", "accuracy": 1e-3}
    (row,) = judged_runs([StabilityCase("by its own", "bar", values, error_force=0.1)])
    assert row["verdict"] == Verdict.UNCLEAR
    assert "the reference breaks a law (balance)" in row["doubt"]


def test_a_wrong_row_is_listed_with_what_repeats_it():
    wrong, right = (
        row_of(random_case(draw("bar", 9, row), 9, row), changed(error_force=error))
        for row, error in ((4, 0.5), (5, 0.0))
    )
    text = "\n".join(last_lines([wrong, right]))
    assert wrong["command"] in text
    assert right["command"] not in text
    assert "1 of 2 runs pass" in text
    by_judge = counted([wrong, right], "judged_by", JUDGES)
    assert {name: runs for name, runs, _ in by_judge[1:]} == {
        "laws": "0",
        "reference": "2",
        "nothing": "0",
    }
    by_verdict = counted([wrong, right], "verdict", MEANING)
    assert {name: runs for name, runs, _ in by_verdict[1:]} == {
        "right": "1",
        "unsolved": "0",
        "refused": "0",
        "unclear": "0",
        "wrong": "1",
    }
