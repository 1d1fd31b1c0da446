"""A structure needs no scene: it makes its problem, its loop, and says what holds and drives it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solver.discrete import Given, Rods, Side, Stack, Structure, Support
from solver.reference.fingerprint import fingerprint

T = np.linspace(0.0, 1.0, 9)
DOWN = Given(prescribed=True, mean=-1e-6 * np.minimum(4.0 * T, 1.0))
ALONG = Given(prescribed=True, mean=1e-6 * np.sin(2.0 * np.pi * T))
ROD = Rods(
    length=2.0,
    stiffness=1e5,
    elements=8,
    substructures=2,
    bound=np.array([1.0, 1, 1, 0, 0, 0, 1, 1, 1]),
    load=10.0 * T,
    instants=T,
    duration=1.0,
)
BODY = Stack(
    length=0.2,
    height=0.1,
    elements=(8, 4),
    substructures=(2, 1),
    young=1e9,
    poisson=0.3,
    instants=T,
    duration=1.0,
    support=Support(gap=np.zeros(9), friction=0.3),
    sides={"top": Side(x=ALONG, y=DOWN)},
)
BEAMS = replace(
    BODY,
    bodies=3,
    support=None,
    sides={
        "left": Side(Given(True, 0.0 * T), Given(True, 0.0 * T)),
        "right": Side(Given(False, 0.0 * T, 6e5 * T, each_body=True), Given(False, 0.0 * T)),
    },
)


def test_a_rod_rests_where_it_rubs_and_is_pulled_at_its_end() -> None:
    described = ROD.described()
    (act,) = described.acts
    assert (act.where, act.symbol, act.unit) == ("right x", "F", "N")
    clamp, *supports = described.holds
    assert (clamp.kind, clamp.side) == ("clamp", "left")
    assert [hold.stretch for hold in supports] == [(0.0, 0.25), (0.75, 1.0)]


def test_a_side_that_is_not_named_is_free() -> None:
    free = Side(Given(False, 0.0 * T), Given(False, 0.0 * T))
    named = replace(BODY, sides={**dict.fromkeys(("left", "right", "bottom"), free), **BODY.sides})
    assert fingerprint(named.discretise()) == fingerprint(BODY.discretise())
    assert {act.where for act in BODY.described().acts} == {"top x", "top y"}
    assert [hold.kind for hold in BODY.described().holds] == ["support"]


@pytest.mark.parametrize(
    ("structure", "across", "up"),
    [
        (ROD, "End displacement", "Force"),
        (BODY, "Displacement of the top", "Shear force"),
        (BEAMS, "Rotation of the end", "Moment"),
    ],
)
def test_a_structure_has_a_loop(structure: Structure, across: str, up: str) -> None:
    loop = structure.loop(structure.discretise())
    assert (loop.across[0], loop.up[0]) == (across, up)


def test_the_moment_of_a_loop_is_that_of_the_traction() -> None:
    """Of an extreme s over three heights h each: 3 s h^2 / 6, against the clock where s is up."""
    force = BEAMS.loop(BEAMS.discretise()).force
    assert force == pytest.approx(-3.0 * 6e5 * T * 0.1**2 / 6.0)
