"""How late the event loop is, which all pages of a server share: what is late, every page feels."""

from __future__ import annotations

import asyncio
import logging
import time
from collections import deque

STEP = 0.25
"""Seconds between two looks."""
WINDOW = 60.0
"""Seconds that are looked back on, and between two complaints."""
LATE = 0.3
"""Seconds of standing still that a user notices."""

_log = logging.getLogger(__name__)


class Lateness:
    """How late a task was woken, over the last minute."""

    def __init__(self) -> None:
        self._found: deque[float] = deque([0.0], maxlen=round(WINDOW / STEP))
        self._said = -WINDOW

    async def watch(self) -> None:
        """Look, for as long as the server runs."""
        slept = time.monotonic()
        while True:
            await asyncio.sleep(STEP)
            slept, asleep = time.monotonic(), slept
            self.note(slept, slept - asleep - STEP)

    def note(self, now: float, late: float) -> None:
        """Keep how late it was; complain if that was much, at most once a minute."""
        self._found.append(max(late, 0.0))
        if late > LATE and now - self._said >= WINDOW:
            self._said = now
            _log.warning("The event loop stood still for %.2f s; all pages waited for it.", late)

    def facts(self) -> dict[str, float]:
        """Give the most of the last minute, and what 95 % of the looks stayed below, s."""
        ordered = sorted(self._found)
        return {
            "most": round(ordered[-1], 3),
            "95%": round(ordered[int(0.95 * (len(ordered) - 1))], 3),
        }
