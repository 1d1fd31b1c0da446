"""Closed form: the stiffness of a cantilever (Gere, Timoshenko, Mechanics of Materials, 1997)."""

from __future__ import annotations

SHEAR_FACTOR = 5.0 / 6.0
"""Of a rectangular section."""


def cantilever(length: float, height: float, young: float, poisson: float) -> float:
    """Give the end force for a unit of deflection, per width: Timoshenko's beam in plane stress.

    Parameters
    ----------
    length, height
        m.
    young, poisson
        E, Pa, and nu.

    Returns
    -------
    N/m for a metre of width.
    """
    bending = length**3 / (3.0 * young * height**3 / 12.0)
    shear = length / (SHEAR_FACTOR * height * young / (2.0 * (1.0 + poisson)))
    return 1.0 / (bending + shear)
