"""Load paths: a scalar over time, from a named preset or from a table of points."""

from __future__ import annotations

from collections.abc import Callable, Mapping

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


def interpolate(points: Pairs | Array, where: Array) -> Array:
    """Evaluate a table of (abscissa, value), linear in between and held outside."""
    abscissae, values = np.array(points).T
    found: Array = np.interp(where, abscissae, values)
    steep = ~np.isfinite(found)
    if steep.any():  # a slope beyond the largest number: points that all but coincide
        found[steep] = values[np.searchsorted(abscissae, where[steep], side="right") - 1]
    return found


def _polyline(ordinates: Array) -> Callable[[Array, int], Array]:
    return lambda phase, seed: _evenly(ordinates, phase)


def _evenly(ordinates: Array, phase: Array) -> Array:
    points = np.column_stack([np.linspace(0.0, 1.0, len(ordinates)), ordinates])
    return interpolate(points, phase)


def _random_walk(phase: Array, seed: int) -> Array:
    steps = np.random.default_rng(seed).uniform(-1.0, 1.0, RANDOM_POINTS)
    walk = np.concatenate([[0.0], np.cumsum(steps)])
    return _polyline(walk / np.max(np.abs(walk)))(phase, seed)


def _sine(phase: Array) -> Array:
    found = np.sin(2.0 * np.pi * phase)
    return np.where(np.abs(found) < NO_LOAD, 0.0, found)


def _after_hold(phase: Array) -> Array:
    return np.maximum(phase - HELD, 0.0) / (1.0 - HELD)


def _pulsating(phase: Array) -> Array:
    return _sine(phase) ** 2


_cycles = _polyline(np.array([0.0, *[1.0, 0.0, -1.0, 0.0] * CYCLES]))
_pulls = _polyline(np.array([0.0, *[1.0, 0.0] * CYCLES]))
PRESETS: dict[str, Callable[[Array, int], Array]] = {
    "ramp": _polyline(np.array([0.0, 1.0])),
    "triangle": _polyline(np.array([0.0, 1.0, 0.0])),
    "cycle": _polyline(np.array([0.0, 1.0, 0.0, -1.0, 0.0, 1.0])),
    "sine": lambda phase, seed: _sine(phase),
    "decaying": _polyline(np.concatenate([[0.0], DECAY, [0.0]])),
    "random": _random_walk,
    "hold": lambda phase, seed: np.minimum(phase / HELD, 1.0),
    "delayed": lambda phase, seed: _sine(_after_hold(phase)),
    "cycles": lambda phase, seed: _cycles(_after_hold(phase), seed),
}

PULLS: dict[str, Callable[[Array, int], Array]] = {
    "ramp": PRESETS["ramp"],
    "triangle": PRESETS["triangle"],
    "cycle": _polyline(np.array([0.0, 1.0, 0.0, 1.0, 0.0, 1.0])),
    "sine": lambda phase, seed: _pulsating(phase),
    "decaying": _polyline(np.concatenate([[0.0], 0.5 + 0.5 * DECAY, [0.0]])),
    "random": lambda phase, seed: np.abs(_random_walk(phase, seed)),
    "hold": PRESETS["hold"],
    "delayed": lambda phase, seed: _pulsating(_after_hold(phase)),
    "cycles": lambda phase, seed: _pulls(_after_hold(phase), seed),
}
"""Presets that never push, for what carries tension alone."""

_loosening = _polyline(np.array([1.0, LOOSE]))
_pulsating_press = _polyline(np.array([1.0, *[LOOSE, 1.0] * CYCLES]))
PRESSURES: dict[str, Callable[[Array, int], Array]] = {
    "steady": lambda phase, seed: np.ones_like(phase),
    "loosening": lambda phase, seed: _loosening(_after_hold(phase), seed),
    "tightening": lambda phase, seed: 1.0 + LOOSE - _loosening(_after_hold(phase), seed),
    "shaken": lambda phase, seed: _pulsating_press(_after_hold(phase), seed),
}
"""Presets of what presses: all of it at first, or in the end, and never nothing."""

_pulses = _polyline(np.array([1.0, *[0.0, 1.0] * CYCLES]))
INJECTIONS: dict[str, Callable[[Array, int], Array]] = {
    "steady": PRESSURES["steady"],
    "stopped": lambda phase, seed: np.where(phase <= 0.5, 1.0, 0.0),
    "rising": _polyline(np.array([0.0, 1.0])),
    "pulses": _pulses,
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


def instants_of(duration: float, number: int) -> Array:
    """Spread instants evenly over a time interval, shape (number,), s; a single one ends it."""
    return np.linspace(0.0, duration, number) if number > 1 else np.array([duration])


def load_path(
    path: str | Pairs,
    instants: Array,
    duration: float,
    peak: float,
    seed: int,
    presets: Mapping[str, Callable[[Array, int], Array]] = PRESETS,
    cycles: int = 1,
) -> Array:
    """Evaluate a load path at the instants of a run.

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

    Returns
    -------
    Values at the instants, shape (n_instants,).
    """
    if not isinstance(path, str):
        return interpolate(path, instants)
    phase = instants / duration
    if cycles > 1 and path in BEGINS:
        phase = _repeated(phase, BEGINS[path], cycles)
    return peak * presets[path](phase, seed)


def _repeated(phase: Array, begins: float, cycles: int) -> Array:
    """Go through what comes after a beginning so often in the same time."""
    turns = cycles * (phase - begins) / (1.0 - begins)
    again = begins + (1.0 - begins) * (turns - np.floor(turns))
    return np.where(phase > begins, again, phase)
