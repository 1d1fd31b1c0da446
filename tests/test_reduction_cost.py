"""The comparison of full and separated linear stages solves the same thing on both sides."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from benchmarks.reduction_cost import half_plane, reduction_cost, whole_iterations

from solver.arrays import space_time
from solver.latin import PGD, Auto
from solver.latin.iterate import Checkpoint
from solver.latin.linear_stage import LinearStage
from solver.latin.response import DenseResponse
from solver.scenes import discretise
from solver.scenes.bar import BarSettings


def test_both_stages_give_the_same_on_the_half_plane():
    problem = half_plane(40, 12)
    k = Auto().of(problem)
    generator = np.random.default_rng(3)
    start = Checkpoint(0, 0.0, np.asfortranarray(generator.normal(size=(40, 12))))
    target = np.asfortranarray(generator.normal(size=(40, 12)))
    found = []
    full = LinearStage(problem, k, multiscale=True)
    every = PGD(modes=40, tolerance=1e-14, pairs=40, sharing=0.0)
    reduced = every.stage(problem, k, multiscale=True)
    for stage in (full, reduced):
        state = stage.start(start)
        stage.read(target)
        stage.advance(state, 0.8)
        found.append(stage.incoming(state, space_time(40, 12)))
        assert isinstance(stage.groups[0].response, DenseResponse)
    assert np.allclose(found[0], found[1], atol=1e-8)


def test_the_half_plane_has_a_dense_symmetric_positive_stiffness():
    (part,) = half_plane(30, 2).substructures
    dense = part.elasticity.stiffness.toarray()
    assert np.allclose(dense, dense.T)
    assert np.linalg.eigvalsh(dense).min() == pytest.approx(1.0)
    assert np.count_nonzero(np.abs(dense) > 1e-12) > 0.4 * dense.size


def test_every_size_that_fits_is_measured_and_no_other():
    settings = BarSettings.checked({"method": "paper", "substructures": 5})
    cost = reduction_cost("bar", discretise(settings), (2, 8, 64), repeats=1)
    assert set(cost.reduced) == set(cost.enriched) == {2, 8}
    assert cost.full > 0.0
    assert cost.reduced_values[2] < cost.reduced_values[8] < cost.values
    fast, slow = (replace(cost, full=seconds).pays_up_to for seconds in (1e9, 0.0))
    assert (fast, slow) == (8, 0)


def test_whole_iterations_are_measured_against_the_full_form():
    found = whole_iterations(26, 21, repeats=1)
    assert found["full"][1] == 0.0
    assert 0.0 < found["pgd"][1] < 0.05
    assert all(seconds > 0.0 for seconds, _ in found.values())
