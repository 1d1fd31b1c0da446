"""Closed forms of fluid-driven slip: pressure of the fluid, and front of slip.

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
import scipy
from scipy.linalg import matmul_toeplitz

from solver.arrays import Array

SHARES = np.cos((np.arange(500) + 0.5) * np.pi / 1000)
"""Nodes of Gauss-Chebyshev quadrature over a zone, over its half-length: of equal
weights in integrals over ds / sqrt(a^2 - s^2)."""
DRY = 30.0
"""Diffusion lengths beyond which erfc has no digit."""
EVEN = 1e-12
"""Share of the interval, or of the largest bend, up to which a difference is
rounding."""


def spread(
    positions: Array, instants: Array, given: Array, diffusivity: float
) -> Array:
    """Pressure of the fluid along the fault, (n_positions, n_instants), Pa.

    Parameters
    ----------
    positions
        Distances from the end, shape (n_positions,), m, not negative.
    instants
        Instants from 0 on, at least two, shape (n_instants,), s.
    given
        Pressure at the end, shape (n_instants,), Pa: its first value from the very
        beginning, and linear in between.
    diffusivity
        Diffusivity alpha, m^2/s; positive.
    """
    steps = np.diff(instants)
    later = instants[1:] - instants[0]
    bends = np.diff(np.diff(given) / steps, prepend=0.0)
    pressure = given[0] * scipy.special.erfc(
        _diffusion_lengths(positions, later, diffusivity)
    )
    # Every bend of the pressure adds the same answer: at even steps a convolution.
    if np.ptp(steps) <= EVEN * later[-1]:
        risen = _risen(positions, later, diffusivity)
        # That of scipy.signal takes half a second to import.
        shifted = (bends, np.zeros_like(bends))
        pressure += matmul_toeplitz(shifted, risen.T).T
    else:
        for number in np.flatnonzero(np.abs(bends) > EVEN * np.abs(bends).max()):
            after = instants[number + 1 :] - instants[number]
            risen = _risen(positions, after, diffusivity)
            pressure[:, number:] += bends[number] * risen
    # At the end itself it is what is given, to the last digit.
    pressure[positions == 0.0] = given[1:]
    return np.concatenate([np.zeros((len(positions), 1)), pressure], axis=1)


def _risen(positions: Array, later: Array, diffusivity: float) -> Array:
    """Response to a pressure at the end that rises by 1 Pa/s, (n_positions, n), s."""
    far = _diffusion_lengths(positions, later, diffusivity)
    steady = (1.0 + 2.0 * far**2) * scipy.special.erfc(far)
    flowing = 2.0 / np.sqrt(np.pi) * far * np.exp(-(far**2))
    return np.asarray(later * (steady - flowing))


def _diffusion_lengths(positions: Array, later: Array, diffusivity: float) -> Array:
    """Positions, m, over the diffusion lengths, (n_positions, n_times)."""
    return np.minimum(positions[:, None] / np.sqrt(4.0 * diffusivity * later), DRY)


def fronts(positions: Array, lack: Array) -> Array:
    """Half-length of a symmetric zone of slip, (n_instants,), m.

    Stress is finite at its ends, so the integral over the zone of what the stress lacks
    to the strength, times ds / sqrt(a^2 - s^2), is zero. The half-length is 0 where
    nothing slips, infinite where all does.

    Parameters
    ----------
    positions
        Distances from the middle, increasing from 0, shape (n_positions,), m.
    lack
        Strength less the stress far away, shape (n_positions, n_instants), Pa, linear
        between positions; it grows along the interface, and falls with time.
    """
    half_lengths = np.zeros(lack.shape[1])
    last = float(positions[-1])
    for instant, lacking in enumerate(lack.T):
        if not lacking[0] < 0.0:
            continue
        if _mean_lack(last, positions, lacking) < 0.0:
            half_lengths[instant] = np.inf
        else:
            half_lengths[instant] = scipy.optimize.brentq(
                _mean_lack, 0.0, last, args=(positions, lacking)
            )
    return half_lengths


def _mean_lack(half_length: float, positions: Array, lack: Array) -> float:
    """Weighted mean of `lack` over a zone, as of `fronts`, at one instant."""
    return float(np.interp(half_length * SHARES, positions, lack).mean())


def stress_ahead(
    beyond: Array, positions: Array, lack: Array, half_length: float
) -> Array:
    """Stress ahead of a zone of slip, shape (n_beyond,), Pa.

    Parameters
    ----------
    beyond
        Distances from the middle of the zone, beyond its end, shape (n_beyond,), m.
    positions, lack
        As of `fronts`, at one instant, shape (n_positions,) each.
    half_length
        Half-length of the zone, m.
    """
    lacking = np.interp(half_length * SHARES, positions, lack)
    square = beyond**2 - half_length**2
    near = square[:, None] + (half_length**2) * (1.0 - SHARES**2)
    return np.asarray(np.sqrt(square) * beyond * (lacking / near).mean(axis=1))


def slip_under_growing_strength(
    positions: Array, half_length: float, drop: float, stiffness: float
) -> Array:
    """Slip of a zone with strength growing linearly from its middle, (n_positions,), m.

    The slip is zero beyond the ends of the zone. (R. Buergmann, D. D. Pollard, S. J.
    Martel, Slip distributions on faults, J. Struct. Geol. 16, 1675-1690, 1994.)

    Parameters
    ----------
    positions
        Distances from the middle of the zone, shape (n_positions,), m.
    half_length
        Half-length of the zone, m.
    drop
        Drop of the stress in the middle, Pa; it is zero at both ends.
    stiffness
        Stiffness G / (1 - nu), Pa.
    """
    share = np.clip(np.abs(positions) / half_length, 0.0, 1.0)
    root = np.sqrt(1.0 - share**2)
    # In the middle arccosh is infinite, but its factor is zero.
    safe = np.maximum(share, np.finfo(float).tiny)
    grown = (root + share**2 * np.arccosh(1.0 / safe)) / np.pi
    return np.asarray(2.0 * drop / stiffness * half_length * (root - grown))
