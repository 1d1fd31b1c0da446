"""A problem that is scaled, reversed, slowed or paused has iterates that are so too."""

from __future__ import annotations

import numpy as np
import pytest
from bars import SMALL, options, relative, sample, table

from solver.latin.indicators import latin_indicator


def test_the_rate_does_not_matter():
    slow = sample(options(duration=1024.0), 20)
    fast = sample(options(), 20)
    assert np.array_equal(slow.outgoing, fast.outgoing)
    assert np.array_equal(slow.displacement, fast.displacement)
    assert np.array_equal(slow.friction_force, fast.friction_force)
    assert latin_indicator(slow) == pytest.approx(latin_indicator(fast), rel=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_a_path_with_pauses_gives_every_iterate_again_with_pauses(seed):
    forces = np.random.default_rng(seed).uniform(-1500.0, 1500.0, 20)
    quick = options(**{**SMALL, "instants": 20}, load=table(forces))
    times = np.concatenate([[1, 3, 2, 5], np.full(16, 2)])
    paused = np.repeat(forces, times)
    slow = options(**{**SMALL, "instants": len(paused)}, load=table(paused))
    for number in (1, 5, 30):
        expected = np.repeat(sample(quick, number).displacement, times, axis=1)
        assert relative(sample(slow, number).displacement, expected) < 1e-12


@pytest.mark.parametrize("factor", [0.37, 8.0])
def test_scaling_load_and_pressure_scales_the_answer(factor):
    plain, scaled = (
        sample(options(**SMALL, peak=900.0 * c, pressure=5000.0 * c), 20) for c in (1.0, factor)
    )
    assert relative(scaled.displacement, factor * plain.displacement) < 1e-12
    assert relative(scaled.friction_force, factor * plain.friction_force) < 1e-12
    assert latin_indicator(scaled) == pytest.approx(latin_indicator(plain), rel=1e-9)


def test_reversing_the_load_reverses_the_answer():
    plain, reversed_ = (sample(options(**SMALL, peak=peak), 20) for peak in (900.0, -900.0))
    assert relative(reversed_.displacement, -plain.displacement) < 1e-12
    assert np.array_equal(reversed_.status, -plain.status)
