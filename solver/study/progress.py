"""What a long study tells whoever waits for it."""

from __future__ import annotations

from collections.abc import Callable

Tell = Callable[[str, float], None]
"""Takes what is being done, and the share of the whole that is done, from 0 to 1."""


def silent(doing: str, share: float) -> None:
    """Tell nobody."""
