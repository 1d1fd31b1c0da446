"""Load paths over time, presets or tables of points, and the instants of a run.

A preset is a path over the phase of an interval, from 0 to 1.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, Indices
from solver.settings.definitions import Rows

RANDOM_POINTS = 12
"""Straight lines of a random walk."""
NO_LOAD = 1e-14
"""Largest value of a sine that rounding leaves at a whole number of half waves."""
DECAY = np.array([1.0, -0.85, 0.7, -0.55, 0.4, -0.25, 0.1])
"""Turning points of "decaying", as shares of the value."""
HELD = 0.25
"""Share of the interval after which "hold" stays at its value, and "delayed" and
"cycles" begin."""
CYCLES = 6
"""Cycles of the presets "cycles", "shaken" and "pulses"."""
LOOSE = 0.2
"""Share of its pressure that a loosened bolt has left."""
SAME = 1e-12
"""Largest distance of equal times by rounding, as a share of the interval."""
NO_KNOTS = np.zeros(0)
Wave = Callable[[Array], Array]


def interpolate(points: Rows | Array, where: Array) -> Array:
    """Interpolate a table (abscissa, value): linear inside, constant outside.

    `where` are abscissae of any shape; the values have that shape, too.
    """
    abscissae, values = np.array(points).T
    between: Array = np.interp(where, abscissae, values)
    # Between points that almost coincide the slope may exceed the largest number.
    steep = ~np.isfinite(between)
    if steep.any():
        before = np.searchsorted(abscissae, where[steep], side="right") - 1
        between[steep] = values[before]
    return between


@dataclass(frozen=True)
class Preset:
    """A preset of a path over the phase of the interval.

    Attributes
    ----------
    description
        The path in a line, in which "the value" is the largest that it reaches.
    points
        Function of a seed, which matters to random paths: phases after the beginning,
        from 0 to 1, and ordinates, both of shape (n_points,).
    begins
        Share of the interval up to which the path keeps its first ordinate.
    repeats
        Share of the interval from which on the path is periodic; None: it is not.
    wave
        Function from phases after the beginning to ordinates of the same shape, of a
        path that bends between its points.
    """

    description: str
    points: Callable[[int], tuple[Array, Array]]
    begins: float = 0.0
    repeats: float | None = None
    wave: Wave | None = None

    def value(self, phase: Array, seed: int, cycles: int = 1) -> Array:
        """Values at phases of the interval, both of shape (n_phases,).

        The periodic part is passed `cycles` times in the same time.
        """
        if cycles > 1 and self.repeats is not None:
            # The periodic part is run through faster, the part before it as it is.
            turns = cycles * (phase - self.repeats) / (1.0 - self.repeats)
            again = self.repeats + (1.0 - self.repeats) * (turns - np.floor(turns))
            phase = np.where(phase > self.repeats, again, phase)
        after = np.maximum(phase - self.begins, 0.0) / (1.0 - self.begins)
        if self.wave:
            return self.wave(after)
        return np.interp(after, *self.points(seed))

    def corners(self, seed: int, cycles: int = 1) -> Array:
        """Phases inside the interval at which the path has kinks, (n_corners,)."""
        corners = self.begins + (1.0 - self.begins) * self.points(seed)[0][:-1]
        corners = corners[corners > 0.0]
        if cycles == 1 or self.repeats is None:
            return corners
        turn = np.append(self.repeats, corners[corners > self.repeats]) - self.repeats
        later = (np.arange(cycles)[:, None] * (1.0 - self.repeats) + turn) / cycles
        return np.append(corners[corners < self.repeats], self.repeats + later)


def lines(
    description: str,
    *ordinates: float,
    begins: float = 0.0,
    repeats: float | None = None,
    wave: Wave | None = None,
) -> Preset:
    """Preset of ordinates at evenly spaced phases."""
    points = np.linspace(0.0, 1.0, len(ordinates)), np.array(ordinates)
    return Preset(description, lambda seed: points, begins, repeats, wave)


def _walk(seed: int) -> tuple[Array, Array]:
    """Phases and ordinates of a random walk, each of shape (RANDOM_POINTS + 1,)."""
    steps = np.random.default_rng(seed).uniform(-1.0, 1.0, RANDOM_POINTS)
    walk = np.concatenate([[0.0], np.cumsum(steps)])
    return np.linspace(0.0, 1.0, len(walk)), walk / np.max(np.abs(walk))


def _size_of_walk(seed: int) -> tuple[Array, Array]:
    """Phases and ordinates of a random walk's size, (n_points,), with its zeros."""
    phases, walk = _walk(seed)
    # A line that crosses zero turns there once it has no sign.
    crossed = np.flatnonzero(walk[:-1] * walk[1:] < 0.0)
    zeros = crossed + walk[crossed] / (walk[crossed] - walk[crossed + 1])
    every = np.union1d(phases, zeros / RANDOM_POINTS)
    size = np.abs(np.interp(every, phases, walk))
    return every, np.where(np.isin(every, phases), size, 0.0)


