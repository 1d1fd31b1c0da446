"""Pressure of a fluid that spreads along a fault from where it is let in.

Its excess p over what was there before obeys the diffusion equation on a half-line whose end has a
pressure that is given. A steady one spreads as erfc(x / sqrt(4 alpha t)); a pressure that changes
is a sum of such, begun one after the other (H. S. Carslaw, J. C. Jaeger, Conduction of Heat in
Solids, 2nd ed., Oxford 1959, sections 2.4 and 2.5).
"""

from __future__ import annotations

import numpy as np
from scipy.signal import fftconvolve
from scipy.special import erfc

from solver.arrays import Array

DRY = 30.0
"""Diffusion lengths beyond which erfc has no digit."""
EVEN = 1e-12
"""Share of the interval, or of the largest bend, that rounding may make of none."""


def spread(place: Array, instants: Array, given: Array, diffusivity: float) -> Array:
    """Find the pressure along the line.

    Parameters
    ----------
    place
        Distance from the end, shape (n_places,), m; not negative.
    instants
        From 0 on, shape (n_instants,), s; at least two. Where they are not evenly spaced, each bend
        of what is given is added on its own.
    given
        Pressure at the end, shape (n_instants,), Pa: its first value from the very beginning, and
        linear in between.
    diffusivity
        Alpha, m^2/s; positive.

    Returns
    -------
    Shape (n_places, n_instants), Pa; at the first instant nothing has spread yet.
    """
    steps, later = np.diff(instants), instants[1:] - instants[0]
    bends = np.diff(np.diff(given) / steps, prepend=0.0)
    found = given[0] * _steady(place, later, diffusivity)
    if np.ptp(steps) <= EVEN * later[-1]:
        risen = _risen(place, later, diffusivity)
        found += fftconvolve(risen, bends[None], axes=1)[:, : len(later)]
    else:
        for number in np.flatnonzero(np.abs(bends) > EVEN * np.abs(bends).max()):
            after = instants[number + 1 :] - instants[number]
            found[:, number:] += bends[number] * _risen(place, after, diffusivity)
    # At the end itself it is what is given, to the last digit.
    found[place == 0.0] = given[1:]
    return np.concatenate([np.zeros((len(place), 1)), found], axis=1)


def _steady(place: Array, later: Array, diffusivity: float) -> Array:
    """Return what a pressure of 1 Pa has done after some times, shape (n_places, n_times)."""
    return np.asarray(erfc(_far(place, later, diffusivity)))


def _risen(place: Array, later: Array, diffusivity: float) -> Array:
    """Return what a pressure that rises by 1 Pa/s has done: the integral of `_steady`."""
    far = _far(place, later, diffusivity)
    steady = erfc(far)
    return np.asarray(
        later * ((1.0 + 2.0 * far**2) * steady - 2.0 / np.sqrt(np.pi) * far * np.exp(-(far**2)))
    )


def _far(place: Array, later: Array, diffusivity: float) -> Array:
    return np.minimum(place[:, None] / np.sqrt(4.0 * diffusivity * later), DRY)
