"""Strands are the same whatever the method, and instant by instant."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solver.latin import Ending, solve
from solver.reference.distance import determinate_forces, distance_to, kkt_residual
from solver.reference.incremental import reference_of
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.scenes.strand import StrandSettings
from solver.settings.values import SettingError

SMALL = {"elements": 16, "substructures": 4, "instants": 13, "break_position": 0.375}
FAST = {"finish": "none"}
"""The iteration itself has to get there, without a solver that is much like the
reference."""


def options(**changes: object) -> StrandSettings:
    return StrandSettings.checked(SMALL | FAST | changes)


@pytest.mark.parametrize("grip", ["force", "displacement"])
@pytest.mark.parametrize(("wires", "broken"), [(2, 1), (3, 2), (5, 4), (8, 2)])
def test_converged_latin_is_the_reference(wires, broken, grip):
    settings = options(wires=wires, broken=broken, grip=grip, tolerance=1e-20)
    problem = discretise(settings)
    reference = reference_of(problem)
    assert reference.converged.all()
    assert kkt_residual(reference, problem) <= 1e-10
    last = solve(problem, method_of(settings), watch=False).iterate
    distance = distance_to(reference, problem)
    assert distance.of_displacement(last) < 1e-6
    assert distance.of_friction_force(last) < 1e-6


@pytest.mark.parametrize("wires", [3, 5, 12, 30])
def test_only_the_four_forces_at_an_inner_break_balance_each_other(wires):
    problem = discretise(options(wires=wires, broken=2))
    left_out = ~determinate_forces(problem)
    assert np.all(left_out.sum(axis=0) == 4)
    at_the_break = [
        np.isclose(law.positions, SMALL["break_position"])
        if name in ("contact 1-2", "contact 2-3")
        else np.zeros(len(law.positions), dtype=bool)
        for name, law in problem.contacts.items()
    ]
    np.testing.assert_array_equal(left_out[:, 0], np.concatenate(at_the_break))


@pytest.mark.parametrize("grip", ["force", "displacement"])
def test_without_friction_the_force_error_is_relative_to_the_load(grip):
    settings = options(broken=0, wires=4, grip=grip)
    problem = discretise(settings)
    pull = settings.structure().load
    reference = reference_of(problem)
    assert np.abs(reference.contact_force).max() < 1e-10
    wrong = replace(reference, contact_force=reference.contact_force + 0.01 * pull)
    found = distance_to(reference, problem).of_friction_force(wrong)
    # Each of these forces is one per cent of what pulls each of the four wires.
    assert found == pytest.approx(
        0.01 * np.sqrt(len(wrong.contact_force) / 4.0), rel=1e-9
    )


PLAIN = {"method": "paper"}
TIGHT = {"tolerance": 1e-16, "max_iterations": 4000}
PGD = {"linear_stage": "pgd"}
ACCELERATED = {"search_direction": "auto", "acceleration": "anderson"}


def by_paper(**changes: object) -> StrandSettings:
    return StrandSettings.checked(SMALL | PLAIN | TIGHT | changes)


def solution_of(settings):
    found = solve(discretise(settings), method_of(settings), watch=False)
    assert found.status.ending is Ending.CONVERGED
    return found.iterate


@pytest.fixture(scope="module")
def known():
    return solution_of(by_paper(**ACCELERATED, tolerance=1e-24))


def apart(one, other):
    return max(
        float(np.linalg.norm(getattr(one, name) - getattr(other, name)))
        / float(np.linalg.norm(getattr(other, name)))
        for name in ("displacement", "friction_force")
    )


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"multiscale": False, "acceleration": "anderson"},
        {"relaxation": 0.6, "k_scale": 2.0},
        {**ACCELERATED, "start": "nested"},
        {"search_direction": "auto", "start": "nested"},
        {**PGD, "pgd_modes": 60, "pgd_tolerance": 1e-14, "tolerance": 1e-13},
        {"substructures": 1, "acceleration": "anderson"},
        {"substructures": 2, **ACCELERATED},
        {"substructures": 7, **ACCELERATED},
        {"substructures": 16, **ACCELERATED},
    ],
    ids=str,
)
def test_every_method_and_any_number_of_substructures_reach_the_same_solution(
    known, change
):
    assert apart(solution_of(by_paper(**change)), known) < 2e-5


@pytest.mark.parametrize(
    ("change", "name", "words"),
    [
        ({"wires": 3, "broken": 4}, "broken", "0 to wires (3)"),
        ({"elements": 5, "substructures": 6}, "substructures", "1 to elements (5)"),
        ({"load": [[0.0, 0.0], [1.0, -5.0]]}, "load", "raise the negative tension"),
        ({"peak": 2000.0}, "peak", "tensions below 1500 N"),
        ({"peak": 800.0, "broken": 1}, "peak", "tensions below 750 N"),
        ({"friction": 0.0}, "peak", "raise friction or pressure"),
        ({"load": [[0.0, 1500.0]]}, "load", "move the break to the left"),
        (
            {"wires": 200, "elements": 2000, "instants": 101},
            "instants",
            "fewer instants",
        ),
    ],
    ids=str,
)
def test_inconsistent_strands_are_refused_in_words(change, name, words):
    with pytest.raises(SettingError, match=f"^{name} = ") as refused:
        StrandSettings.checked(change)
    assert words in str(refused.value)


def test_changes_adjust_values_that_would_be_inconsistent():
    settings = StrandSettings.checked({"broken": 3})
    assert settings.with_change("wires", 2).broken == 2
    assert settings.with_change("elements", 4).substructures == 4
    assert settings.with_change("peak", 100.0).peak == 100.0
