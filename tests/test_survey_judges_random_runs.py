"""Random runs have wide settings, alike each time; it is known what is called converged wrongly."""

from __future__ import annotations

import csv
import dataclasses
import math
import shlex
from types import SimpleNamespace

import numpy as np
import pytest
from ropes import SMALL_ROPE

from solver import report_commands
from solver.cli import main
from solver.files import settings_from_command
from solver.latin import Ending
from solver.reference.choice import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.study.quantities.finished import BROKEN, REFUSED
from solver.study.stability.all_cases import random_case
from solver.study.stability.case import Verdict
from solver.study.stability.draws import KEPT, LARGEST_FIELD, draw, is_foolish
from solver.study.stability.outcome import AT_ROUNDING, Outcome
from solver.study.stability.report import RANDOM_NOTES, RANDOM_TITLE, StabilityReport, missed_table
from solver.study.stability.residual import kkt_residual
from solver.study.stability.verdict import JudgedRun, judge

SMALL = {
    "bar": {"elements": 20, "substructures": 4, "instants": 11},
    "strand": {"elements": 12, "instants": 9},
    "block": {"elements": 12, "elements_up": 6, "instants": 9},
    "layers": {"elements": 12, "elements_up": 1, "instants": 9},
    "fault": {"elements": 12, "elements_up": 6, "instants": 9},
    "incline": {"elements": 12, "elements_up": 6, "instants": 9},
    "rope": {**SMALL_ROPE, "elements": 10, "instants": 9},
}
GOOD = Outcome(Ending.CONVERGED, "It is.", error_displacement=1e-3, error_force=5e-3)


def changed(**changes):
    return dataclasses.replace(GOOD, **changes)


@pytest.mark.parametrize("scene", CATALOGUE)
def test_a_row_is_drawn_alike_whatever_was_drawn_before(scene):
    assert draw(scene, 3, 7).values() == draw(scene, 3, 7).values()
    assert draw(scene, 3, 7).values() != draw(scene, 3, 8).values()
    assert draw(scene, 3, 7).values() != draw(scene, 4, 7).values()


@pytest.mark.parametrize("scene", CATALOGUE)
def test_every_setting_that_can_do_anything_is_drawn_sooner_or_later(scene):
    kind = CATALOGUE[scene].settings
    definitions = kind.definitions()
    never = set(KEPT - {"method"})
    if len(definitions["start"].objects) == 1:
        never |= {"start"}
    left = set(definitions)
    for row in range(3000):
        left -= set(draw(scene, 1, row).changed())
        if left == never:
            break
    assert left == never


@pytest.mark.parametrize("scene", CATALOGUE)
def test_a_run_is_bounded_by_its_mesh_times_its_instants(scene):
    for row in range(100):
        settings = draw(scene, 2, row)
        elements = settings.elements * getattr(settings, "elements_up", 1)
        assert elements * settings.instants <= LARGEST_FIELD


@pytest.mark.parametrize("scene", CATALOGUE)
def test_tables_with_peaks_between_instants_are_drawn(scene):
    narrow = 0
    for row in range(200):
        settings = draw(scene, 6, row)
        for name in settings.paths:
            table = getattr(settings, name)
            if not isinstance(table, str) and len(table) > 2:
                widths = np.diff(np.array(table)[:, 0]) * settings.instants / settings.duration
                narrow += np.any((widths[:-1] < 0.5) & (widths[1:] < 0.5))
    assert narrow >= 1


@pytest.mark.parametrize("scene", CATALOGUE)
def test_the_command_that_repeats_a_row_gives_the_same_settings(scene):
    for number in range(30):
        settings = draw(scene, 5, number)
        words = shlex.split(random_case(settings, 5, number).command)
        assert words[:5] == ["python", "-m", "solver", "run", scene]
        assert settings_from_command(scene, words[6::2])[0].values() == settings.values()


def test_factors_on_k_are_foolish_together_or_alone():
    settings = CATALOGUE["bar"].settings
    assert not is_foolish(settings.checked({"k_scale": 10.0}))
    assert is_foolish(settings.checked({"k_scale": 11.0}))
    assert is_foolish(settings.checked({"k_scale": 0.2, "k_friction_scale": 0.2}))


@pytest.mark.parametrize(
    ("outcome", "verdict"),
    [
        (GOOD, Verdict.RIGHT),
        (changed(error_force=0.021), Verdict.WRONG),
        (changed(error_force=math.nan), Verdict.WRONG),
        (changed(error_force=0.5, doubt="several"), Verdict.UNCLEAR),
        (changed(error_force=0.5, ending=Ending.STALLED), Verdict.UNSOLVED),
        (changed(ending=Ending.STALLED), Verdict.RIGHT),
        (changed(error_force=0.5, certified=True, residual=1e-13), Verdict.WRONG),
        (changed(advice=""), Verdict.WRONG),
        (changed(error_force=0.5, doubt="several", certified=True, residual=1e-13), Verdict.RIGHT),
        (changed(certified=True, residual=2.0 * AT_ROUNDING), Verdict.WRONG),
        (changed(certified=True, residual=3e-7, floor=3e-7), Verdict.RIGHT),
        (changed(certified=True), Verdict.WRONG),
        (changed(finite=False), Verdict.WRONG),
        (Outcome(BROKEN, "ValueError: no"), Verdict.WRONG),
        (Outcome(REFUSED, "k_scale = 1 is refused"), Verdict.REFUSED),
    ],
)
def test_the_verdict_follows_from_errors_residual_and_status(outcome, verdict):
    assert judge(outcome, force=0.02) is verdict


