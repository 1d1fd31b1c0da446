"""The limit by Melan's theorem is where simulated slip ceases, as closed forms say."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from solver.reference.assembly import NoReferenceError
from solver.reference.shakedown import largest_swing, shakedown_limit, slip_space
from solver.scenes import CATALOGUE, discretise
from solver.study.quantities import reading
from solver.study.quantities.cycles import cycle_ends, cycles_of
from solver.study.scene_run import finished_run

BOUND = 1500.0
LENGTH = 1.0
SMALL = {"elements": 20, "instants": 161, "substructures": 2, "load": "cycles"}
MOVED = {"right_end": "held", "right_load": "cycles"}
GIVES_WAY = {"friction_law": "compliant", "contact_stiffness": 100.0}


def limit(scene: str, **changes: Any) -> float:
    settings = CATALOGUE[scene].checked(changes)
    ends = cycle_ends(settings)
    return shakedown_limit(discretise(settings), slice(ends[0], ends[-1] + 1))


def slips(scene: str, **changes: Any) -> bool:
    """Check whether anything slips in the last cycle."""
    settings = CATALOGUE[scene].checked(changes)
    run = finished_run(settings, errors=False, indicators=False)
    return bool(cycles_of(settings, run.iterate).slip[:, -1].any())


CASES = [
    ("bar", {"peak": 900.0}),
    ("bar", {"peak": 300.0, **GIVES_WAY}),
    ("bar", {"peak": 300.0, "pressure_load": "shaken", **GIVES_WAY}),
    ("bar", {"peak": 300.0, "body_force": 800.0, "body_load": "cycles", **GIVES_WAY}),
    ("strand", {"peak": 300.0, "broken": 1}),
    ("strand", {"peak": 300.0}),
    ("strand", {"peak": 300.0, **GIVES_WAY}),
    ("strand", {"peak": 200.0, "pressure_load": "shaken", **GIVES_WAY}),
    ("strand", {"peak": 300.0, "grip": "displacement", **GIVES_WAY}),
    ("bar", {"right_displacement": 1e-3, **(MOVED | GIVES_WAY)}),
]
"""The end of the last one is driven: it slipped from half of the limit on."""


@pytest.mark.parametrize(("scene", "changes"), CASES)
def test_just_below_the_limit_slip_ceases_and_just_above_it_goes_on(
    scene: str, changes: dict[str, Any]
) -> None:
    factor = limit(scene, **SMALL, **changes)
    names = "peak", "body_force", "right_displacement"
    loads = [name for name in names if name in changes]
    for share, goes_on in ((0.995, False), (1.005, True)):
        scaled = {name: share * factor * changes[name] for name in loads}
        assert slips(scene, **SMALL, **(changes | scaled)) is goes_on, share


PUSHED: dict[str, Any] = {
    "gap": "flat",
    "top": "pushed",
    "top_normal_displacement": -1e-5,
    "top_normal_load": "hold",
    "left": "pushed",
    "left_normal_load": "cycles",
    "friction": 0.4,
    "elements": 6,
    "elements_up": 3,
    "substructures": 1,
    "instants": 81,
}


@pytest.mark.parametrize(
    ("scene", "changes", "name"),
    [
        ("bar", SMALL | MOVED, "right_displacement"),
        ("block", PUSHED, "left_normal_displacement"),
    ],
)
def test_what_is_moved_over_its_support_slips_however_little_it_is_moved(
    scene: str, changes: dict[str, Any], name: str
) -> None:
    """Of the block a motion 2.4 times as large was said to cease slipping."""
    for size in (1e-6, 1e-8):
        settings = CATALOGUE[scene].checked({**changes, name: size})
        run = finished_run(settings, errors=False, indicators=False)
        assert reading("shakedown_factor")(run) == 0.0
        assert cycles_of(settings, run.iterate).slip[:, -1].any()


def test_a_pushed_body_shakes_down_up_to_twice_its_friction() -> None:
    """Uniform body force b over friction mu p: on any mesh b = 2 mu p in swing."""
    for elements in (10, 40):
        changes = {**SMALL, "elements": elements, "load": "hold", "peak": 0.0}
        swings = {"body_force": 100.0, "body_load": "cycles"}
        assert limit("bar", **changes, **swings) == pytest.approx(
            BOUND / 100.0, rel=1e-9
        )


def test_the_limit_of_a_contact_that_gives_way_converges_to_that_of_shear_lag() -> None:
    """Friction at the pulled end is F / l tanh(L / l), with l^2 = ES / k_t."""
    soft = {"friction_law": "compliant", "contact_stiffness": 2.0}
    lag = LENGTH / np.sqrt(soft["contact_stiffness"])
    exact = BOUND * lag / np.tanh(LENGTH / lag) / 300.0
    errors = [
        limit("bar", **{**SMALL, "elements": n}, peak=300.0, **soft) / exact - 1.0
        for n in (20, 40, 80)
    ]
    ratios = np.array(errors[:-1]) / errors[1:]
    np.testing.assert_allclose(ratios, 4.0, atol=0.2)


def test_a_mean_load_does_not_matter() -> None:
    """Slip moves the mean into what is left behind: the swing alone decides."""
    pulled = limit("bar", **SMALL, peak=300.0, **GIVES_WAY)
    held = {"body_force": 700.0, "body_load": "hold"}
    assert limit("bar", **SMALL, **held, peak=300.0, **GIVES_WAY) == pytest.approx(
        pulled
    )


def test_a_load_that_nothing_feels_has_no_limit() -> None:
    assert limit("strand", **SMALL, peak=300.0, broken=0) == np.inf


def test_the_shakedown_limit_refuses_structures_beyond_the_theorem() -> None:
    block = {
        "elements": 6,
        "elements_up": 4,
        "instants": 61,
        "top_tangential_load": "cycles",
    }
    with pytest.raises(NoReferenceError):
        limit("block", **block, substructures=1)
    with pytest.raises(NoReferenceError):
        limit("bar", **SMALL, peak=300.0, friction_law="slip-dependent")


@pytest.mark.parametrize(("scene", "changes"), [CASES[0], CASES[4]])
def test_where_slip_presses_nothing_the_program_of_the_plane_gives_it_too(
    scene: str, changes: dict[str, Any]
) -> None:
    rods = CATALOGUE[scene].checked(SMALL | changes)
    ends = cycle_ends(rods)
    some = slice(ends[-2], ends[-1] + 1)
    theorem = shakedown_limit(discretise(rods), some)
    assert largest_swing(slip_space(discretise(rods)), some)[0] == pytest.approx(
        theorem, rel=1e-6
    )
