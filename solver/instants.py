"""Instants of a run: points of all paths, and as many between them as are wanted."""

from __future__ import annotations

import math

import numpy as np

from solver.arrays import Array
from solver.definitions import Pairs

SAME = 1e-12
"""Share of the interval by which rounding may set one time apart from another."""
NO_KNOTS = np.zeros(0)


def instants_of(
    duration: float, number: int, knots: Array = NO_KNOTS, corners: Array = NO_KNOTS
) -> Array:
    """Spread instants over a time interval, with knots of paths among them.

    Between knots they are evenly spaced, and no step is longer than one of `number` equal ones.

    Parameters
    ----------
    duration
        Length of the interval, s.
    number
        Instants at least: from 0 on, or a single one at the end.
    knots
        Times that are instants as they are, in any order, s; those outside do not count.
    corners
        The same of presets: one at an instant or a knot but for rounding is that.

    Returns
    -------
    Shape (n_instants,), s.
    """
    even = np.linspace(0.0, duration, number) if number > 1 else np.array([duration])
    knots = np.unique(knots[(knots >= 0.0) & (knots <= duration)])
    corners = np.unique(corners)
    corners = corners[np.diff(corners, prepend=-duration) > SAME * duration]
    every = np.union1d(knots, apart(corners, knots, SAME * duration))
    if len(apart(every, even, SAME * duration)) == 0 and np.all(np.diff(every) > SAME * duration):
        return even
    every = np.union1d(every, even[[0, -1]])
    shares = np.diff(every) * ((number - 1) / duration)
    steps = np.maximum(np.ceil(shares - SAME * number), 1.0).astype(np.intp)
    first = np.concatenate([[0], np.cumsum(steps)])
    place = np.arange(first[-1]) - np.repeat(first[:-1], steps)
    spread = np.repeat(every[:-1], steps) + place * np.repeat(np.diff(every) / steps, steps)
    return np.append(spread, every[-1])


def apart(times: Array, others: Array, least: float) -> Array:
    """Return the times that are farther than that from all others, which are sorted."""
    if len(others) == 0:
        return times
    after = np.searchsorted(others, times).clip(0, len(others) - 1)
    nearest = np.minimum(np.abs(times - others[after]), np.abs(times - others[after - 1]))
    return np.asarray(times[nearest > least])


def turning_knots(knots: Array, values: Array) -> Array:
    """Return the knots at which a path turns back, on its way from zero to values at all knots."""
    steps = np.diff(values, prepend=0.0)
    moves = np.flatnonzero(steps)
    turns = np.sign(steps[moves[1:]]) != np.sign(steps[moves[:-1]])
    return np.asarray(knots[moves[:-1][turns]])


def thinned(points: Pairs | Array, allowed: float) -> Array:
    """Leave out points of a table that those before and after tell, within an allowed error.

    The first and the last point stay, and the largest and the smallest value.

    Returns
    -------
    Numbers of the points that stay, in their order.
    """
    times, values = np.array(points).T.tolist()
    kept, tops = [0], {values.index(max(values)), values.index(min(values))}
    low, high = -math.inf, math.inf
    for place in range(1, len(times)):
        last = kept[-1]
        slope = (values[place] - values[last]) / (times[place] - times[last])
        if place - 1 > last and (place - 1 in tops or not low <= slope <= high):
            last = place - 1
            kept.append(last)
            low, high = -math.inf, math.inf
        span = times[place] - times[last]
        low = max(low, (values[place] - allowed - values[last]) / span)
        high = min(high, (values[place] + allowed - values[last]) / span)
    if len(times) > 1:
        kept.append(len(times) - 1)
    return np.array(kept)
