"""The pages that a server has open, and how many there may be."""

from __future__ import annotations

import os
from pathlib import Path

VARIABLE = "SLIPFRONT_PAGES"
"""Environment variable with the most pages that may be open."""
OF_A_PAGE = 150_000_000
"""Bytes that a page may need, most of them in its worker and its history."""
SHARE = 0.8
"""Of the machine's memory, or the container's, that pages may take together."""
FULL = (
    "<h2>Slipfront is full</h2><p>This server has as many pages open as it can serve. "
    "This page tries again by itself.</p><meta http-equiv=refresh content=20>"
)


class Pages:
    """A count of the pages that are open."""

    def __init__(self, most: int) -> None:
        self._most, self._open = most, 0

    def __len__(self) -> int:
        return self._open

    def enter(self) -> bool:
        """Count a page, if there is room for it."""
        if self._open >= self._most:
            return False
        self._open += 1
        return True

    def leave(self) -> None:
        """Count a page no more."""
        self._open -= 1


def most_pages() -> int:
    """The most pages that may be open, as set, or as the memory allows."""
    if text := os.environ.get(VARIABLE):
        return max(int(text), 1)
    return max(int(SHARE * _memory() / OF_A_PAGE), 1)


def _memory() -> float:
    """Bytes that this machine has, or this container may use."""
    whole = float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    limit = Path("/sys/fs/cgroup/memory.max")
    text = limit.read_text(encoding="ascii").strip() if limit.exists() else "max"
    return whole if text == "max" else min(whole, float(text))


PAGES = Pages(most_pages())
