"""In the plane slip that stays, with all contacts closed, is where slip may cease.

Where no slip changes what presses, it ceases from any start; else the start matters.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from solver.reference.assembly import NoReferenceError
from solver.reference.shakedown import MOST_POINTS, largest_swing, slip_space
from solver.scenes import CATALOGUE, discretise
from solver.study.quantities import QUANTITIES, reading
from solver.study.quantities.cycles import cycle_ends
from solver.study.quantities.finished import FinishedRun
from solver.study.scene_run import finished_run

N_CYCLES = 4
LOADS = {"layers": "bend_load", "block": "top_tangential_load"}
MESH = {"substructures": 1, "substructures_up": 1, "duration": 8.0, "instants": 129}
TWINS = {**MESH, "layers": 2, "elements": 12, "elements_up": 1, "pressure": 2e6}
FREE = MESH | {
    "gap": "flat",
    "elements": 12,
    "elements_up": 6,
    "friction": 0.2,
    "top": "traction",
    "top_normal_load": ((0.0, -1e8),),
}


def path(swing: float, first: float = 0.0) -> tuple[tuple[float, float], ...]:
    """Cycles of a load after a push or none, whose turns are instants."""
    turns = ((3.0 + 0.5 * n, swing * (-1.0) ** n) for n in range(2 * N_CYCLES + 2))
    return ((1.0, 0.0), (1.5, first), (2.0, 0.0), *turns, (8.0, 0.0))


@cache
def _ran(
    scene: str, swing: float, first: float, given: tuple[tuple[str, Any], ...]
) -> FinishedRun:
    settings = CATALOGUE[scene].checked(
        {**dict(given), LOADS[scene]: path(swing, first)}
    )
    return finished_run(settings, errors=False, indicators=False)


def ran(
    scene: str, given: dict[str, Any], swing: float, first: float = 0.0
) -> FinishedRun:
    return _ran(scene, swing, first, tuple(given.items()))


def last(run: FinishedRun) -> slice:
    ends = cycle_ends(run.settings)
    return slice(ends[-2], ends[-1] + 1)


def factor(run: FinishedRun) -> float:
    return reading("shakedown_factor")(run)


def goes_on(run: FinishedRun) -> bool:
    """Check whether anything slips or opens in the last cycle."""
    assert run.solution.status.ending == "converged"
    return bool((run.iterate.status[:, last(run)][:, 1:] != 0).any())


SMALL = 1e-4
"""Deflection, m, under which the two layers stick wherever they do so at all."""


@pytest.mark.parametrize("first", [0.0, 4.0, -4.0])
def test_two_equal_layers_cease_to_slip_below_the_limit_from_any_start_and_not_above(
    first: float,
) -> None:
    """Friction between them is mirrored and presses nothing: Melan's theorem holds."""
    swing = SMALL * factor(ran("layers", TWINS, SMALL))
    for share, expected in ((0.995, False), (1.005, True)):
        run = ran("layers", TWINS, share * swing, first * swing)
        assert goes_on(run) == expected, share
        assert first == 0.0 or np.abs(run.iterate.status[:, : last(run).start]).any()


SHEAR = 1.2e7
PUSH = 1.7e7
"""Pa, of a block that contact alone holds, and whose slip changes what presses."""


@pytest.mark.parametrize("first", [0.0, PUSH, -PUSH])
def test_a_coupled_block_slips_for_ever_above_the_limit_and_well_below_it_never(
    first: float,
) -> None:
    swing = SHEAR * factor(ran("block", FREE, SHEAR))
    for share, expected in ((0.9, False), (1.01, True)):
        assert goes_on(ran("block", FREE, share * swing, first)) == expected, share


def test_just_below_the_limit_a_coupled_block_ceases_or_not_by_its_start() -> None:
    swing = SHEAR * factor(ran("block", FREE, SHEAR))
    assert not goes_on(ran("block", FREE, 0.99 * swing))
    assert goes_on(ran("block", FREE, 0.99 * swing, PUSH))


@pytest.mark.parametrize(
    "changes",
    [
        {"friction_law": "compliant"},
        {"friction_law": "slip-dependent"},
        {"friction": 0.0, "top": "displacement"},
        {"gap": "parabola"},
    ],
)
def test_without_a_theorem_there_is_no_shakedown_factor(
    changes: dict[str, Any],
) -> None:
    given = FREE | {"elements": 4, "elements_up": 2} | changes
    settings = CATALOGUE["block"].checked({**given, LOADS["block"]: path(1e-6)})
    assert not QUANTITIES["shakedown_factor"].applies(settings)
    with pytest.raises(NoReferenceError):
        largest_swing(slip_space(discretise(settings)), last_of(settings))


def last_of(settings: Any) -> slice:
    ends = cycle_ends(settings)
    return slice(ends[-2], ends[-1] + 1)


def test_a_spring_that_catches_a_block_and_too_many_points_are_refused() -> None:
    incline = CATALOGUE["incline"].checked(
        {"elements": 4, "elements_up": 2, "cycles": 3}
    )
    assert not QUANTITIES["shakedown_factor"].applies(incline)
    many = {"layers": 7, "elements": 100, "elements_up": 1, "substructures": 10}
    with pytest.raises(NoReferenceError, match=str(MOST_POINTS)):
        slip_space(discretise(CATALOGUE["layers"].checked(many)))
    with pytest.raises(NoReferenceError):
        slip_space(discretise(incline))


def test_a_pressing_that_leaves_contacts_open_has_no_factor() -> None:
    """A load lifts a block that a side holds."""
    lifted = {**FREE, "left": "clamped", "top_normal_load": ((0.0, 1e6),)}
    assert math.isnan(factor(ran("block", lifted, 1e6)))


def test_without_any_pressing_no_swing_is_small_enough() -> None:
    assert factor(ran("layers", {**TWINS, "pressure": 0.0}, SMALL)) == pytest.approx(
        0.0, abs=1e-9
    )
