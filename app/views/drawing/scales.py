"""Decades, limits and axes: how the values of a plot fill it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from app.views.drawing.drawing import POSITION, TIME, Axis, Curve


def decades(values: ArrayLike, floor: float) -> tuple[float, float]:
    """Give whole decades around the positive values, not below a floor."""
    found = np.asarray(values, dtype=np.float64).ravel()
    finite = found[np.isfinite(found) & (found > 0.0)]
    low = max(float(finite.min(initial=np.inf if len(finite) else 1e-1)), floor)
    high = max(float(finite.max(initial=0.0)) if len(finite) else 1.0, 10.0 * low)
    return 10.0 ** float(np.floor(np.log10(low))), 10.0 ** float(np.ceil(np.log10(high)))


def round_up(value: float) -> float:
    """Give the next of 1, 2, 5, 10, 20, ... so that a growing axis moves seldom."""
    if value <= 0.0:
        return 1.0
    decade = 10.0 ** np.floor(np.log10(value))
    steps = (1.0, 2.0, 5.0, 10.0)
    return float(next(step * decade for step in steps if step * decade >= 0.999 * value))


Limits = tuple[float, float]
FILLED = 0.6
"""Share of an axis that values have to fill, or it is drawn in."""
ROOM = 1.1


def held(old: Limits | None, low: float, high: float) -> Limits:
    """Give round limits around values and zero: those there were, as long as they suit.

    A browser spends more on an axis whose labels change than on all that it draws.
    """
    low, high = min(low, 0.0), max(high, 0.0)
    span = high - low
    if not np.isfinite(span):
        return old or (0.0, 1.0)
    if old is not None:
        inside = old[0] <= low and high <= old[1]
        if inside and span >= FILLED * (old[1] - old[0]):
            return old
    if span == 0.0:
        return 0.0, 1.0
    step = round_up(ROOM * span) / 10.0
    return float(np.floor(ROOM * low / step) * step), float(np.ceil(ROOM * high / step) * step)


def around(low: float, high: float) -> Limits:
    """Give limits around values and zero that follow from these alone, and move seldom."""
    below, above = max(-low, 0.0), max(high, 0.0)
    if not np.isfinite(below + above):
        return 0.0, 1.0
    return -round_up(below) if below else 0.0, round_up(above) if above or not below else 0.0


def across(places: Sequence[float], axis: Axis, **style: Any) -> Curve:
    """Give lines over the whole width of a plot at some heights, as one curve."""
    return _rules(places, axis, upright=False, **style)


def upright(places: ArrayLike, axis: Axis, **style: Any) -> Curve:
    """Give lines over the whole height of a plot at some places, as one curve."""
    return _rules(places, axis, upright=True, **style)


def _rules(places: ArrayLike, axis: Axis, *, upright: bool, **style: Any) -> Curve:
    one = np.repeat(np.asarray(places, dtype=np.float64), 3)
    other = np.tile([axis.low, axis.high, np.nan], len(one) // 3)
    return Curve(one, other, **style) if upright else Curve(other, one, **style)


def spanned(low: float, high: float, **options: Any) -> Axis:
    """Give an axis between two ends, of some length in any case."""
    if not high > low:
        low, high = low - 0.5, high + 0.5
    return Axis(float(low), float(high), **options)


def along(low: float, high: float) -> Axis:
    """Give an axis along the bodies, m."""
    return spanned(low, high, label=POSITION, unit="m")


def over_time(low: float, high: float) -> Axis:
    """Give an axis over time, s."""
    return spanned(low, high, label=TIME, unit="s")


def in_decades(low: float, high: float) -> Axis:
    """Give a logarithmic axis, marked at whole decades: a small plot has room for no more."""
    powers = range(round(np.log10(low)), round(np.log10(high)) + 1)
    ticks = tuple(10.0**power for power in powers)[:: max(1, len(powers) // 5)]
    return Axis(float(low), float(high), ticks=ticks)
