"""Masing's rule: how what rubs answers a load that turns, from how it answers one that grows."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from solver.arrays import Array

Turn = tuple[float, float]
"""A load, and the answer at it."""


def masing(load: Array, grown: Callable[[float], float]) -> Array:
    """Answer a load from rest on.

    From a turning point on the answer is the first curve, doubled in both directions; a loop that
    closes is forgotten, and what went on before goes on (G. Masing, 1926, with Madelung's memory).

    Parameters
    ----------
    load
        Over time, shape (n_instants,); monotone between instants.
    grown
        The answer to a load that has grown from rest to a value, which is not negative.

    Returns
    -------
    Shape (n_instants,).
    """
    turns: list[Turn] = [(0.0, 0.0)]
    now: Turn = turns[0]
    found = np.zeros_like(load)
    for place, value in enumerate(load.tolist()):
        if (value - now[0]) * (now[0] - turns[-1][0]) < 0.0:
            turns.append(now)
        while len(turns) > 1 and _closes(value, turns):
            del turns[-2 if len(turns) > 2 else -1 :]
        now = value, _branch(value, turns, grown)
        found[place] = now[1]
    return found


def _closes(value: float, turns: list[Turn]) -> bool:
    """Tell whether a load has come back to where the turn before the last one was, or beyond.

    Where that is rest, the first curve goes on at the opposite of the last one.
    """
    (before, _), (last, _) = turns[-2:]
    size = abs(last - before) if len(turns) > 2 else 2.0 * abs(last)
    return abs(value - last) >= size


def _branch(value: float, turns: list[Turn], grown: Callable[[float], float]) -> float:
    start, answer = turns[-1]
    double = 2.0 if len(turns) > 1 else 1.0
    way = value - start
    return answer + double * float(np.copysign(grown(abs(way) / double), way))
