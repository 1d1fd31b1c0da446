"""How parts are timed: in turns, so that a machine that slows down slows all of them."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence


def samples_of(
    parts: Sequence[Callable[[], object]], repeats: int, calls: int = 1
) -> list[list[float]]:
    """Measure parts in turns, each so many calls long; give the seconds of a call of each."""
    samples: list[list[float]] = [[] for _ in parts]
    for _ in range(repeats):
        for part, own in zip(parts, samples, strict=True):
            own.append(seconds_of(part, calls))
    return samples


def medians_of(parts: Sequence[Callable[[], object]], repeats: int, calls: int) -> list[float]:
    """Give the median of `samples_of` for each part."""
    return [statistics.median(own) for own in samples_of(parts, repeats, calls)]


def seconds_of(part: Callable[[], object], calls: int) -> float:
    """Give the seconds of a call."""
    start = time.perf_counter()
    for _ in range(calls):
        part()
    return (time.perf_counter() - start) / calls
