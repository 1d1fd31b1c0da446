"""The time that a run is billed for."""

from __future__ import annotations

import time


class Clock:
    """Time that the method takes; it runs from birth until stopped."""

    def __init__(self, seconds: float = 0.0) -> None:
        self.seconds = seconds
        self.go_on()

    def go_on(self) -> None:
        """Run again."""
        self._since: float | None = time.perf_counter()

    def stop(self) -> None:
        """Stand still."""
        if self._since is not None:
            self.seconds += time.perf_counter() - self._since
        self._since = None
