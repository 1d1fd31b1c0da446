"""Values that come back from the browser though nobody chose them.

Panel's React wrapper sends a value back after it has shown it. Where the next one came meanwhile,
that looks like a choice of the last but one (panel/models/react_component.ts, `useState`).
"""

from __future__ import annotations

import time
from collections import deque
from typing import Any

LASTS = 1.0
"""Seconds after which a value that was shown no longer comes back."""


class Echoes:
    """The values that a widget was given lately."""

    def __init__(self) -> None:
        self._given: deque[tuple[float, Any]] = deque(maxlen=64)

    def give(self, value: Any, before: Any) -> Any:
        """Note a value and the one that it takes the place of, and return it for the widget."""
        now = time.monotonic()
        if value != before:
            # What is empty was never shown.
            self._given.extend((now, each) for each in (before, value) if each != "")
        return value

    def has(self, value: Any) -> bool:
        """Whether a value that the widget reports was given to it just now."""
        since = time.monotonic() - LASTS
        return any(when > since and given == value for when, given in self._given)
