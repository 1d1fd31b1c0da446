"""Load paths: a scalar over time, from a named preset or from a table of points."""

from __future__ import annotations

from collections.abc import Callable, Mapping
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


def interpolate(points: Pairs | Array, where: Array) -> Array:
    """Evaluate a table of (abscissa, value), linear in between and held outside."""
    abscissae, values = np.array(points).T
    found: Array = np.interp(where, abscissae, values)
    steep = ~np.isfinite(found)
    if steep.any():  # a slope beyond the largest number: points that all but coincide
        found[steep] = values[np.searchsorted(abscissae, where[steep], side="right") - 1]
    return found


@dataclass(frozen=True)
class Preset:
    """A path over the phase of an interval, from 0 to 1; called with phases and a seed.

    Attributes
    ----------
    value
        Values at phases, for a seed of what is random.
    corners
        Phases inside the interval at which it turns back or bends, for such a seed.
    """

    value: Callable[[Array, int], Array]
    corners: Callable[[int], Array] = lambda seed: np.zeros(0)

    def __call__(self, phase: Array, seed: int) -> Array:
        """Evaluate it."""
        return self.value(phase, seed)


def _equal_pieces(number: int, begins: float = 0.0) -> Callable[[int], Array]:
    """Corners between equal pieces of what comes after a beginning, and where that ends."""
    phases = begins + (1.0 - begins) * np.linspace(0.0, 1.0, number + 1)[:-1]
    return lambda seed: phases[phases > 0.0]


def _polyline(ordinates: Array, begins: float = 0.0) -> Preset:
    return Preset(
        lambda phase, seed: _evenly(ordinates, _after_hold(phase) if begins else phase),
        _equal_pieces(len(ordinates) - 1, begins),
    )


def _evenly(ordinates: Array, phase: Array) -> Array:
    points = np.column_stack([np.linspace(0.0, 1.0, len(ordinates)), ordinates])
    return interpolate(points, phase)


def _walk(seed: int) -> Array:
    steps = np.random.default_rng(seed).uniform(-1.0, 1.0, RANDOM_POINTS)
    walk = np.concatenate([[0.0], np.cumsum(steps)])
    return np.asarray(walk / np.max(np.abs(walk)))


def _random_walk(phase: Array, seed: int) -> Array:
    return _evenly(_walk(seed), phase)


def _corners_of_size(seed: int) -> Array:
    """Corners of a random walk's size: its own, and where it changes its sign."""
    walk = _walk(seed)
    crossed = np.flatnonzero(walk[:-1] * walk[1:] < 0.0)
    zeros = crossed + walk[crossed] / (walk[crossed] - walk[crossed + 1])
    return np.sort(np.concatenate([np.arange(1, RANDOM_POINTS), zeros])) / RANDOM_POINTS


def _sine(phase: Array) -> Array:
    found = np.sin(2.0 * np.pi * phase)
    return np.where(np.abs(found) < NO_LOAD, 0.0, found)


def _after_hold(phase: Array) -> Array:
    return np.maximum(phase - HELD, 0.0) / (1.0 - HELD)


def _pulsating(phase: Array) -> Array:
    return _sine(phase) ** 2


PRESETS: dict[str, Preset] = {
    "ramp": _polyline(np.array([0.0, 1.0])),
    "triangle": _polyline(np.array([0.0, 1.0, 0.0])),
    "cycle": _polyline(np.array([0.0, 1.0, 0.0, -1.0, 0.0, 1.0])),
    "sine": Preset(lambda phase, seed: _sine(phase), _equal_pieces(4)),
    "decaying": _polyline(np.concatenate([[0.0], DECAY, [0.0]])),
    "random": Preset(_random_walk, _equal_pieces(RANDOM_POINTS)),
    "hold": Preset(lambda phase, seed: np.minimum(phase / HELD, 1.0), _equal_pieces(1, HELD)),
    "delayed": Preset(lambda phase, seed: _sine(_after_hold(phase)), _equal_pieces(4, HELD)),
    "cycles": _polyline(np.array([0.0, *[1.0, 0.0, -1.0, 0.0] * CYCLES]), HELD),
}

PULLS: dict[str, Preset] = {
    "ramp": PRESETS["ramp"],
    "triangle": PRESETS["triangle"],
    "cycle": _polyline(np.array([0.0, 1.0, 0.0, 1.0, 0.0, 1.0])),
    "sine": Preset(lambda phase, seed: _pulsating(phase), _equal_pieces(4)),
    "decaying": _polyline(np.concatenate([[0.0], 0.5 + 0.5 * DECAY, [0.0]])),
    "random": Preset(lambda phase, seed: np.abs(_random_walk(phase, seed)), _corners_of_size),
    "hold": PRESETS["hold"],
    "delayed": Preset(lambda phase, seed: _pulsating(_after_hold(phase)), _equal_pieces(4, HELD)),
    "cycles": _polyline(np.array([0.0, *[1.0, 0.0] * CYCLES]), HELD),
}
"""Presets that never push, for what carries tension alone."""

_loosening = _polyline(np.array([1.0, LOOSE]), HELD)
PRESSURES: dict[str, Preset] = {
    "steady": Preset(lambda phase, seed: np.ones_like(phase)),
    "loosening": _loosening,
    "tightening": Preset(
        lambda phase, seed: 1.0 + LOOSE - _loosening(phase, seed), _loosening.corners
    ),
    "shaken": _polyline(np.array([1.0, *[LOOSE, 1.0] * CYCLES]), HELD),
}
"""Presets of what presses: all of it at first, or in the end, and never nothing."""

INJECTIONS: dict[str, Preset] = {
    "steady": PRESSURES["steady"],
    "stopped": Preset(lambda phase, seed: np.where(phase <= 0.5, 1.0, 0.0), _equal_pieces(2)),
    "rising": _polyline(np.array([0.0, 1.0])),
    "pulses": _polyline(np.array([1.0, *[0.0, 1.0] * CYCLES])),
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
    """Return the times at which a path turns or bends, as for `load_path`; a table's points."""
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
