"""Threads share the work of an iteration; the iterates are the same to the bit."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest

from solver.latin import iterations
from solver.latin.anderson import SAMPLE, AndersonState
from solver.latin.blocks import MOST, VALUES, Blocks
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of

LARGE = {
    "block": {"elements": 192, "elements_up": 96, "substructures": 8, "substructures_up": 4},
    "layers": {"elements": 192, "elements_up": 16, "substructures": 8, "search_direction": "paper"},
    "bar": {"elements": 2000, "acceleration": "anderson"},
    "strand": {"elements": 800},
}


@pytest.mark.parametrize("scene", LARGE)
def test_iterates_are_the_same_to_the_bit_whatever_the_threads(scene):
    settings = CATALOGUE[scene].settings.checked(LARGE[scene])
    problem = discretise(settings)
    assert len(Blocks(problem.n_rows, problem.n_instants).slices) > 1
    one, several = (
        next(islice(iterations(problem, method_of(settings.replace(threads=threads))), 8, None))
        for threads in (1, 3)
    )
    assert np.array_equal(one.outgoing, several.outgoing)
    assert np.array_equal(one.local_displacement, several.local_displacement)


@pytest.mark.parametrize("threads", [1, 2])
def test_blocks_cover_every_instant_once_and_pass_errors_on(threads):
    blocks = Blocks(VALUES, 51, threads)
    seen = np.zeros(51, dtype=int)

    def count(some):
        seen[some] += 1

    blocks.each(count)
    assert np.all(seen == 1)
    assert len(blocks.slices) == MOST

    def fail(some):
        raise ArithmeticError

    with pytest.raises(ArithmeticError):
        blocks.each(fail)


def test_a_small_field_is_one_block():
    assert Blocks(51, 101, 4).slices == [slice(0, 101)]


def test_a_sample_of_the_residual_mixes_a_large_linear_iteration_as_well():
    size, generator = 4 * SAMPLE, np.random.default_rng(3)
    rates = generator.choice([0.9, -0.8, 0.5, 0.1], size)[:, None, None]
    state = [np.zeros((size, 1, 1), order="F")]
    mix = AndersonState([np.ones((size, 1, 1))], memory=6)
    for _ in range(7):
        mix.start(state)
        state[0] = np.asfortranarray(rates * state[0] + 1.0)
        mix(state)
    assert np.allclose(state[0], 1.0 / (1.0 - rates), rtol=1e-4)
