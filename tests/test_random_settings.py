"""Whatever the settings, a run ends with finite fields and a known status, or is refused in words.

SLIPFRONT_RANDOM_RUNS=500 makes that many runs of each scene, other ones each time, instead of a
few.
"""

from __future__ import annotations

import math
import os

import numpy as np
import param
import pytest
from hypothesis import HealthCheck, event, given, settings
from hypothesis import strategies as st

from solver.definitions import CurveParameter, SettingError
from solver.latin import Ending, solve
from solver.reference.condensation import NoReferenceError
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of

RUNS = os.environ.get("SLIPFRONT_RANDOM_RUNS")
RANDOM = settings(
    derandomize=RUNS is None,
    database=None,
    max_examples=int(RUNS or 8),
    print_blob=True,
    suppress_health_check=list(HealthCheck),
)
TIGHT, WRONG = 1e-16, 1e-3
SIZES = {
    "bar": {"elements": (1, 30), "instants": (1, 30)},
    "strand": {"elements": (2, 12), "wires": (2, 5), "instants": (1, 10)},
    "block": {"elements": (1, 8), "elements_up": (1, 4), "instants": (1, 8)},
    "layers": {"elements": (1, 8), "elements_up": (1, 2), "layers": (2, 3), "instants": (1, 8)},
    "fault": {"elements": (1, 8), "elements_up": (1, 4), "instants": (1, 8)},
    "incline": {"elements": (1, 8), "elements_up": (1, 4), "instants": (1, 8)},
    "rope": {"elements": (2, 12), "layers": (1, 2), "instants": (1, 10)},
    "wall": {
        **{"elements": (1, 4), "elements_up": (1, 3), "instants": (1, 8)},
        **{"bricks": (1, 3), "courses": (1, 3)},
    },
}
"""Bounds that keep a run short; all other settings go over their whole range."""
MOST = {"pgd_modes": 20, "pgd_pairs": 5}
CUTS = {"substructures": "elements", "substructures_up": "elements_up"}
SECTION = (1e-4, 1e4)
"""Range of the factors on the section: their contrast is bounded, so most tables are refused."""
METHODS = [
    {"method": "fast"},
    {"method": "paper"},
    {"method": "paper", "search_direction": "auto", "acceleration": "anderson", "start": "nested"},
]
DECADES = 12.0
"""Decades below one that a value may be small by, where its range begins at zero."""


def sizes(low, high):
    """Positive numbers of any size in a range, all decades alike, and its two ends."""
    exponents = st.floats(math.log10(low), math.log10(high))
    return exponents.map(lambda power: min(max(10.0**power, low), high)) | st.sampled_from(
        [low, high]
    )


def numbers(low, high):
    """Numbers of any size and of all allowed signs."""
    if low > 0.0:
        return sizes(low, high)
    positive = sizes(10.0**-DECADES, high)
    signed = positive if low == 0.0 else positive | positive.map(lambda size: -size)
    return st.just(0.0) | signed


def tables(definition, extent):
    """Points of any size: plateaus, jumps and reversals among them."""
    low = 0.0 if definition.columns[1] in ("factor", "pressure") else -1e15
    values = numbers(low, 1e15) | st.sampled_from([0.0, 900.0, 1e-6, 1e6])
    return paired(values, extent)


def paired(values, extent):
    """Values at points over, before and beyond an extent."""
    places = st.lists(st.floats(-0.2, 1.2), min_size=1, max_size=8, unique=True).map(sorted)
    return st.tuples(places, st.lists(values, min_size=8, max_size=8)).map(
        lambda pair: [[place * extent, value] for place, value in zip(*pair, strict=False)]
    )


def of_each(count):
    """Factors on mu of so many interfaces."""
    factors = st.lists(sizes(1e-3, 1e3) | st.just(0.0), min_size=count, max_size=count)
    return factors.map(lambda each: [[n, factor] for n, factor in enumerate(each, start=1)])


def lengths(count):
    """Shares of so many layers, one of them 1."""
    shares = st.lists(st.floats(1e-3, 1.0), min_size=count - 1, max_size=count - 1)
    return shares.flatmap(lambda own: st.permutations([1.0, *own])).map(
        lambda each: [[n, share] for n, share in enumerate(each, start=1)]
    )


def strengths(extent):
    """Points of any factors over slip, the first (0, 1)."""
    slips = st.lists(st.floats(1e-6, 1.0), min_size=1, max_size=5, unique=True).map(sorted)
    factors = st.lists(sizes(1e-3, 1e3) | st.just(0.0), min_size=5, max_size=5)
    return st.tuples(slips, factors).map(
        lambda pair: [
            [0.0, 1.0],
            *([slip * extent, factor] for slip, factor in zip(*pair, strict=False)),
        ]
    )


