"""Whatever the settings of any scene but the bar: a run ends finite, with a known status.

SLIPFRONT_RANDOM_RUNS=500 makes that many runs of each scene, other ones each time.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st
from test_random_settings import RANDOM, RUNS, WRONG, with_others

from solver.definitions import SettingError
from solver.latin import Ending, solve
from solver.reference.choice import reference_of
from solver.reference.condensation import NoReferenceError
from solver.reference.distance import distance_to
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of

FEW = settings(RANDOM, max_examples=int(RUNS or 6))
TIGHTLY = settings(RANDOM, max_examples=int(RUNS or 12))
SIZES = {
    "strand": {"elements": (2, 12), "wires": (2, 5), "instants": (1, 10)},
    "block": {"elements": (1, 8), "elements_up": (1, 4), "instants": (1, 8)},
    "layers": {"elements": (1, 8), "elements_up": (1, 2), "layers": (2, 3), "instants": (1, 8)},
    "fault": {"elements": (1, 8), "elements_up": (1, 4), "instants": (1, 8)},
    "incline": {"elements": (1, 8), "elements_up": (1, 4), "instants": (1, 8)},
    "rope": {"elements": (2, 12), "layers": (1, 2), "instants": (1, 10)},
}
CUTS = {"substructures": "elements", "substructures_up": "elements_up"}
TIGHT = {"max_iterations": 200, "linear_stage": "full"}


@st.composite
def values(draw, scene, power):
    """Any values in their ranges, for few or for most of the settings; the rest keep defaults."""
    definitions = CATALOGUE[scene].settings.definitions()
    chosen = {name: draw(st.integers(*bounds)) for name, bounds in SIZES[scene].items()}
    for cut, elements in CUTS.items():
        if cut in definitions:
            chosen[cut] = draw(st.integers(1, chosen[elements]))
    if scene == "strand":
        chosen["broken"] = draw(st.integers(0, chosen["wires"]))
    if power is None:
        chosen["max_iterations"] = draw(st.integers(1, 60))
    else:
        chosen |= {"tolerance": 10.0 ** draw(power), **TIGHT}
    return with_others(draw, definitions, chosen)


@pytest.mark.parametrize("scene", SIZES)
@FEW
@given(st.data())
def test_any_run_ends_finite_with_a_status_or_is_refused(scene, data):
    assert_ends(scene, data.draw(values(scene, None)))


@pytest.mark.parametrize("scene", SIZES)
@TIGHTLY
@given(st.data())
def test_whatever_is_called_converged_at_a_tight_tolerance_is_right(scene, data):
    assert_ends(scene, data.draw(values(scene, st.floats(-30.0, -16.0))))


def assert_ends(scene, raw):
    try:
        chosen = CATALOGUE[scene].settings.checked(raw)
    except SettingError:
        event("refused")
        return
    problem = discretise(chosen)
    try:
        reference = reference_of(problem)
    except NoReferenceError:
        event("not held")
        reference = None
    distance = None if reference is None else distance_to(reference, problem)
    try:
        solution = solve(problem, method_of(chosen), distance=distance)
    except SettingError:
        event("refused")
        return
    ending = solution.status.ending
    event(str(ending))
    assert ending in set(Ending)
    assert solution.status.advice
    if ending is not Ending.DIVERGED or solution.records:
        assert np.isfinite(solution.iterate.displacement).all()
        assert np.isfinite(solution.iterate.contact_force).all()
    for entry in solution.records:
        assert math.isfinite(entry.indicator)
        assert not math.isnan(entry.behaviour)
        assert not (reference and math.isnan(entry.error_displacement + entry.error_force))
    if ending is Ending.CONVERGED and reference is not None:
        assert_right(chosen, reference, solution)


def assert_right(chosen, reference, solution):
    last = solution.records[-1]
    if chosen.tolerance > 1e-16 or not reference.contact_force.any():
        return
    if reference.ambiguous.any() or not reference.converged.all():
        event("several solutions, or none")
        return
    event("converged tightly")
    assert last.error_displacement <= WRONG
    assert last.error_force <= WRONG
