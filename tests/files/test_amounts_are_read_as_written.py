"""Amounts for readers are in a unit of suitable size, in which they are read again."""

import pytest

from solver.files.amounts import amount, unit_for
from solver.files.units import SYMBOLS


@pytest.mark.parametrize(
    ("size", "unit", "text"),
    [
        (7.74e-10, "m", "0.774 nm"),
        (2.5e-8, "m", "25 nm"),
        (4.0e-5, "m", "40 µm"),
        (-0.9e3, "N", "−900 N"),
        (0.999e3, "N", "999 N"),
        (3.0e9, "Pa", "3000 MPa"),
        (1.1e10, "Pa", "11 GPa"),
        (0.0, "J", "0 J"),
        (7200.0, "s", "7200 s"),
        (10800.0, "s", "3 h"),
        (0.3, "", "0.3"),
    ],
)
def test_an_amount_has_a_unit_of_suitable_size(
    size: float, unit: str, text: str
) -> None:
    assert amount(size, unit) == text


@pytest.mark.parametrize("unit", ["m", "N", "Pa"])
@pytest.mark.parametrize("power", range(-10, 11))
def test_what_is_written_is_read_as_the_same_value(unit: str, power: int) -> None:
    value = 1.234 * 10.0**power
    digits, symbol = amount(value, unit).split()
    size, _ = SYMBOLS[symbol]
    assert float(digits) * float(size) == pytest.approx(value, rel=1e-12)


def test_a_value_far_below_its_unit_has_a_power_of_ten() -> None:
    assert unit_for(1e3, "N")(0.142) == "1.42·10⁻⁴ kN"