def _sine(phase: Array) -> Array:
    """Sine of period 1, of the shape of the phases, without rounding at zeros."""
    wave = np.sin(2.0 * np.pi * phase)
    return np.where(np.abs(wave) < NO_LOAD, 0.0, wave)


def _sine_squared(phase: Array) -> Array:
    """Squared sine with two waves in a period of 1, of the shape of the phases."""
    return _sine(phase) ** 2


QUARTERS = 0.0, 1.0, 0.0, -1.0, 0.0
PRESETS: dict[str, Preset] = {
    "ramp": lines(
        "rises evenly from 0 to the value, which it has at the end", 0.0, 1.0
    ),
    "triangle": lines(
        "rises evenly to the value in the middle of the interval, and falls back to 0",
        *(0.0, 1.0, 0.0),
        repeats=0.0,
    ),
    "cycle": lines(
        "goes to the value, to its opposite and to the value again, in straight lines",
        *(*QUARTERS, 1.0),
        repeats=0.2,
    ),
    "sine": lines(
        "a wave of a sine: to the value, to its opposite, and back to 0",
        *QUARTERS,
        repeats=0.0,
        wave=_sine,
    ),
    "decaying": lines(
        "goes to and fro, to 1, -0.85, 0.7, -0.55, 0.4, -0.25 and 0.1 times the value, "
        "and to 0",
        *(0.0, *DECAY, 0.0),
        repeats=0.0,
    ),
    "random": Preset(
        "a random walk of 12 straight lines, as the seed has it, whose largest size is "
        "the value",
        _walk,
    ),
    "hold": Preset(
        "rises evenly to the value in the first quarter of the interval, and stays "
        "there",
        lambda seed: (np.array([0.0, HELD, 1.0]), np.array([0.0, 1.0, 1.0])),
    ),
    "delayed": lines(
        "0 for the first quarter of the interval, then a wave of a sine: to the value, "
        "to its opposite, and back to 0",
        *QUARTERS,
        begins=HELD,
        repeats=HELD,
        wave=_sine,
    ),
    "cycles": lines(
        "0 for the first quarter of the interval, then six times to the value, to its "
        "opposite and back to 0, in straight lines",
        *(0.0, *QUARTERS[1:] * CYCLES),
        begins=HELD,
        repeats=HELD,
    ),
}

LATER = lines(
    "0 for the first quarter of the interval, then rises evenly to the value, which it "
    "has at the end",
    *(0.0, 1.0),
    begins=HELD,
)
"""A ramp before which a structure comes to stand."""
PULLS: dict[str, Preset] = {
    **PRESETS,
    "cycle": lines(
        "goes to the value, to 0, to the value, to 0 and to the value again, in "
        "straight lines",
        *(0.0, 1.0, 0.0, 1.0, 0.0, 1.0),
        repeats=0.2,
    ),
    "sine": lines(
        "two waves of a sine squared, from 0 to the value and back",
        *QUARTERS,
        repeats=0.0,
        wave=_sine_squared,
    ),
    "decaying": lines(
        "goes up and down, to 1, 0.075, 0.85, 0.225, 0.7, 0.375 and 0.55 times the "
        "value, and to 0",
        *(0.0, *(0.5 + 0.5 * DECAY), 0.0),
        repeats=0.0,
    ),
    "random": Preset(
        "the size of a random walk of 12 straight lines, as the seed has it, at most "
        "the value",
        _size_of_walk,
    ),
    "delayed": lines(
        "0 for the first quarter of the interval, then two waves of a sine squared, "
        "from 0 to the value and back",
        *QUARTERS,
        begins=HELD,
        repeats=HELD,
        wave=_sine_squared,
    ),
    "cycles": lines(
        "0 for the first quarter of the interval, then six times to the value and back "
        "to 0, in straight lines",
        *(0.0, *[1.0, 0.0] * CYCLES),
        begins=HELD,
        repeats=HELD,
    ),
}
"""Presets that never push, for what carries tension alone."""

PRESSURES: dict[str, Preset] = {
    "steady": lines("the value from the beginning to the end", 1.0, 1.0),
    "loosening": lines(
        "the value for the first quarter of the interval, then falls evenly to a fifth "
        "of it, as of a bolt",
        *(1.0, LOOSE),
        begins=HELD,
    ),
    "tightening": lines(
        "a fifth of the value for the first quarter of the interval, then rises evenly "
        "to the value",
        *(LOOSE, 1.0),
        begins=HELD,
    ),
    "shaken": lines(
        "the value for the first quarter of the interval, then six times down to a "
        "fifth of it and back, in straight lines",
        *(1.0, *[LOOSE, 1.0] * CYCLES),
        begins=HELD,
        repeats=HELD,
    ),
}
"""Presets of a pressure: never zero, and the value at the beginning or at the end."""