def test_a_larger_accuracy_allows_a_larger_error_of_the_force():
    settings = CATALOGUE["bar"].settings
    found = changed(error_force=0.015, error_displacement=0.5)
    for accuracy, verdict in ((0.1, Verdict.RIGHT), (0.01, Verdict.WRONG)):
        trial = random_case(settings.checked({"accuracy": accuracy}), 1, 1)
        assert JudgedRun(trial, found).verdict is verdict


def test_an_error_of_the_displacement_counts_where_it_is_limited():
    assert judge(changed(error_displacement=0.5), 0.02, 0.02) is Verdict.WRONG


@pytest.mark.parametrize("scene", SMALL)
def test_the_equations_alone_tell_a_solution_from_what_is_near_it(scene):
    problem = discretise(CATALOGUE[scene].settings.checked(SMALL[scene]))
    found = reference_of(problem)
    fields = SimpleNamespace(displacement=found.displacement, contact_force=found.contact_force)
    assert kkt_residual(fields, problem) < AT_ROUNDING
    weaker = SimpleNamespace(
        displacement=found.displacement, contact_force=0.999 * found.contact_force
    )
    further = SimpleNamespace(
        displacement=1.001 * found.displacement, contact_force=found.contact_force
    )
    assert kkt_residual(weaker, problem) > 100.0 * AT_ROUNDING
    assert kkt_residual(further, problem) > 100.0 * AT_ROUNDING


def test_the_command_writes_a_table_and_a_page_of_its_own(tmp_path, capsys):
    command = ["stability", "bar", "--random", "3", "--seed", "1", "--out", str(tmp_path)]
    assert main(command) == 0
    table, page = (tmp_path / f"stability.{kind}" for kind in ("csv", "html"))
    with table.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["case"] for row in rows] == [f"row {number} of seed 1" for number in range(3)]
    text = page.read_text(encoding="utf-8")
    assert text.count("<tr>") >= 4
    assert "http" not in text
    assert "median iterations" in capsys.readouterr().out


def test_a_random_report_that_is_ended_keeps_what_is_done(tmp_path, monkeypatch):
    def end(trials, **options):
        yield JudgedRun(next(trials), GOOD)
        raise KeyboardInterrupt

    monkeypatch.setattr(report_commands, "judged_runs", end)
    assert main(["stability", "bar", "--random", "3", "--out", str(tmp_path)]) == 130
    with (tmp_path / "stability.csv").open(encoding="utf-8", newline="") as file:
        assert len(list(csv.DictReader(file))) == 1


def test_numbers_without_sense_are_refused(tmp_path, capsys):
    assert main(["stability", "--random", "0", "--out", str(tmp_path)]) == 2
    assert "--random = 0 is refused" in capsys.readouterr().err


def test_a_wrong_row_is_listed_with_what_repeats_it():
    wrong = JudgedRun(
        random_case(draw("bar", 9, 4), 9, 4), changed(error_force=0.5, error_displacement=1)
    )
    right = JudgedRun(random_case(draw("bar", 9, 5), 9, 5), changed(error_force=0.0))
    report = StabilityReport([wrong, right], RANDOM_TITLE, RANDOM_NOTES)
    text = "\n".join(report.lines())
    assert wrong.case.command in text
    assert right.case.command not in text
    assert "1 of 2 runs pass" in text
    assert not report.passes
    counted = {verdict: runs for verdict, runs, _ in report.counts()[1:]}
    assert counted == {"right": "1", "unsolved": "0", "refused": "0", "unclear": "0", "wrong": "1"}


def test_runs_that_did_not_converge_are_counted_by_whether_a_status_step_may_end_them():
    settings = CATALOGUE["bar"].settings
    missed = changed(ending=Ending.EXHAUSTED)
    rows = [
        JudgedRun(random_case(settings.checked({"method": "paper"}), 9, 4), missed),
        JudgedRun(random_case(settings.checked({}), 9, 5), GOOD),
        JudgedRun(random_case(settings.checked({}), 9, 6), Outcome(REFUSED, "peak = 1 is refused")),
    ]
    assert [row[1:] for row in missed_table(rows)[1:]] == [
        ["1", "0", "0.0 %", "0"],
        ["1", "1", "100.0 %", "1"],
        ["2", "1", "50.0 %", "1"],
    ]
