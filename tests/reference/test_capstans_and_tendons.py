"""Closed forms of a band on a rough curve: capstans, slip arcs, tendons."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from wedges import drawn_in, loss, stretched

from solver.reference.closed_forms.belt import Capstan

STRANDS = 195e9 * 280e-6
"""Axial stiffness of the tendon of the closed form's numbers, N."""
TENDON = Capstan(0.2, math.radians(18.0) + 0.0075 * 40.0, 40.0, STRANDS)
DRUM = Capstan(0.3, math.pi, 0.1 * math.pi, 5e5, span=0.005)
ANGLES = DRUM.angles


def test_the_tension_over_a_tendon_is_that_of_its_differential_equation():
    assert loss(TENDON) == pytest.approx(0.0030708, rel=1e-5)
    slope = solve_ivp(
        lambda x, state: [-loss(TENDON) * state[0], state[0] / STRANDS],
        (0.0, 40.0),
        [2e6, 0.0],
        rtol=1e-10,
        atol=1e-8,
    )
    far_end, elongation = slope.y[:, -1]
    assert far_end == pytest.approx(1768.8e3, abs=50.0)
    assert stretched(TENDON, 2e6, 40.0) == pytest.approx(elongation, rel=1e-8)
    assert elongation == pytest.approx(1.378789, rel=1e-6)
    both = stretched(TENDON, 2e6, 20.0)
    assert both == pytest.approx(1.421115 / 2.0, rel=1e-6)
    middle = TENDON.tensions(np.array([2e6]), np.array([2e6]), TENDON.angles).min()
    assert middle == pytest.approx(1880.9e3, abs=50.0)


@pytest.mark.parametrize("by", [0.006, 0.02])
def test_what_wedges_take_from_a_tendon_is_its_elongation(by):
    drawn = drawn_in(TENDON, 2e6, by)
    x = np.linspace(0.0, drawn.length, 4001)
    before = 2e6 * np.exp(-loss(TENDON) * x)
    after = drawn.at_anchor * np.exp(loss(TENDON) * x)
    assert np.trapezoid(before - after, x) / STRANDS == pytest.approx(by, rel=1e-6)
    assert after[-1] == pytest.approx(before[-1], rel=1e-9)
    assert drawn.largest == pytest.approx(before[-1], rel=1e-9)


def test_an_end_that_is_moved_back_leaves_the_largest_force_inside():
    pulled = stretched(TENDON, 2e6, 40.0)
    # The end beside the jack needs a span, as short as may be.
    capstan = Capstan(0.2, TENDON.angle, 40.0, STRANDS, span=1e-6)
    tensions = capstan.pulled_by(np.array([0.5 * pulled, pulled, pulled - 0.006]))
    drawn = drawn_in(TENDON, 2e6, 0.006)
    known = [1e6, 2e6, drawn.at_anchor]
    assert tensions == pytest.approx(known, rel=1e-5)
    along = capstan.tensions(tensions, None, capstan.angles)
    assert along[:, -1].max() == pytest.approx(drawn.largest, rel=1e-4)


def test_the_slip_arc_of_an_even_tension_is_the_logarithm_of_the_ratio():
    even = np.full_like(ANGLES, 1e3)
    pulled = DRUM.step(even, 2e3, None, ANGLES)
    slipped = ANGLES[pulled > even]
    arc = math.log(2.0) / DRUM.friction
    assert np.ptp(slipped) == pytest.approx(arc, abs=2.0 * ANGLES[1])
    # The integral of T1 (exp(mu a) - 1) over the arc that slips.
    stretch = 0.1 * np.trapezoid(pulled - even, ANGLES)
    known = 0.1 / 0.3 * 1e3 * (2.0 - 1.0 - math.log(2.0))
    assert stretch == pytest.approx(known, rel=1e-4)


def test_an_end_that_is_pulled_moves_by_what_its_slip_arc_stretches():
    pull = np.array([1e3, 2e3])
    moved = DRUM.displacement(pull, np.array([1e3, 1e3]))
    # Pulled alike first, half of the drum slipped to either end.
    arc = 0.5 * (DRUM.angle + math.log(2.0) / DRUM.friction)
    assert moved[0] == pytest.approx(stretched(DRUM, 1e3, 0.5 * DRUM.length), rel=1e-5)
    whole = stretched(DRUM, 2e3, 0.1 * arc)
    # On the same arc, its first part was pulled to the tail, its last to the pull.
    to_tail = arc - 0.5 * DRUM.angle
    tail = np.exp(-0.3 * (0.5 * DRUM.angle - to_tail)) - np.exp(-0.15 * DRUM.angle)
    was = stretched(DRUM, 1e3, 0.5 * DRUM.length)
    was += 0.1 / 0.3 * 1e3 * tail / DRUM.stiffness
    assert moved[1] - moved[0] == pytest.approx(whole - was, rel=1e-4)
