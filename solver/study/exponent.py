"""The power with which one quantity grows with another, and how well it is known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Exponent:
    """A power law fitted to points.

    Attributes
    ----------
    value
        Slope of the logarithm of the one over that of the other.
    margin
        To both sides of it, with 95 % confidence if the points scatter at random about a power
        law; NaN for two points, which leave nothing to tell it from.
    """

    value: float
    margin: float

    def __str__(self) -> str:
        """Value with its margin, where it has one."""
        known = f"{self.value:.2f}"
        return known if math.isnan(self.margin) else f"{known} ± {self.margin:.2f}"


def exponent_of(x: Sequence[float], y: Sequence[float]) -> Exponent | None:
    """Fit a power law by least squares of the logarithms.

    Parameters
    ----------
    x, y
        Of equal length; points at which one of them is not a positive number are left out.

    Returns
    -------
    None where fewer than two points are left.
    """
    points = np.array([x, y], dtype=float).T
    points = points[np.isfinite(points).all(axis=1) & (points > 0.0).all(axis=1)]
    if len(np.unique(points[:, 0])) < 2:
        return None
    x, y = np.log(points).T
    if len(points) == 2:
        return Exponent(float(np.polyfit(x, y, 1)[0]), math.nan)
    (slope, _), covariance = np.polyfit(x, y, 1, cov=True)
    quantile = stdtrit(len(points) - 2, 0.5 + 0.5 * CONFIDENCE)
    return Exponent(float(slope), float(quantile * math.sqrt(covariance[0, 0])))
