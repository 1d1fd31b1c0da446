"""Load paths over time, from a named preset or a table of points, and the instants of a run.

A preset is a path over the phase of an interval, from 0 to 1.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.definitions import Pairs

RANDOM_POINTS = 12
NO_LOAD = 1e-14
"""What rounding makes of a whole number of half waves, where a load vanishes."""
DECAY = np.array([1.0, -0.85, 0.7, -0.55, 0.4, -0.25, 0.1])
HELD = 0.25
"""Share of the interval after which "hold" stays where it is, and "delayed" and "cycles" begin."""
CYCLES = 6
LOOSE = 0.2
"""Share of its pressure that a bolt has left when it has loosened."""
SAME = 1e-12
"""Share of the interval by which rounding may set one time apart from another."""
NO_KNOTS = np.zeros(0)


def interpolate(points: Pairs | Array, where: Array) -> Array:
    """Values of a table of (abscissa, value), linear in between and held outside."""
    abscissae, values = np.array(points).T
    between: Array = np.interp(where, abscissae, values)
    steep = ~np.isfinite(between)
    if steep.any():  # a slope beyond the largest number: points that all but coincide
        between[steep] = values[np.searchsorted(abscissae, where[steep], side="right") - 1]
    return between


@dataclass(frozen=True)
class Preset:
    """A path with a name.

    Attributes
    ----------
    value
        Values at phases, for a seed of what is random.
    corners
        Phases inside the interval at which it turns back or bends, for such a seed.
    """

    value: Callable[[Array, int], Array]
    corners: Callable[[int], Array] = lambda seed: NO_KNOTS


def _even_corners(pieces: int, begins: float = 0.0) -> Callable[[int], Array]:
    """Corners between equal pieces of what comes after a beginning, and where that ends."""
    phases = begins + (1.0 - begins) * np.linspace(0.0, 1.0, pieces + 1)[:-1]
    return lambda seed: phases[phases > 0.0]


def _polyline(ordinates: Sequence[float] | Array, begins: float = 0.0) -> Preset:
    """Straight lines between ordinates, evenly spaced after a beginning that has the first."""
    return Preset(
        lambda phase, seed: _evenly(ordinates, _after(begins, phase)),
        _even_corners(len(ordinates) - 1, begins),
    )


def _evenly(ordinates: Sequence[float] | Array, phase: Array) -> Array:
    return np.interp(phase, np.linspace(0.0, 1.0, len(ordinates)), ordinates)


def _after(begins: float, phase: Array) -> Array:
    return np.maximum(phase - begins, 0.0) / (1.0 - begins)


def _walk(seed: int) -> Array:
    """Ordinates of a random walk."""
    steps = np.random.default_rng(seed).uniform(-1.0, 1.0, RANDOM_POINTS)
    walk = np.concatenate([[0.0], np.cumsum(steps)])
    return np.asarray(walk / np.max(np.abs(walk)))


def _corners_of_size(seed: int) -> Array:
    """Corners of a random walk's size: its own, and where it changes its sign."""
    walk = _walk(seed)
    crossed = np.flatnonzero(walk[:-1] * walk[1:] < 0.0)
    zeros = crossed + walk[crossed] / (walk[crossed] - walk[crossed + 1])
    return np.sort(np.concatenate([np.arange(1, RANDOM_POINTS), zeros])) / RANDOM_POINTS


def _sine(phase: Array) -> Array:
    wave = np.sin(2.0 * np.pi * phase)
    return np.where(np.abs(wave) < NO_LOAD, 0.0, wave)


PRESETS: dict[str, Preset] = {
    "ramp": _polyline([0.0, 1.0]),
    "triangle": _polyline([0.0, 1.0, 0.0]),
    "cycle": _polyline([0.0, 1.0, 0.0, -1.0, 0.0, 1.0]),
    "sine": Preset(lambda phase, seed: _sine(phase), _even_corners(4)),
    "decaying": _polyline([0.0, *DECAY, 0.0]),
    "random": Preset(lambda phase, seed: _evenly(_walk(seed), phase), _even_corners(RANDOM_POINTS)),
    "hold": Preset(lambda phase, seed: np.minimum(phase / HELD, 1.0), _even_corners(1, HELD)),
    "delayed": Preset(lambda phase, seed: _sine(_after(HELD, phase)), _even_corners(4, HELD)),
    "cycles": _polyline([0.0, *[1.0, 0.0, -1.0, 0.0] * CYCLES], HELD),
}

