"""The strand is one more scene of the same engine: all options reach the same solution on it."""

from __future__ import annotations

import numpy as np
import pytest

from solver.definitions import SettingError
from solver.latin import Ending, solve
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.scenes.strand import StrandSettings

SMALL = {"elements": 24, "substructures": 4, "instants": 21, "break_position": 0.375}
PLAIN = {"method": "paper"}
TIGHT = {"tolerance": 1e-16, "max_iterations": 4000}
PGD = {"linear_stage": "pgd"}
FAST = {"search_direction": "auto", "acceleration": "anderson"}


def options(**changes: object) -> StrandSettings:
    return StrandSettings.checked({**SMALL, **PLAIN, **TIGHT, **changes})


def solution_of(settings):
    found = solve(discretise(settings), method_of(settings), watch=False)
    assert found.status.ending is Ending.CONVERGED
    return found.iterate


@pytest.fixture(scope="module")
def known():
    return solution_of(options(**FAST, tolerance=1e-24))


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
        {**FAST, "start": "nested"},
        {"search_direction": "auto", "start": "nested"},
        {**PGD, "pgd_modes": 60, "pgd_tolerance": 1e-14, "tolerance": 1e-13},
        {"substructures": 1, "acceleration": "anderson"},
        {"substructures": 2, **FAST},
        {"substructures": 7, **FAST},
        {"substructures": 24, **FAST},
    ],
    ids=str,
)
def test_every_method_and_any_number_of_substructures_reach_the_same_solution(known, change):
    assert apart(solution_of(options(**change)), known) < 2e-5


@pytest.mark.parametrize("change", [{}, {"pgd_sharing": 0.3}, {"wires": 6}])
def test_separated_bases_come_close(change):
    settings = options(linear_stage="pgd", max_iterations=60, **change)
    found = solve(discretise(settings), method_of(settings), watch=False).iterate
    exact = solution_of(settings.replace(linear_stage="full", max_iterations=4000, **FAST))
    gap = np.linalg.norm(found.displacement - exact.displacement)
    assert gap < 0.03 * np.linalg.norm(exact.displacement)


@pytest.mark.parametrize(
    ("change", "name", "words"),
    [
        ({"wires": 3, "broken": 4}, "broken", "0 to wires (3)"),
        ({"elements": 5, "substructures": 6}, "substructures", "1 to elements (5)"),
        ({"load": [[0.0, 0.0], [1.0, -5.0]]}, "load", "wires cannot be pushed"),
        ({"peak": 2000.0}, "peak", "tensions below 1500 N"),
        ({"peak": 800.0, "broken": 1}, "peak", "tensions below 750 N"),
        ({"friction": 0.0}, "peak", "raise friction or pressure"),
        ({"load": [[0.0, 1500.0]]}, "load", "move the break to the left"),
        ({"wires": 200, "elements": 2000, "instants": 101}, "instants", "fewer instants"),
    ],
    ids=str,
)
def test_what_makes_no_strand_is_refused_in_words(change, name, words):
    with pytest.raises(SettingError, match=f"^{name} = ") as refused:
        StrandSettings.checked(change)
    assert words in str(refused.value)


def test_a_grip_of_given_displacement_needs_no_friction():
    assert StrandSettings.checked({"friction": 0.0, "grip": "displacement"}).friction == 0.0
    assert StrandSettings.checked({"friction": 0.0, "broken": 0}).broken == 0
    assert StrandSettings.checked({"friction": 0.0, "peak": 0.0}).peak == 0.0


def test_changes_bring_along_what_could_not_stand_beside_them():
    settings = StrandSettings.checked({"broken": 3})
    assert settings.with_change("wires", 2).broken == 2
    assert settings.with_change("elements", 4).substructures == 4
    assert settings.with_change("peak", 100.0).peak == 100.0
