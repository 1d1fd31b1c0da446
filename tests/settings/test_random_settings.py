"""Runs of random settings end right, say that they do not, or are refused.

Here some go over all of the range that they may have, far beyond those that are drawn
by `python -m solver stability --random`. SLIPFRONT_RANDOM_RUNS=500 makes that many runs
of each scene.
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import param
import pytest

from solver.scenes import CATALOGUE
from solver.study.outcomes import run
from solver.study.random_loads import log_uniform
from solver.study.random_runs import draw
from solver.study.verdicts import Verdict, judge

RUNS = int(os.environ.get("SLIPFRONT_RANDOM_RUNS", "4"))
SMALLEST = 1e-12
"""Of a number whose range begins at zero, or below."""
MOST = {
    "elements": 8,
    "elements_up": 3,
    "instants": 10,
    "cycles": 2,
    "max_iterations": 50,
    "wires": 5,
    "layers": 3,
    "bricks": 3,
    "courses": 3,
    "voussoirs": 6,
    "rings": 1,
}
"""Bounds that keep a run short: seven wires touch in all ways in which more do."""
CUTS = {"substructures": "elements", "substructures_up": "elements_up"}


def values_of(scene: str, row: int) -> dict[str, Any]:
    """Random values of a small run, some of them anywhere in their range."""
    generator = np.random.default_rng([row, *scene.encode()])
    settings = draw(scene, 1, row)
    values = settings.changed()
    definitions = settings.definitions()
    numbers = [
        name for name, each in definitions.items() if isinstance(each, param.Number)
    ]
    for name in generator.choice(
        numbers, generator.integers(1, 6), replace=False
    ).tolist():
        low, high = definitions[name].bounds
        size = log_uniform(generator, max(low, SMALLEST), high)
        sign = -1.0 if low < 0.0 and generator.random() < 0.5 else 1.0
        anywhere = generator.choice([low, high, sign * size], p=[0.1, 0.1, 0.8])
        is_whole = isinstance(definitions[name], param.Integer)
        if is_whole:
            values[name] = int(anywhere)
        else:
            values[name] = float(anywhere)
    for name, most in MOST.items():
        if name in definitions:
            values[name] = min(values.get(name, most), most)
    for name, elements in CUTS.items():
        if name in definitions:
            values[name] = min(values.get(name, 1), values.get(elements, 1))
    return values


KINDS = {
    "bar": ["left_end", "right_end", "linear_stage"],
    "strand": ["grip"],
    "block": ["left", "right", "top"],
    "layers": ["bending"],
}
"""Settings of some scenes all kinds of which are to be drawn."""
ROWS = 150


@pytest.mark.parametrize("scene", sorted(set(CATALOGUE) - {"wall"}))
def test_all_laws_of_friction_and_kinds_of_ends_and_sides_are_drawn(scene: str) -> None:
    definitions = CATALOGUE[scene].definitions()
    wanted = set()
    for name in ["friction_law", *KINDS.get(scene, [])]:
        wanted |= {(name, kind) for kind in definitions[name].objects}
    for row in range(ROWS):
        wanted -= set(draw(scene, 2, row).values().items())
        if not wanted:
            break
    assert not wanted


def test_walls_are_also_pulled_and_have_openings_and_laws_of_their_own() -> None:
    tops = set()
    have_openings = set()
    laws = set()
    for row in range(10):
        wall = draw("wall", 2, row)
        tops.add(wall.top)
        have_openings.add(wall.opening > 0)
        laws.add(wall.friction_law)
        # Each wall takes a hundred draws.
        if min(len(tops), len(have_openings), len(laws)) > 1:
            break
    assert tops == {"moved", "pulled"}
    assert have_openings == {False, True}
    assert len(laws) > 1


@pytest.mark.parametrize("scene", CATALOGUE)
def test_any_run_is_right_or_says_that_it_is_not_or_is_refused(scene: str) -> None:
    for row in range(RUNS):
        values = values_of(scene, row)
        outcome = run(scene, values)
        accuracy = values.get("accuracy", CATALOGUE[scene].checked({}).accuracy)
        assert judge(outcome, accuracy).verdict is not Verdict.WRONG, (values, outcome)
