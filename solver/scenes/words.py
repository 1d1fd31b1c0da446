"""Words that sentences about scenes share: how something acts over time, how many there are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from solver.arrays import Array

NUMBERS = [
    "no",
    "one",
    "two",
    "three",
    "four",
    "five",
    "six",
    "seven",
    "eight",
    "nine",
    "ten",
    "eleven",
    "twelve",
]
AGAIN = 2
"""Times that a load comes and goes from which it does so again and again."""


def counted(number: int) -> str:
    """A number as a word, if it is small."""
    return NUMBERS[number] if number < len(NUMBERS) else str(number)


def acting(
    path: Array,
    forward: str,
    backward: str,
    both: str = "{} to and fro",
    back: str = "{} and let go",
) -> str:
    """What is done over time by a load: forward where it is positive, backward, or both.

    It is said in other words that it is done both ways, and that it comes back.
    """
    size = np.abs(path)
    peak = float(size.max(initial=0.0))
    if peak == 0.0:
        return f"not {forward}"
    if min(path.max(), -path.min()) > 0.0:
        return both.format(forward)
    word = forward if path.max() > 0.0 else backward
    over = np.concatenate([[False], size > 0.5 * peak, [False]])
    times = int(np.sum(over[1:] & ~over[:-1]))
    if times >= AGAIN:
        return f"{word} again and again"
    return back.format(word) if size[-1] < 0.5 * peak else word


def listed(parts: Sequence[str]) -> str:
    """Write parts with commas, and the last with an "and"."""
    *first, last = parts
    return f"{', '.join(first)} and {last}" if first else last


def is_steel(young: float) -> bool:
    """Whether something is about as stiff as steel."""
    return 190e9 <= young <= 220e9
