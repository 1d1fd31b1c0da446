"""Strands solved over all instants at once and instant by instant are the same strands."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solver.latin import solve
from solver.reference.choice import reference_of
from solver.reference.distance import determinate_forces, distance_to
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of
from solver.scenes.strand import StrandSettings, strand

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
