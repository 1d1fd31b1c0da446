"""The paper's figures, written by `python -m solver figures`, say what it says.

The paper prints curves without numbers. The gains of Figs. 3 and 4 are those of another
code for the same equations, within 20 %; the limits of Figs. 5 to 8 are set around what
the engine gives for the default load, wide enough for another order of rounding and too
tight for another answer.
"""

from __future__ import annotations

import html
import re
from itertools import islice

import numpy as np
import pytest

from solver.commands import reports as report_commands
from solver.commands.cli import main
from solver.latin import Ending, iterations, solve
from solver.reduction.svd import front_decay
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of
from solver.study.paper_figures import figure_5, figure_6, figure_8, paper_figures
from solver.study.paper_runs import PaperRuns, paper_runs

NUMBERS = (3, 4, 5, 6, 7, 8)


@pytest.fixture(scope="module")
def runs() -> PaperRuns:
    return paper_runs()


@pytest.fixture(scope="module")
def figures(runs):
    return paper_figures(runs)


@pytest.fixture(scope="module")
def written(tmp_path_factory, figures):
    folder = tmp_path_factory.mktemp("made") / "by" / "the command"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report_commands, "paper_runs", lambda: None)
        patch.setattr(report_commands, "paper_figures", lambda runs: figures)
        assert main(["figures", "--out", str(folder)]) == 0
    return folder


def test_the_page_stands_alone_and_shows_every_figure_with_claim_numbers_and_caption(
    written, figures
):
    page = (written / "figures.html").read_text(encoding="utf-8")
    assert page.count("data-root-id") == sum(len(figure.panels) for figure in figures)
    assert not re.search(r"<link|<script src|<img|@import", page)
    plain = html.unescape(page)
    for figure in figures:
        for words in (figure.claim, figure.caption, figure.title, figure.verdict):
            assert words in plain
        for found in figure.findings:
            assert found.text in plain


@pytest.mark.parametrize(
    "obstacle", ["folder is a file", "page is a folder", "parent is a file"]
)
def test_a_folder_that_cannot_be_written_to_is_refused_in_one_line(
    tmp_path, capsys, obstacle
):
    folder = tmp_path / "out"
    if obstacle == "page is a folder":
        (folder / "figures.html").mkdir(parents=True)
    else:
        folder.write_text("in the way", encoding="utf-8")
    if obstacle == "parent is a file":
        target = folder / "below"
    else:
        target = folder
    assert main(["figures", "--out", str(target)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
    assert "--out" in err
    assert "a folder that can be made and written to" in err


BENCHMARK = {"load": "sine", "peak": 900.0, "substructures": 10, "relaxation": 0.8}
WITHIN = 0.2


def options(**values):
    return BarSettings.checked({"method": "paper"} | BENCHMARK | values)


@pytest.fixture(scope="module")
def histories(runs):
    return {True: runs.multiscale.records, False: runs.monoscale.records}


def first_below(records, name, limit):
    return next(entry.iteration for entry in records if getattr(entry, name) <= limit)


def imbalance(problem, iterate):
    """Imbalance P^T F - P^T F_d, relative to the largest load."""
    basis, load = problem.macro
    return np.abs(basis.T @ iterate.boundary_force - load).max() / np.abs(load).max()


@pytest.mark.parametrize(
    ("name", "limit", "multi", "mono"),
    [
        ("indicator", 1e-4, 19, 28),
        ("indicator", 1e-6, 40, 81),
        ("error_displacement", 0.01, 36, 111),
        ("error_force", 0.01, 102, 155),
    ],
)
def test_both_versions_pass_a_level_where_an_independent_code_does(
    histories, name, limit, multi, mono
):
    found = {
        multiscale: first_below(records, name, limit)
        for multiscale, records in histories.items()
    }
    assert found[True] == pytest.approx(multi, rel=WITHIN)
    assert found[False] == pytest.approx(mono, rel=WITHIN)


def test_later_both_versions_converge_at_the_same_rate(histories):
    rates = {}
    for multiscale, records in histories.items():
        tail = np.log([entry.indicator for entry in records[400:800]])
        rates[multiscale] = np.polyfit(np.arange(len(tail)), tail, 1)[0]
    assert rates[True] < 0.0
    assert rates[True] == pytest.approx(rates[False], rel=WITHIN)


@pytest.mark.parametrize(
    "change", [{}, {"elements": 53, "substructures": 7}, {"body_force": 900.0}]
)
def test_macro_forces_of_the_multiscale_linear_stage_are_in_equilibrium(change):
    chosen = options(relaxation=1.0, **change)
    problem = discretise(chosen)
    for iterate in islice(iterations(problem, method_of(chosen)), 30):
        assert imbalance(problem, iterate) < 1e-12


def test_monoscale_without_relaxation_stalls_far_from_the_answer():
    chosen = options(relaxation=1.0, multiscale=False)
    problem = discretise(chosen)
    distance = distance_to(reference_of(problem), problem)
    solution = solve(problem, method_of(chosen), distance=distance, watch=False)
    assert solution.status.ending is Ending.STALLED
    assert "relaxation" in solution.status.advice
    assert solution.records[-1].indicator > 1e-3
    assert solution.records[-1].error_force > 0.1


def test_fig_5_stuck_substructures_need_a_mode_and_swept_ones_decay_like_a_steady_front(
    runs,
):
    last = runs.five.iterate
    parts = runs.friction_forces
    distance = distance_to(runs.reference, last.problem)
    assert runs.noise == distance.of_friction_force(last) < 1e-5
    assert distance.of_displacement(last) < 1e-6
    noise = runs.noise * max(part.values[0] for part in parts)
    assert parts[0].values[0] < noise
    assert parts[1].modes_for(0.01) == 1
    assert min(part.modes_for(0.01) for part in parts[2:]) >= 10
    decays = [part.values[:5] / part.values[0] / front_decay(5) for part in parts[2:]]
    assert 0.5 < np.min(decays) < 1.0 < np.max(decays) < 1.4
    assert figure_5(runs).verdict == "holds"


def test_fig_6_modes_of_substructures_4_and_5_are_alike_and_later_ones_more_local(runs):
    third, fourth, fifth = runs.friction_forces[2:]  # the third is swept in part
    assert np.abs(fourth.correlations(fifth.space_modes))[[0, 2, 4]].min() > 0.98
    found = np.abs(third.correlations(fifth.space_modes))
    assert found[4] < 0.85 < found[0]
    assert "change sign 0, 2, 4 and 0, 2, 4 times" in figure_6(runs).findings[1].text


def test_fig_7_the_displacement_is_far_more_reducible_than_the_friction_force(runs):
    displacement = runs.displacements[-1]
    force = runs.friction_forces[-1]
    assert (
        displacement.errors[3]
        < 0.003
        < displacement.errors[2]
        < 0.01
        < displacement.errors[1]
    )
    assert displacement.modes_for(0.01) <= 3
    assert force.modes_for(0.01) >= 10


def test_fig_8_pgd_modes_orthonormalised_in_their_order_are_the_svd_modes(runs):
    texts = [finding.text for finding in figure_8(runs).findings]
    ordered, kept = (
        list(map(float, re.findall(r"\d\.\d+", text))) for text in texts[:2]
    )
    assert min(ordered[:2]) > 0.99
    assert ordered[2] > 0.97
    assert max(kept[1:]) < 0.9 < 0.99 < kept[0]
    last = runs.five_reduced.records[-1]
    assert last.error_displacement < 0.01 < last.error_force < 0.2
    assert max(basis.n_modes for basis in runs.five_reduced.iterate.bases) <= 11
