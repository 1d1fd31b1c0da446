"""Values with the prefix of their unit that one reads: mm and µm, kN, MPa."""

from __future__ import annotations

import numpy as np

FACTORS = {"": 1.0, "m": 1e-3, "µ": 1e-6, "n": 1e-9, "k": 1e3, "M": 1e6, "G": 1e9}
LEAST, LEAST_TOLD = 0.5, 0.1
"""Value at which a prefix begins, of all values of a plot, and of one that is told."""
UNPREFIXED = "", "°", "%"


def decimal_scale(size: float, unit: str) -> tuple[float, str]:
    """Choose an SI prefix for values of a size; give the factor to divide by, and the unit."""
    if unit in UNPREFIXED or not (np.isfinite(size) and size > 0.0):
        return 1.0, unit
    fitting = [(factor, prefix) for prefix, factor in FACTORS.items() if size >= LEAST * factor]
    factor, prefix = max(fitting or [(1e-9, "n")])
    return factor, prefix + unit


def measured(value: float, unit: str, digits: int = 3) -> str:
    """Write a value with its unit, in the prefix that suits it."""
    factor, name = decimal_scale(abs(value) * LEAST / LEAST_TOLD, unit)
    scaled = value / factor
    if unit in UNPREFIXED or value == 0.0 or 1e-3 <= abs(scaled) < 1e4:
        return f"{scaled:.{digits}g} {name}".strip()
    return f"{value:.{digits}g} {unit}"
