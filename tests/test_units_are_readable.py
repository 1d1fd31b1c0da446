"""Values stand with the prefix of their unit that one reads."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.picture.labels import changes_of, label_of
from app.picture.units import FACTORS, decimal_scale, measured
from solver.scenes.bar import BarSettings
from solver.scenes.block import BlockSettings


@pytest.mark.parametrize(
    ("value", "unit", "said"),
    [
        (4.2e-05, "m", "42 µm"),
        (5e6, "Pa", "5 MPa"),
        (-4e-5, "m", "-40 µm"),
        (900.0, "N", "0.9 kN"),
        (0.2, "m", "0.2 m"),
        (2.1e11, "Pa", "210 GPa"),
        (5000.0, "N/m", "5 kN/m"),
        (0.0, "N", "0 N"),
        (40.0, "°", "40 °"),
        (0.3, "", "0.3"),
        (1e30, "Pa", "1e+30 Pa"),
    ],
)
def test_a_value_is_told_as_one_says_it(value: float, unit: str, said: str) -> None:
    assert measured(value, unit) == said


@given(st.floats(1e-9, 1e11), st.sampled_from(["m", "N", "Pa", "J"]))
def test_no_number_has_many_zeros(size: float, unit: str) -> None:
    factor, name = decimal_scale(size, unit)
    assert 0.5 <= size / factor < 1000.0
    assert FACTORS[name.removesuffix(unit)] == factor


@pytest.mark.parametrize(
    ("kind", "changes", "said"),
    [
        (BlockSettings, {"top_normal_displacement": -5e-5}, "top normal displacement -50 µm"),
        (BarSettings, {"young": 7e10, "elements": 60}, "elements 60, young 70 GPa"),
        (BarSettings, {"peak": 920.0}, "peak 920 N"),
        (BarSettings, {"multiscale": False}, "multiscale off"),
    ],
)
def test_runs_are_called_by_readable_values(kind: type, changes: dict, said: str) -> None:
    usual, other = kind.checked({}), kind.checked(changes)
    assert label_of(other, changes_of(other, usual)) == said
