"""A bar whose section varies: its stiffness, its search direction, its coarser meshes."""

from __future__ import annotations

import numpy as np
import pytest

from solver.definitions import SettingError
from solver.latin import solve
from solver.reference.assembly import assembled_stiffness
from solver.reference.distance import distance_to
from solver.reference.incremental import incremental
from solver.scenes import discretise
from solver.scenes.bar import BarSettings, bar
from solver.scenes.method import method_of

SMALL = {"elements": 24, "substructures": 4, "instants": 31}
GRADED = [[0.0, 100.0], [0.4, 1.0], [1.0, 3.0]]
NOTCHED = [[0.0, 1.0], [0.51, 1.0], [0.511, 0.01], [0.512, 0.01], [0.513, 1.0]]


def settings(**changes):
    return BarSettings.checked({"method": "paper", **SMALL, **changes})


def test_one_factor_everywhere_is_a_bar_of_that_section():
    times_seven = settings(section_profile=[[0.0, 7.0], [1.0, 7.0]])
    thicker = settings(section=7.0 * settings().section)
    found, same = (incremental(discretise(one)) for one in (times_seven, thicker))
    assert found.displacement == pytest.approx(same.displacement, rel=1e-12)
    assert found.friction_force == pytest.approx(same.friction_force, rel=1e-12)


@pytest.mark.parametrize("table", [GRADED, NOTCHED], ids=["graded", "notched"])
def test_every_element_is_as_stiff_as_all_that_lies_in_it(table):
    chosen = settings(section_profile=table, length=2.0)
    scene = bar(chosen)
    fine = np.linspace(0.0, 2.0, 24 * 20_000 + 1)
    middles = 0.5 * (fine[1:] + fine[:-1])
    compliance = np.mean(1.0 / np.interp(middles, *np.transpose(table)).reshape(24, -1), axis=1)
    assert scene.stiffness * scene.section == pytest.approx(
        chosen.young * chosen.section / compliance, rel=2e-4
    )
    stiffness = assembled_stiffness(discretise(chosen))
    assert -stiffness.diagonal(1) / 24 == pytest.approx(scene.section)
    assert abs(stiffness.sum(axis=1)).max() <= 1e-13 * abs(stiffness).max()


def test_a_bar_without_friction_stretches_by_the_mean_compliance():
    chosen = settings(section_profile="falling", friction=0.0, load="ramp")
    scene = bar(chosen)
    end = incremental(discretise(chosen)).displacement[-1, -1]
    assert end == pytest.approx(chosen.peak * scene.length / scene.stiffness)
    assert np.mean(1.0 / scene.section) == pytest.approx(1.0)


@pytest.mark.parametrize("options", [{}, {"search_direction": "auto", "start": "nested"}])
@pytest.mark.parametrize("profile", ["rising", "falling", GRADED])
def test_the_method_reaches_the_reference(options, profile):
    fast = {"acceleration": "anderson", "tolerance": 1e-20, **options}
    chosen = settings(section_profile=profile, **fast)
    problem = discretise(chosen)
    solution = solve(
        problem, method_of(chosen), distance=distance_to(incremental(problem), problem)
    )
    assert solution.status.ending == "converged"
    assert solution.records[-1].error_force <= 1e-6


@pytest.mark.parametrize(
    ("table", "allowed"),
    [
        ([[0.0, 1.0], [1.0, 0.0]], "above 0"),
        ([[0.0, 1.0], [1.0, -2.0]], "above 0"),
        ([[0.0, 1e-9]], "from 1e-8 to 1e8"),
        ([[0.0, 1e-4], [1.0, 1.1e4]], "at most 1e8 times"),
        ("gap", "uniform, rising, falling"),
    ],
)
def test_a_section_that_vanishes_or_is_too_uneven_is_refused(table, allowed):
    with pytest.raises(SettingError, match="section_profile") as refusal:
        settings(section_profile=table)
    assert allowed in str(refusal.value)
    settings(section_profile=[[0.0, 1e-4], [1.0, 1e4]])