INJECTIONS: dict[str, Preset] = {
    "steady": PRESSURES["steady"],
    "stopped": lines(
        "the value for half of the interval, then nothing; what has spread goes on",
        *(1.0, 1.0, 0.0),
        wave=lambda phase: np.where(phase <= 0.5, 1.0, 0.0),
    ),
    "rising": lines(
        "rises evenly from nothing to the value, which it has at the end", 0.0, 1.0
    ),
    "pulses": lines(
        "the value, then six times down to nothing and back, in straight lines",
        *(1.0, *[0.0, 1.0] * CYCLES),
        repeats=0.0,
    ),
    "random": PULLS["random"],
}
"""Presets of a fluid that is let in from the beginning."""


def instants_of(
    duration: float, number: int, knots: Array = NO_KNOTS, corners: Array = NO_KNOTS
) -> Array:
    """Instants of a time interval, (n_instants,), s, including the knots of paths.

    Between knots instants are evenly spaced.

    Parameters
    ----------
    duration
        Length of the interval, s.
    number
        Number of equidistant instants from 0 to the end, whose step no step of the
        result exceeds; 1 is the end alone.
    knots
        Points of tables, (n_knots,), s; knots outside the interval do not count.
    corners
        Points of presets, (n_corners,), s. A corner that differs by rounding alone from
        an instant or a knot is that instant or knot.
    """
    if number > 1:
        even = np.linspace(0.0, duration, number)
    else:
        even = np.array([duration])
    rounding = SAME * duration
    knots = np.unique(knots[(knots >= 0.0) & (knots <= duration)])
    corners = np.unique(corners)
    corners = corners[np.diff(corners, prepend=-duration) > rounding]
    # Points of tables are kept to the bit, corners of presets only up to rounding.
    every = np.union1d(knots, apart(corners, knots, rounding))
    is_among_even = len(apart(every, even, rounding)) == 0
    # Knots that are even instants already: most paths need no others.
    if is_among_even and np.all(np.diff(every) > rounding):
        return even
    every = np.union1d(every, even[[0, -1]])
    # Each interval between knots gets as many steps as keep it within the given step.
    shares = np.diff(every) * ((number - 1) / duration)
    steps = np.maximum(np.ceil(shares - SAME * number), 1.0).astype(np.intp)
    return _divided(every, steps)


def _divided(ends: Array, steps: Indices) -> Array:
    """Divide intervals between ends, (n_intervals + 1,), into equal steps each.

    `steps` is the number of steps of each interval, (n_intervals,).
    """
    first = np.concatenate([[0], np.cumsum(steps)])
    step = np.arange(first[-1]) - np.repeat(first[:-1], steps)
    length = np.repeat(np.diff(ends) / steps, steps)
    spread = np.repeat(ends[:-1], steps) + step * length
    return np.append(spread, ends[-1])


def apart(times: Array, others: Array, distance: float) -> Array:
    """Times that are farther than a distance from all of `others`.

    Times and others are of shape (n_times,) and (n_others,), s; others are sorted.
    """
    if len(others) == 0:
        return times
    after = np.searchsorted(others, times).clip(0, len(others) - 1)
    nearest = np.minimum(
        np.abs(times - others[after]), np.abs(times - others[after - 1])
    )
    return np.asarray(times[nearest > distance])


def turning_knots(knots: Array, values: Array) -> Array:
    """Knots, (n_turns,), s, at which a path from zero reverses.

    Knots, s, and the values of the path there have shape (n_knots,).
    """
    steps = np.diff(values, prepend=0.0)
    moves = np.flatnonzero(steps)
    turns = np.sign(steps[moves[1:]]) != np.sign(steps[moves[:-1]])
    return np.asarray(knots[moves[:-1][turns]])


def thinned(points: Rows | Array, allowed: float) -> Indices:
    """Indices of points of a table, (n_kept,), that keep its path within an error.

    The table has shape (n_points, 2); the error is in the unit of its values. The first
    and the last point are kept, and the largest and the smallest value.
    """
    times, values = np.array(points).T.tolist()
    kept = [0]
    tops = {values.index(max(values)), values.index(min(values))}
    low = -math.inf
    high = math.inf
    for index in range(1, len(times)):
        last = kept[-1]
        # A straight line from the last kept point has to pass all points between within
        # the allowed error: an interval of slopes, which narrows.
        slope = (values[index] - values[last]) / (times[index] - times[last])
        if index - 1 > last and (index - 1 in tops or not low <= slope <= high):
            last = index - 1
            kept.append(last)
            low = -math.inf
            high = math.inf
        span = times[index] - times[last]
        low = max(low, (values[index] - allowed - values[last]) / span)
        high = min(high, (values[index] + allowed - values[last]) / span)
    if len(times) > 1:
        kept.append(len(times) - 1)
    return np.array(kept)
