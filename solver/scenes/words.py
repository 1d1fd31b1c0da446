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


def counted(number: int, what: str) -> str:
    """Write how many there are of what is called so in the singular."""
    word = NUMBERS[number] if number < len(NUMBERS) else str(number)
    return f"{word} {what}" if number == 1 else f"{word} {what}s"


def acting(path: Array, forward: str, backward: str, both: str = "to and fro") -> str:
    """Say what is done over time by a load: forward where it is positive, backward, or both."""
    size = np.abs(path)
    peak = float(size.max(initial=0.0))
    if peak == 0.0:
        return f"not {forward}"
    if min(path.max(), -path.min()) > 0.0:
        return f"{forward} {both}"
    word = forward if path.max() > 0.0 else backward
    over = np.concatenate([[False], size > 0.5 * peak, [False]])
    times = int(np.sum(over[1:] & ~over[:-1]))
    if times >= AGAIN:
        return f"{word} again and again"
    return f"{word} and let go" if size[-1] < 0.5 * peak else word


def listed(parts: Sequence[str]) -> str:
    """Write parts with commas, and the last with an "and"."""
    *first, last = parts
    return f"{', '.join(first)} and {last}" if first else last


def material(young: float) -> str:
    """Name what is about as stiff as steel, with its article."""
    return "a steel" if 190e9 <= young <= 220e9 else "an elastic"


def sentence(text: str) -> str:
    """Begin with a capital, and end with a full stop."""
    return f"{text[0].upper()}{text[1:]}."