def constructions():
    """Rows of a strand of one's own, of any wires."""
    layer = st.tuples(st.integers(1, 6), sizes(1e-6, 1.0), st.floats(-75.0, 75.0), sizes(1.0, 1e18))
    core = st.tuples(st.just(1), sizes(1e-6, 1.0), st.just(0.0), sizes(1.0, 1e18))
    return st.tuples(core, st.lists(layer, min_size=1, max_size=2)).map(
        lambda rows: [rows[0], *rows[1]]
    )


def values_of(name, definition, extents):
    if isinstance(definition, CurveParameter):
        presets = st.sampled_from(list(definition.presets))
        if not definition.is_path:
            return presets | constructions()
        extent = extents[definition.abscissa]
        if name == "strength":
            return presets | strengths(extent)
        if name == "layer_lengths":
            return presets | lengths(extent)
        if name == "friction_factors":
            return presets | of_each(extent)
        is_section = name == "section_profile"
        points = paired(sizes(*SECTION), extent) if is_section else tables(definition, extent)
        return presets | points
    if isinstance(definition, param.Boolean):
        return st.booleans()
    if isinstance(definition, param.Selector):
        return st.sampled_from(definition.objects)
    low, high = definition.bounds
    if isinstance(definition, param.Integer):
        return st.integers(low, min(high, MOST.get(name, high)))
    return numbers(low, high)


def with_others(draw, definitions, chosen):
    """Give what is chosen, and any values in their ranges for some of the other settings."""
    others = sorted(set(definitions) - chosen.keys())
    some = set(draw(st.permutations(others))[: draw(st.integers(0, len(others)))])
    for name in ("length", "duration"):
        if name in some:
            chosen[name] = draw(values_of(name, definitions[name], {}))
    extents = {
        "position": chosen.get("length", definitions["length"].default),
        "time": chosen.get("duration", definitions["duration"].default),
        "slip": 1e-3,
        "layer": chosen.get("layers", 1),
        "interface": chosen.get("layers", 1) - ("construction" not in definitions),
    }
    for name in sorted(some - chosen.keys()):
        chosen[name] = draw(values_of(name, definitions[name], extents))
    # Every cycle has instants of its own, and a run is to be short.
    most = max(1, (chosen.get("instants", 41) - 1) // 4)
    return {**chosen, "cycles": min(chosen.get("cycles", 1), most)}


@st.composite
def values(draw, scene, power):
    """Any values in their ranges, for few or for most of the settings; the rest keep defaults."""
    definitions = CATALOGUE[scene].definitions()
    chosen = {name: draw(st.integers(*bounds)) for name, bounds in SIZES[scene].items()}
    for cut, elements in CUTS.items():
        if cut in definitions:
            chosen[cut] = draw(st.integers(1, chosen[elements]))
    if scene == "strand":
        chosen["broken"] = draw(st.integers(0, chosen["wires"]))
    if scene == "bar":
        chosen |= draw(st.sampled_from(METHODS))
    if power is None:
        chosen["max_iterations"] = draw(st.integers(1, 60))
    else:
        chosen |= {"tolerance": 10.0 ** draw(power), "max_iterations": 300, "linear_stage": "full"}
    return with_others(draw, definitions, chosen)


@pytest.mark.parametrize("power", [None, st.floats(-30.0, -16.0)], ids=["any", "tight"])
@pytest.mark.parametrize("scene", SIZES)
@RANDOM
@given(st.data())
def test_any_run_ends_finite_with_a_status_or_is_refused_and_converged_is_right(scene, power, data):
    try:
        chosen = CATALOGUE[scene].checked(data.draw(values(scene, power)))
        problem = discretise(chosen)
        try:
            reference = reference_of(problem)
        except NoReferenceError:
            event("not held")
            reference = None
        distance = None if reference is None else distance_to(reference, problem)
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
    """What is called converged at a tight tolerance is the reference, where there is one alone."""
    if chosen.tolerance > TIGHT or not reference.contact_force.any():
        return
    if reference.ambiguous.any() or not reference.converged.all():
        event("several solutions, or none")
        return
    problem = solution.iterate.problem
    size = np.abs(reference.displacement).max() / problem.scales.displacement
    # states hold W + F/k, so a displacement is known to the rounding of F/k and no better
    resolved = max(
        1e-9 * np.abs(solution.iterate.boundary_force).max(),
        1e-12 * np.abs(solution.iterate.outgoing).max(),
    )
    if moves_by_less(problem, max(resolved, 1e-9 * size)):
        return
    event("converged tightly")
    last = solution.records[-1]
    if size > resolved:
        assert last.error_displacement <= WRONG
    assert last.error_force <= WRONG


def moves_by_less(problem, resolved):
    """Tell whether a support moves by so little that rounding decides its friction force."""
    moved = np.abs(np.diff(problem.prescribed[1], axis=1, prepend=0.0))
    return bool(((moved > 0.0) & (moved < resolved)).any())
