"""Masing's rule: response to any load path from that to a growing load.

From a turning point on the answer is the first curve, doubled in both directions. A
loop that closes is forgotten, and the answer continues as if it had not been (G.
Masing, 1926, with Madelung's memory).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from solver.arrays import Array


def masing(load: Array, grown: Callable[[float], float]) -> Array:
    """Response to a load from rest, (n_instants,), in the unit of `grown`.

    Parameters
    ----------
    load
        The load, monotone between instants, shape (n_instants,).
    grown
        First curve: the answer to a load that has grown from rest to a value, which is
        not negative.
    """
    # Loads at turning points that are remembered, and the answers there.
    turns = [(0.0, 0.0)]
    now = turns[0]
    answers = np.zeros_like(load)
    for instant, value in enumerate(load.tolist()):
        if (value - now[0]) * (now[0] - turns[-1][0]) < 0.0:
            turns.append(now)
        while len(turns) > 1 and _closes(value, turns):
            # A closed loop goes with both its turns; rest itself is never forgotten.
            del turns[-2 if len(turns) > 2 else -1 :]
        double = 2.0 if len(turns) > 1 else 1.0
        start, answer = turns[-1]
        change = value - start
        step = float(np.copysign(grown(abs(change) / double), change))
        now = value, answer + double * step
        answers[instant] = now[1]
    return answers


def _closes(value: float, turns: list[tuple[float, float]]) -> bool:
    """Check whether a load has returned to the turn before the last one, or beyond.

    Where that is rest, the first curve continues at the opposite of the last one.
    """
    (before, _), (last, _) = turns[-2:]
    if len(turns) > 2:
        size = abs(last - before)
    else:
        size = 2.0 * abs(last)
    return abs(value - last) >= size
