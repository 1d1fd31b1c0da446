"""When a browser gets which views: it paints few at once sooner than all, and needs rest."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

from app.pulse import Pulse
from app.views.drawing import View

IN_FLIGHT = 1
"""Pictures that may be on their way to the browser."""
LOST_AFTER = 2.0
"""Seconds after which a picture that was not acknowledged is taken for lost."""
REST = 2.0
"""Times what a browser needs for a picture, left to it to listen to its user."""
VIEWS_AT_ONCE = 3
VIEWS_AT_FIRST = 1


@dataclass(frozen=True)
class Turn:
    """Views to be drawn now; with the first picture of a run the rest of the page waits."""

    views: Sequence[View]
    is_first: bool


class Painter:
    """Views take turns, so that none is sent faster than the browser paints.

    Parameters
    ----------
    pulse
        Tells which of the pictures sent are painted.
    """

    def __init__(self, pulse: Pulse) -> None:
        self._pulse = pulse
        self._changed = False
        self._owed: list[View] = []
        self._owes_the_rest = False
        self._drawn_ticket = -1
        self._sent_at = 0.0
        self._rest_until = 0.0
        pulse.param.watch(lambda event: self._rest(event.new), "painted")

    def mark(self) -> None:
        """Take it that there is something to be drawn."""
        self._changed = True

    def has_drawn(self, ticket: int) -> bool:
        """Tell whether the last first picture was that of this run."""
        return ticket == self._drawn_ticket

    def turn(self, shown: Sequence[View], ticket: int | None) -> Turn | None:
        """Give what is to be drawn now, or None if there is nothing or the browser is at work.

        Parameters
        ----------
        shown
            The views on the page, in their order.
        ticket
            Of the run that has something to show, if any.
        """
        if not (self._changed or self._owed or self._owes_the_rest):
            return None
        # The first picture of a run overtakes what is still on its way.
        first = ticket is not None and not self.has_drawn(ticket)
        now = time.monotonic()
        if not (first or self._is_free(now)):
            return None
        self._sent_at = now
        if self._changed:
            self._owed += [view for view in shown if view not in self._owed]
            self._changed = False
        if first and ticket is not None:
            self._drawn_ticket = ticket
            self._owed = list(shown)
        self._owes_the_rest = first
        count = VIEWS_AT_FIRST if first else VIEWS_AT_ONCE
        views, self._owed = self._owed[:count], self._owed[count:]
        return Turn([view for view in views if view in shown], first)

    def send(self) -> None:
        """Have the browser say when it has painted what was drawn."""
        self._pulse.frame += 1

    def _is_free(self, now: float) -> bool:
        in_flight = self._pulse.frame - self._pulse.painted
        free = in_flight < IN_FLIGHT and now >= self._rest_until
        return free or now - self._sent_at > LOST_AFTER

    def _rest(self, painted: int) -> None:
        """Leave the browser twice as long as it painted to listen to its user."""
        if painted == self._pulse.frame:
            now = time.monotonic()
            self._rest_until = now + REST * (now - self._sent_at)
