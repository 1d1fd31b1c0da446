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


def spread(place: Array, instants: Array, given: Array, diffusivity: float) -> Array:
    """Find the pressure along the line.

    Parameters
    ----------
    place
        Distance from the end, shape (n_places,), m; not negative.
    instants
        From 0 on and evenly spaced, shape (n_instants,), s; at least two.
    given
        Pressure at the end, shape (n_instants,), Pa: its first value from the very beginning, and
        linear in between.
    diffusivity
        Alpha, m^2/s; positive.

    Returns
    -------
    Shape (n_places, n_instants), Pa; at the first instant nothing has spread yet.
    """
    step = instants[1] - instants[0]
    later = instants[1:] - instants[0]
    far = np.minimum(place[:, None] / np.sqrt(4.0 * diffusivity * later), DRY)
    steady = erfc(far)
    # The integral of `steady` over time: what a pressure that rises by 1 Pa/s has done so far.
    risen = later * ((1.0 + 2.0 * far**2) * steady - 2.0 / np.sqrt(np.pi) * far * np.exp(-(far**2)))
    bends = np.diff(np.diff(given) / step, prepend=0.0)
    changed = fftconvolve(risen, bends[None], axes=1)[:, : len(later)]
    found = given[0] * steady + changed
    # At the end itself it is what is given, to the last digit.
    found[place == 0.0] = given[1:]
    return np.concatenate([np.zeros((len(place), 1)), found], axis=1)
