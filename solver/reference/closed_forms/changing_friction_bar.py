"""Closed form: a clamped bar pulled over a support whose friction changes with slip.

Before any point has slipped as far as its friction changes, the bound is q + g u with the slope
g = (q_last - q) / s_0, and ES u'' = q + g u beyond the front. With gamma the root of |g| / ES and l
the length that slips, F = q sinh(gamma l) / gamma where friction hardens, and
q sin(gamma l) / gamma where it softens, up to q / gamma: beyond that the bar jumps.
"""

from __future__ import annotations

import numpy as np


def pulled_changing_bar(
    force: float, stiffness: float, bound: float, ratio: float, slip_length: float
) -> float:
    """Give the end displacement under a force that has grown from zero, m.

    Parameters
    ----------
    force
        F, N: less than what makes all of the bar slip, and less than q / gamma where it softens.
    stiffness
        ES, N.
    bound
        q before any slip, N/m.
    ratio
        Last bound over the first, not 1.
    slip_length
        Slip s_0 at which the bound is the last, m: more than what is found.
    """
    slope = bound * (ratio - 1.0) / slip_length
    gamma = np.sqrt(abs(slope) / stiffness)
    share = force * gamma / bound
    if slope > 0.0:
        return float(bound / slope * (np.sqrt(1.0 + share**2) - 1.0))
    return float(bound / -slope * (1.0 - np.sqrt(1.0 - share**2)))
