"""When a browser gets a picture: as a whole, once it has painted the last and rested."""

from __future__ import annotations

import time

from app.pulse import Pulse

LOST_AFTER = 2.0
"""Seconds after which a picture that was not acknowledged is taken for lost."""
REST = 0.2
"""Times what a browser needs for a picture, left to it to listen to its user."""


class Painter:
    """No picture is built before the browser has painted the last.

    Parameters
    ----------
    pulse
        Tells which of the pictures sent are painted.
    """

    def __init__(self, pulse: Pulse) -> None:
        self._pulse = pulse
        self._changed = False
        self._sent_at = 0.0
        self._rest_until = 0.0
        pulse.param.watch(lambda event: self._rest(event.new), "painted")

    def mark(self) -> None:
        """Take it that there is something to be drawn."""
        self._changed = True

    def is_due(self) -> bool:
        """Tell whether there is something to be drawn, and the browser is ready for it."""
        return self._changed and self._is_free(time.monotonic())

    def send(self) -> None:
        """Have the browser say when it has painted what was drawn."""
        self._changed = False
        self._sent_at = time.monotonic()
        self._pulse.frame += 1

    def _is_free(self, now: float) -> bool:
        free = self._pulse.frame <= self._pulse.painted and now >= self._rest_until
        return free or now - self._sent_at > LOST_AFTER

    def _rest(self, painted: int) -> None:
        """Leave the browser a while to listen to its user."""
        if painted == self._pulse.frame:
            now = time.monotonic()
            self._rest_until = now + REST * (now - self._sent_at)