PULLS: dict[str, Preset] = {
    "ramp": PRESETS["ramp"],
    "triangle": PRESETS["triangle"],
    "cycle": _polyline([0.0, 1.0, 0.0, 1.0, 0.0, 1.0]),
    "sine": Preset(lambda phase, seed: _sine(phase) ** 2, _even_corners(4)),
    "decaying": _polyline([0.0, *(0.5 + 0.5 * DECAY), 0.0]),
    "random": Preset(lambda phase, seed: np.abs(_evenly(_walk(seed), phase)), _corners_of_size),
    "hold": PRESETS["hold"],
    "delayed": Preset(lambda phase, seed: _sine(_after(HELD, phase)) ** 2, _even_corners(4, HELD)),
    "cycles": _polyline([0.0, *[1.0, 0.0] * CYCLES], HELD),
}
"""Presets that never push, for what carries tension alone."""

PRESSURES: dict[str, Preset] = {
    "steady": Preset(lambda phase, seed: np.ones_like(phase)),
    "loosening": _polyline([1.0, LOOSE], HELD),
    "tightening": _polyline([LOOSE, 1.0], HELD),
    "shaken": _polyline([1.0, *[LOOSE, 1.0] * CYCLES], HELD),
}
"""Presets of what presses: all of it at first, or in the end, and never nothing."""

INJECTIONS: dict[str, Preset] = {
    "steady": PRESSURES["steady"],
    "stopped": Preset(lambda phase, seed: np.where(phase <= 0.5, 1.0, 0.0), _even_corners(2)),
    "rising": _polyline([0.0, 1.0]),
    "pulses": _polyline([1.0, *[0.0, 1.0] * CYCLES]),
    "random": PULLS["random"],
}
"""Presets of a fluid that is let in from the beginning."""

BEGINS = {
    "triangle": 0.0,
    "sine": 0.0,
    "decaying": 0.0,
    "cycle": 0.2,
    "delayed": HELD,
    "cycles": HELD,
    "pulses": 0.0,
    "shaken": HELD,
}
"""Share of the interval from which on a preset comes back to where it is, and may be repeated."""


def knots_of(
    path: str | Pairs,
    duration: float,
    seed: int,
    presets: Mapping[str, Preset] = PRESETS,
    cycles: int = 1,
) -> Array:
    """Times at which a path turns or bends, as for `load_path`; a table's points."""
    if not isinstance(path, str):
        return np.array(path)[:, 0]
    phases = presets[path].corners(seed)
    if cycles > 1 and path in BEGINS:
        begins = BEGINS[path]
        turn = np.concatenate([[begins], phases[phases > begins]]) - begins
        later = begins + (np.arange(cycles)[:, None] * (1.0 - begins) + turn) / cycles
        phases = np.concatenate([phases[phases < begins], later.ravel()])
    return np.asarray(duration * phases)


def load_path(
    path: str | Pairs,
    instants: Array,
    duration: float,
    peak: float,
    seed: int,
    presets: Mapping[str, Preset] = PRESETS,
    cycles: int = 1,
) -> Array:
    """Values of a load path at the instants of a run, shape (n_instants,).

    Parameters
    ----------
    path
        A preset's name, or points (time in s, value), linear in between and held outside.
    instants
        Shape (n_instants,), s.
    duration
        Length of the interval that a preset fills, s.
    peak
        Largest size that a preset reaches, in the path's unit; a table has its own.
    seed
        Of the random walk.
    presets
        What the names stand for.
    cycles
        How often a preset does what it does from where it begins on; the interval stays.
    """
    if not isinstance(path, str):
        return interpolate(path, instants)
    phase = instants / duration
    if cycles > 1 and path in BEGINS:
        phase = _repeated(phase, BEGINS[path], cycles)
    return peak * presets[path].value(phase, seed)


def _repeated(phase: Array, begins: float, cycles: int) -> Array:
    """Phases that go through what comes after a beginning so often in the same time."""
    turns = cycles * (phase - begins) / (1.0 - begins)
    again = begins + (1.0 - begins) * (turns - np.floor(turns))
    return np.where(phase > begins, again, phase)


def instants_of(
    duration: float, number: int, knots: Array = NO_KNOTS, corners: Array = NO_KNOTS
) -> Array:
    """Instants spread over a time interval, with knots of paths among them.

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
    """Times that are farther than that from all others, which are sorted."""
    if len(others) == 0:
        return times
    after = np.searchsorted(others, times).clip(0, len(others) - 1)
    nearest = np.minimum(np.abs(times - others[after]), np.abs(times - others[after - 1]))
    return np.asarray(times[nearest > least])


def turning_knots(knots: Array, values: Array) -> Array:
    """Knots at which a path turns back, on its way from zero to values at all knots."""
    steps = np.diff(values, prepend=0.0)
    moves = np.flatnonzero(steps)
    turns = np.sign(steps[moves[1:]]) != np.sign(steps[moves[:-1]])
    return np.asarray(knots[moves[:-1][turns]])


def thinned(points: Pairs | Array, allowed: float) -> Array:
    """Numbers of the points of a table that the others do not tell, within an allowed error.

    The first and the last point stay, and the largest and the smallest value.
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
