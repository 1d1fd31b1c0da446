"""Whether somebody is there: a page that nobody sees has its run wait."""

from __future__ import annotations

import math
import time
from typing import Any

from app.components.innards import connections, send_without_delay
from app.components.pulse import Pulse
from app.session.session import Session

SILENT = 30.0
"""Seconds without a sign of life after which nobody is there, though no connection was closed."""


class Presence:
    """Watches the sockets and the signs of life of a page.

    Parameters
    ----------
    session
        Is told when the last one goes and the first one comes.
    pulse
        Gives the signs.
    """

    def __init__(self, session: Session, pulse: Pulse) -> None:
        self._session = session
        self._pulse = pulse
        self._is_loaded = False
        self._is_alone = True
        self._heard_at = math.inf
        self._sockets: set[Any] = set()
        pulse.on("beat", self._on_beat)

    def begin(self) -> None:
        """Take it that a browser has built the page."""
        self._is_loaded, self._is_alone = True, False

    def check(self) -> None:
        """See who is there; to be called at every tick."""
        is_silent = time.monotonic() - self._heard_at > SILENT
        sockets = connections()
        if sockets != self._sockets:
            # What was on its way in a socket that broke is lost, and nobody says so.
            self._sockets = sockets
            send_without_delay(sockets)
            self._session.ask(afresh=True)
        is_alone = not sockets or self._pulse.hidden or not self._is_loaded or is_silent
        if is_alone != self._is_alone:
            self._is_alone = is_alone
            self._session.rest(is_alone)
            self._session.ask(afresh=True)

    def _on_beat(self, beat: int) -> None:
        """Answer a sign of life; a page that missed some is given all that it has to show."""
        self._heard_at = time.monotonic()
        self._pulse.heard = beat
        if beat < 0:
            self._session.ask(afresh=True)
