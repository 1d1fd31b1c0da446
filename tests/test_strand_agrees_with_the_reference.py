"""Strands solved over all instants at once and instant by instant are the same strands."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from solver.cli import main
from solver.latin import solve
from solver.reference.choice import reference_of
from solver.reference.distance import determinate_forces, distance_to
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.block import BlockSettings
from solver.scenes.layers import LayersSettings
from solver.scenes.method import method_of
from solver.scenes.strand import StrandSettings, strand
from solver.study.speed.error_against_time import (
    GOAL,
    INCREMENTAL,
    error_against_time,
    forms_of,
)

SMALL = {"elements": 24, "substructures": 4, "instants": 21, "break_position": 0.375}
FAST = {"finish": "none"}
"""The iteration itself has to get there, without a solver that is much like the reference."""
GRIPPED = {"grip": "displacement"}


def options(**changes: object) -> StrandSettings:
    return StrandSettings.checked({**SMALL, **FAST, **changes})


@pytest.mark.parametrize("grip", ["force", "displacement"])
@pytest.mark.parametrize(
    ("wires", "broken"), [(2, 1), (2, 2), (3, 2), (5, 1), (5, 3), (5, 4), (8, 2)]
)
def test_converged_latin_is_the_reference(wires, broken, grip):
    settings = options(wires=wires, broken=broken, grip=grip, tolerance=1e-20)
    problem = discretise(settings)
    reference = reference_of(problem)
    assert reference.converged.all()
    assert reference.residual <= 1e-10
    last = solve(problem, method_of(settings), distance=distance_to(reference, problem)).records[-1]
    assert last.error_displacement < 1e-6
    assert last.error_force < 1e-6


@pytest.mark.parametrize("wires", [3, 5, 12, 30])
def test_only_the_four_forces_at_an_inner_break_balance_each_other(wires):
    problem = discretise(options(wires=wires, broken=2))
    left_out = ~determinate_forces(problem)
    assert np.all(left_out.sum(axis=0) == 4)
    at_the_break = [
        np.isclose(law.positions, SMALL["break_position"])
        if name in ("contact 1-2", "contact 2-3")
        else np.zeros(len(law.positions), dtype=bool)
        for name, law in problem.rubbing.items()
    ]
    np.testing.assert_array_equal(left_out[:, 0], np.concatenate(at_the_break))


@pytest.mark.parametrize("change", [{"broken": 0}, {"broken": 1}, {"broken": 1, "wires": 2}])
def test_at_an_edge_or_without_a_break_every_force_counts(change):
    assert determinate_forces(discretise(options(**change))).all()


@pytest.mark.parametrize("grip", ["force", "displacement"])
def test_where_nothing_rubs_the_force_error_is_relative_to_what_pulls(grip):
    settings = options(broken=0, wires=4, grip=grip)
    problem, pull = discretise(settings), strand(settings).load
    reference = reference_of(problem)
    assert np.abs(reference.contact_force).max() < 1e-10
    wrong = replace(reference, contact_force=reference.contact_force + 0.01 * pull)
    found = distance_to(reference, problem).of_friction_force(wrong)
    # Each of these forces is one per cent of what pulls each of the four wires.
    assert found == pytest.approx(0.01 * np.sqrt(len(wrong.contact_force) / 4.0), rel=1e-9)


def test_friction_however_small_counts_where_it_is_at_its_bound():
    settings = BarSettings.checked(
        {"method": "paper", "friction": 1e-12, "instants": 11, "elements": 10}
    )
    problem = discretise(settings)
    reference = reference_of(problem)
    nothing = replace(reference, contact_force=0.0 * reference.contact_force)
    assert distance_to(reference, problem).of_friction_force(nothing) == pytest.approx(1.0)


def test_without_any_load_the_error_is_absolute():
    problem = discretise(options(broken=0, **GRIPPED, peak=0.0))
    reference = reference_of(problem)
    some = replace(reference, contact_force=reference.contact_force + 1.0)
    assert distance_to(reference, problem).of_friction_force(some) > 1.0


@pytest.mark.parametrize("change", [{"substructures": 1}, {"substructures": 1, "broken": 0}])
def test_wires_have_macro_forces_between_them_even_where_they_are_not_cut(change):
    settings = options(wires=4, **change)
    assert settings.applies("multiscale")
    assert settings.n_substructures == len(discretise(settings).substructures)
    assert discretise(settings).has_cuts


@pytest.mark.parametrize(
    "settings",
    [
        BarSettings.checked({"method": "paper", "substructures": 1}),
        BarSettings.checked({"method": "paper", "substructures": 3}),
        BlockSettings.checked({"substructures": 1, "substructures_up": 1}),
        LayersSettings.checked({"substructures": 1, "layers": 2}),
    ],
    ids=lambda settings: f"{settings.scene} {settings.n_substructures}",
)
def test_multiscale_is_offered_where_there_are_macro_forces(settings):
    problem = discretise(settings)
    assert settings.n_substructures == len(problem.substructures)
    assert settings.applies("multiscale") == problem.has_cuts


@pytest.mark.parametrize("change", [{}, GRIPPED, {"broken": 0}, {"wires": 5, "substructures": 1}])
def test_the_command_line_knows_the_errors_of_strands(change, capsys):
    changes = [f"--set={name}={value}" for name, value in {**SMALL, **FAST, **change}.items()]
    assert main(["run", "strand", *changes, "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["error_displacement"] < 2e-3
    assert printed["error_force"] < 2e-2


def test_a_study_of_strands_compares_all_forms_with_the_reference():
    settings = options(elements=12, instants=7, peak=300.0)
    study = error_against_time(settings, repeats=1)
    assert [course.method for course in study.curves] == [*forms_of(settings), INCREMENTAL]
    best = min(course.error_force.min() for course in study.curves if course.kind == "latin")
    assert best <= GOAL
