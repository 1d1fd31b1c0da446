"""Closed forms of slip that a fluid drives: its pressure, and the front of slip.

The excess of its pressure over what was there before obeys the diffusion equation on a
half-line whose end has a pressure that is given. A steady one spreads as erfc(x /
sqrt(4 alpha t)); a pressure that changes is a sum of such, begun one after the other
(H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids, 2nd ed., Oxford 1959,
sections 2.4 and 2.5).

Half spaces of one material rub on each other under a uniform shear stress. The strength
is given over the interface; where it is below that stress, a zone slips whose shape is
known: as long as it grows, the zone is a crack whose stress drops to the strength (J.
R. Rice, Mathematical analysis in the mechanics of fracture, in Fracture II, Academic
Press 1968; R. C. Viesca, J. Fluid Mech. 928, A29, 2021).
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import matmul_toeplitz
from scipy.optimize import brentq
from scipy.special import erfc

from solver.arrays import Array

SHARES = np.cos((np.arange(500) + 0.5) * np.pi / 1000)
"""Places in a zone, over its half-length, of one weight in integrals over ds / sqrt(a^2
- s^2)."""
DRY = 30.0
"""Diffusion lengths beyond which erfc has no digit."""
EVEN = 1e-12
"""Share of the interval, or of the largest bend, that rounding may make of none."""


def spread(place: Array, instants: Array, given: Array, diffusivity: float) -> Array:
    """Pressure of the fluid along the line, (n_places, n_instants), Pa.

    Parameters
    ----------
    place, instants
        Distance from the end, m, not negative; and instants from 0 on, s, at least two.
        Where they are not evenly spaced, each bend of what is given is added on its
        own.
    given
        Pressure at the end, shape (n_instants,), Pa: its first value from the very
        beginning, and linear in between.
    diffusivity
        Alpha, m^2/s; positive.
    """
    steps = np.diff(instants)
    later = instants[1:] - instants[0]
    bends = np.diff(np.diff(given) / steps, prepend=0.0)
    pressure = given[0] * erfc(_far(place, later, diffusivity))
    if np.ptp(steps) <= EVEN * later[-1]:
        risen = _risen(place, later, diffusivity)
        # The convolution in time; that of scipy.signal takes half a second to import.
        shifted = (bends, np.zeros_like(bends))
        pressure += matmul_toeplitz(shifted, risen.T).T
    else:
        for number in np.flatnonzero(np.abs(bends) > EVEN * np.abs(bends).max()):
            after = instants[number + 1 :] - instants[number]
            pressure[:, number:] += bends[number] * _risen(place, after, diffusivity)
    # At the end itself it is what is given, to the last digit.
    pressure[place == 0.0] = given[1:]
    return np.concatenate([np.zeros((len(place), 1)), pressure], axis=1)


def _risen(place: Array, later: Array, diffusivity: float) -> Array:
    """Pressure where that at the end rises by 1 Pa/s, shape (n_places, n_times)."""
    far = _far(place, later, diffusivity)
    steady = erfc(far)
    return np.asarray(
        later
        * (
            (1.0 + 2.0 * far**2) * steady
            - 2.0 / np.sqrt(np.pi) * far * np.exp(-(far**2))
        )
    )


def _far(place: Array, later: Array, diffusivity: float) -> Array:
    """Places over the diffusion length."""
    return np.minimum(place[:, None] / np.sqrt(4.0 * diffusivity * later), DRY)


def fronts(place: Array, lack: Array) -> Array:
    """How far from its middle a zone slips that grows in both directions alike, (n_instants,), m.

    Nothing is singular at its ends: there what the stress lacks to the strength, times
    ds / sqrt(a^2 - s^2), sums up to nothing over the zone. 0 where nothing slips,
    infinite where all does.

    Parameters
    ----------
    place
        Distance from the middle, increasing from 0, shape (n,), m; linear in between.
    lack
        Strength less the stress far away, shape (n, n_instants), Pa; it grows along the
        interface, and falls with time.
    """
    half_lengths = np.zeros(lack.shape[1])
    for instant, lacking in enumerate(lack.T):

        def left(half: float, lacking: Array = lacking) -> float:
            return float(np.interp(half * SHARES, place, lacking).mean())

        if lacking[0] < 0.0:
            last = float(place[-1])
            if left(last) < 0.0:
                half_lengths[instant] = np.inf
            else:
                half_lengths[instant] = brentq(left, 0.0, last)
    return half_lengths


def stress_ahead(beyond: Array, place: Array, lack: Array, half_length: float) -> Array:
    """Stress that such a zone adds ahead of it, at distances from the middle, Pa.

    `place` and `lack` are as of `fronts`, at one instant.
    """
    lacking = np.interp(half_length * SHARES, place, lack)
    square = beyond**2 - half_length**2
    near = square[:, None] + (half_length**2) * (1.0 - SHARES**2)
    return np.asarray(np.sqrt(square) * beyond * (lacking / near).mean(axis=1))


def slip_under_growing_strength(
    place: Array, half_length: float, drop: float, stiffness: float
) -> Array:
    """Slip of a zone of given length, whose strength grows evenly from its middle, m; 0 outside.

    Stress drops by `drop`, Pa, in the middle and by nothing at both ends, beyond which
    nothing slips; the stiffness is G / (1 - nu), Pa (R. Buergmann, D. D. Pollard, S. J.
    Martel, Slip distributions on faults, J. Struct. Geol. 16, 1675-1690, 1994).
    """
    share = np.clip(np.abs(place) / half_length, 0.0, 1.0)
    root = np.sqrt(1.0 - share**2)
    safe = np.maximum(share, np.finfo(float).tiny)
    grown = (root + share**2 * np.arccosh(1.0 / safe)) / np.pi
    return np.asarray(2.0 * drop / stiffness * half_length * (root - grown))
