"""Closed form: a clamped bar pulled over a support that gives way before it slips.

Each point hangs on a spring in series with its slider (Jenkins' element). With beta the root of the
springs' density over ES, a zone of length s at the end slips under F = q s + q / (beta tanh(beta
(L - s))), and beyond it the bar stands on springs (solver/README.md, 8).
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq


def pulled_compliant_bar(
    force: float, length: float, stiffness: float, bound: float, density: float
) -> tuple[float, float]:
    """Give the end displacement of the bar under a force that has grown, and its zone of slip.

    Parameters
    ----------
    force
        F, N; at most what a bar that slips almost throughout carries.
    length, stiffness
        L, m, and ES, N.
    bound
        q = mu p, N/m.
    density
        Tangential stiffness of the support per length, N/m^2.

    Returns
    -------
    Both in m.
    """
    beta = np.sqrt(density / stiffness)

    def carried(zone: float) -> float:
        return float(bound * zone + bound / (beta * np.tanh(beta * (length - zone))))

    if force <= carried(0.0):
        return float(force * np.tanh(beta * length) / (stiffness * beta)), 0.0
    zone = float(brentq(lambda s: carried(s) - force, 0.0, length * (1.0 - 1e-12)))
    return float(bound / density + (force * zone - 0.5 * bound * zone**2) / stiffness), zone


def cycled_compliant_bar(
    force: float, length: float, stiffness: float, bound: float, density: float
) -> tuple[float, float]:
    """Give where the end is when the bar is unloaded, m, and what a cycle takes, J.

    By Masing's rule: from a point of return on, the first curve over the force, doubled.

    Parameters
    ----------
    force
        F, N, between plus and minus which the bar is pulled.
    length, stiffness, bound, density
        As of `pulled_compliant_bar`.
    """
    rest = length, stiffness, bound, density
    most, _ = pulled_compliant_bar(force, *rest)
    back, _ = pulled_compliant_bar(0.5 * force, *rest)
    stored, _ = quad(lambda one: pulled_compliant_bar(one, *rest)[0], 0.0, force)
    return most - 2.0 * back, 4.0 * (force * most - 2.0 * stored)
