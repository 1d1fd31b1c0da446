"""Masing's rule answers any load as springs in series with sliders do."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.laws.play import play
from solver.reference.closed_forms.masing import masing

STIFFNESS = np.array([3.0, 2.0, 1.0, 0.5])
BOUNDS = np.array([0.5, 1.0, 2.0, 6.0])
PATHS = st.lists(st.floats(-5.0, 5.0), min_size=1, max_size=25)
ANY = settings(max_examples=40)


def grown(displacement: float) -> float:
    """Force of parallel Jenkins elements that are drawn out from rest."""
    return float(np.minimum(STIFFNESS * displacement, BOUNDS).sum())


def by_sliders(path: np.ndarray) -> np.ndarray:
    """Force of the same elements, whose sliders are followed one by one."""
    moved = np.tile(path, (len(BOUNDS), 1))
    sliders = play(moved, BOUNDS / STIFFNESS)
    return STIFFNESS @ (moved - sliders)


@ANY
@given(PATHS)
def test_masings_rule_is_what_parallel_sliders_make(path: list[float]) -> None:
    load = np.array(path)
    assert masing(load, grown) == pytest.approx(by_sliders(load), abs=1e-9)


@ANY
@given(PATHS, st.floats(0.0, 1.0))
def test_a_closed_loop_is_forgotten(path: list[float], share: float) -> None:
    load = np.array([0.0, *path])
    last = load[-1]
    turn = last + share * (load[-2] - last)
    longer = np.array([*load, turn, last])
    answers = masing(longer, grown)
    assert answers[-1] == pytest.approx(answers[-3], abs=1e-9)


@ANY
@given(PATHS)
def test_the_opposite_load_has_the_opposite_answer(path: list[float]) -> None:
    load = np.array(path)
    assert np.array_equal(masing(-load, grown), -masing(load, grown))


def test_a_cycle_of_a_quadratic_curve_dissipates_what_its_area_says() -> None:
    """Branches of u = F + F²/4 are s + s²/8, off their chord by (2 - s) s / 8."""
    top = 1.0
    load = np.concatenate(
        [
            np.linspace(0.0, top, 200),
            np.linspace(top, -top, 2001)[1:],
            np.linspace(-top, top, 2001)[1:],
        ]
    )
    answer = masing(load, lambda size: size + size**2 / 4.0)
    force = load[199:]
    moved = answer[199:]
    area = float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(moved)))
    assert area == pytest.approx(1.0 / 3.0, rel=1e-5)
    assert answer[199] == pytest.approx(answer[-1])


def test_an_empty_load_has_an_empty_response() -> None:
    assert masing(np.zeros(3), grown).tolist() == [0.0, 0.0, 0.0]
    assert masing(np.zeros(0), grown).tolist() == []
