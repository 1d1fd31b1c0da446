"""A survey draws wide settings, alike each time, and knows what is called converged wrongly."""

from __future__ import annotations

import csv
import dataclasses
import math
import shlex
from types import SimpleNamespace

import pytest

from solver.cli import main
from solver.files import settings_from_command
from solver.latin import Ending
from solver.reference.choice import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.study.survey import AT_ROUNDING, BROKEN, REFUSED, Outcome, Row, Verdict, judge
from solver.study.survey_draw import KEPT, LARGEST_FIELD, draw, is_foolish
from solver.study.survey_report import counts, table_of_missed, wrong_lines
from solver.study.survey_residual import kkt_residual

SMALL = {
    "bar": {"elements": 20, "substructures": 4, "instants": 11},
    "strand": {"elements": 12, "instants": 9},
    "block": {"elements": 12, "elements_up": 6, "instants": 9},
    "layers": {"elements": 12, "elements_up": 1, "instants": 9},
    "incline": {"elements": 12, "elements_up": 6, "instants": 9},
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
    drawn = {name for row in range(400) for name in draw(scene, 1, row).changed()}
    definitions = kind.definitions()
    never = set(KEPT - {"method"})
    if len(definitions["local_stage"].objects) == 1:
        never |= {name for name in definitions if name.startswith("local_")}
    if len(definitions["start"].objects) == 1:
        never |= {"start"}
    assert set(definitions) - drawn == never


@pytest.mark.parametrize("scene", CATALOGUE)
def test_a_run_is_bounded_by_its_mesh_times_its_instants(scene):
    for row in range(100):
        settings = draw(scene, 2, row)
        elements = settings.elements * getattr(settings, "elements_up", 1)
        assert elements * settings.instants <= LARGEST_FIELD


@pytest.mark.parametrize("scene", CATALOGUE)
def test_the_command_that_repeats_a_row_gives_the_same_settings(scene):
    for number in range(30):
        row = Row(draw(scene, 5, number), 5, number, GOOD, Verdict.WRONG)
        words = shlex.split(row.command)
        assert words[:5] == ["python", "-m", "solver", "run", scene]
        assert settings_from_command(scene, words[6::2]).values() == row.settings.values()


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
        (changed(error_force=0.5, doubt="several", certified=True, residual=1e-13), Verdict.RIGHT),
        (changed(certified=True, residual=2.0 * AT_ROUNDING), Verdict.WRONG),
        (changed(certified=True, residual=3e-7, floor=3e-7), Verdict.RIGHT),
        (changed(certified=True), Verdict.WRONG),
        (changed(finite=False), Verdict.WRONG),
        (Outcome(BROKEN, "ValueError: no"), Verdict.WRONG),
        (Outcome(REFUSED, "k_scale = 1 is refused"), Verdict.UNSOLVED),
    ],
)
def test_the_verdict_follows_from_errors_residual_and_status(outcome, verdict):
    assert judge(outcome, accuracy=0.01) is verdict


def test_a_larger_accuracy_allows_a_larger_error():
    assert judge(changed(error_force=0.15), accuracy=0.1) is Verdict.RIGHT


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
    assert main(["survey", "bar", "--runs", "3", "--seed", "1", "--out", str(tmp_path)]) == 0
    table, page = (tmp_path / f"survey.{kind}" for kind in ("csv", "html"))
    with table.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["row"] for row in rows] == ["0", "1", "2"]
    text = page.read_text(encoding="utf-8")
    assert text.count("<tr>") >= 4
    assert "http" not in text
    assert "median iterations" in capsys.readouterr().out
    main(["survey", "bar", "--row", "1", "--seed", "1", "--out", str(tmp_path)])
    with table.open(encoding="utf-8", newline="") as file:
        (alone,) = csv.DictReader(file)
    assert alone["settings"] == rows[1]["settings"]
    assert alone["error_force"] == rows[1]["error_force"]


def test_numbers_without_sense_are_refused(tmp_path, capsys):
    assert main(["survey", "--runs", "0", "--out", str(tmp_path)]) == 2
    assert "--runs = 0 is refused" in capsys.readouterr().err


def test_a_wrong_row_is_listed_with_what_repeats_it():
    wrong = Row(draw("bar", 9, 4), 9, 4, changed(error_force=0.3), Verdict.WRONG)
    right = Row(draw("bar", 9, 5), 9, 5, GOOD, Verdict.RIGHT)
    text = "\n".join(wrong_lines([wrong, right]))
    assert "survey bar --seed 9 --row 4" in text
    assert wrong.command in text
    assert "--row 5" not in text
    found = {verdict: runs for verdict, runs, _ in counts([wrong, right])[1:]}
    assert found == {"right": "1", "unsolved": "0", "unclear": "0", "wrong": "1"}


def test_runs_that_did_not_converge_are_counted_by_whether_a_status_step_may_end_them():
    settings = CATALOGUE["bar"].settings
    missed = changed(ending=Ending.EXHAUSTED)
    rows = [
        Row(settings.checked({"method": "paper"}), 9, 4, missed, Verdict.UNSOLVED),
        Row(settings.checked({}), 9, 5, GOOD, Verdict.RIGHT),
    ]
    assert [row[1:] for row in table_of_missed(rows)[1:]] == [
        ["1", "0", "0.0 %", "0"],
        ["1", "1", "100.0 %", "1"],
        ["2", "1", "50.0 %", "1"],
    ]
