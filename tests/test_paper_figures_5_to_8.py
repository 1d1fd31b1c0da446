"""The reducibility that the paper's Figs. 5 to 8 show, measured; and where they do not show all.

The paper prints curves without numbers. Limits are set around what the engine gives for the default
load, a sine of 900 N, wide enough for another order of rounding and too tight for another answer.
"""

from __future__ import annotations

import numpy as np
import pytest

from solver.latin import solve
from solver.reduction.svd import InterfaceField, decompositions
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of
from solver.study.figures.modes import figure_5, figure_6, figure_7, figure_8


def test_the_analysed_solution_is_converged(paper_runs):
    last = paper_runs.five.records[-1]
    assert last.error_force < 1e-5
    assert last.error_displacement < 1e-6


def test_fig_5_the_stuck_substructures_need_a_mode_at_most_and_the_swept_ones_nearly_all(
    paper_runs,
):
    values = figure_5(paper_runs).values
    at_one_percent = [values[f"modes_{number}_0.01"] for number in range(1, 6)]
    assert at_one_percent[:2] == [0, 1]
    assert min(at_one_percent[2:]) >= 10
    assert [values[f"modes_{number}_0.1"] for number in (3, 4, 5)] == pytest.approx(
        [5, 5, 7], abs=1
    )
    assert max(values["fifth_1"], values["fifth_2"]) < 1e-6
    assert min(values[f"fifth_{number}"] for number in (3, 4, 5)) > 0.05


def test_fig_5_nothing_slides_in_the_first_substructure_so_it_has_nothing_to_reduce(paper_runs):
    rows = paper_runs.reference.status[:11]
    assert not rows.any()
    assert not paper_runs.reference.friction_force[1:10].any()


def test_fig_5_the_swept_substructures_decay_like_a_front_of_constant_speed(paper_runs):
    values = figure_5(paper_runs).values
    assert 0.5 < values["front_low"] < 1.0 < values["front_high"] < 1.4


def test_fig_5_depends_on_the_lost_load_path():
    chosen = BarSettings.checked(
        {"method": "paper", "substructures": 5, "peak": 1200.0, "tolerance": 1e-13}
    )
    found = solve(discretise(chosen), method_of(chosen), watch=False).iterate
    second = decompositions(found, InterfaceField.FRICTION_FORCE)[1]
    assert second.modes_for(0.01) >= 10


def test_fig_6_the_modes_of_substructures_4_and_5_are_alike(paper_runs):
    values = figure_6(paper_runs).values
    assert min(values[f"likeness_4_5_{order}"] for order in (1, 3, 5)) > 0.98


def test_fig_6_those_of_3_which_is_swept_in_part_are_less_so(paper_runs):
    third, _, fifth = paper_runs.friction_forces[2:]
    found = np.abs(third.correlations(fifth.space_modes))
    assert found[4] < 0.85 < found[0]


def test_fig_6_later_modes_are_more_local(paper_runs):
    values = figure_6(paper_runs).values
    assert [values[f"sign_changes_5_{order}"] for order in (1, 3, 5)] == [0, 2, 4]


def test_fig_7_the_displacement_is_far_more_reducible_than_the_friction_force(paper_runs):
    values = figure_7(paper_runs).values
    assert values["left_by_3"] < 0.003 < values["left_by_2"] < 0.01 < values["left_by_1"]
    assert values["modes_displacement"] <= 3
    assert values["modes_force"] >= 10


def test_fig_8_pgd_modes_orthonormalised_in_their_order_are_the_svd_modes(paper_runs):
    values = figure_8(paper_runs).values
    assert min(values["sorted_1"], values["sorted_2"]) > 0.99
    assert values["sorted_3"] > 0.97


def test_fig_8_as_they_are_kept_only_the_first_is(paper_runs):
    values = figure_8(paper_runs).values
    assert values["kept_1"] > 0.99
    assert max(values["kept_2"], values["kept_3"]) < 0.9


def test_fig_8_the_three_pgd_modes_span_what_the_three_svd_modes_span(paper_runs):
    exact = paper_runs.displacements[-1]
    right = figure_8(paper_runs).panels[1].curves
    root = np.sqrt(exact.space_weights)[:, None]
    pgd = np.stack([curve.y for curve in right if curve.label.startswith("PGD")], axis=1)
    basis, _ = np.linalg.qr(root * pgd)
    cosines = np.linalg.svd(basis.T @ (root * exact.space_modes[:, :3]), compute_uv=False)
    assert cosines.min() > 0.97


def test_fig_8_the_displacement_is_right_and_the_friction_force_is_not_yet(paper_runs):
    values = figure_8(paper_runs).values
    assert values["error_displacement"] < 0.01
    assert 0.01 < values["error_force"] < 0.2
    assert values["largest_basis"] <= 11
