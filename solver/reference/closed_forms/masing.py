"""Masing's rule: the answer to a load that turns from that to a load that grows.

From a turning point on the answer is the first curve, doubled in both directions; a
loop that closes is forgotten, and what went on before goes on (G. Masing, 1926, with
Madelung's memory).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from solver.arrays import Array


def masing(load: Array, grown: Callable[[float], float]) -> Array:
    """Answer to a load from rest on, (n_instants,), monotone between instants.

    `grown` is that to a load which has grown from rest to a value, which is not
    negative.
    """
    turns = [(0.0, 0.0)]  # loads, and the answers at them
    now = turns[0]
    answers = np.zeros_like(load)
    for instant, value in enumerate(load.tolist()):
        if (value - now[0]) * (now[0] - turns[-1][0]) < 0.0:
            turns.append(now)
        while len(turns) > 1 and _closes(value, turns):
            del turns[-2 if len(turns) > 2 else -1 :]
        double = 2.0 if len(turns) > 1 else 1.0
        start, answer = turns[-1]
        way = value - start
        now = value, answer + double * float(np.copysign(grown(abs(way) / double), way))
        answers[instant] = now[1]
    return answers


def _closes(value: float, turns: list[tuple[float, float]]) -> bool:
    """Check that a load is back at the turn before the last one, or beyond.

    Where that is rest, the first curve goes on at the opposite of the last one.
    """
    (before, _), (last, _) = turns[-2:]
    if len(turns) > 2:
        size = abs(last - before)
    else:
        size = 2.0 * abs(last)
    return abs(value - last) >= size
