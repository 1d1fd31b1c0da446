"""Whether somebody is there: a page that nobody sees has its run wait."""

from __future__ import annotations

from typing import Any

from app.components.innards import connections, on_sockets, send_without_delay
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
        self._is_alone = self._is_silent = False
        self._sockets: set[Any] = set()
        self._silence = session.turns.timer(self._on_silence)
        pulse.on("beat", self._on_beat)

    def begin(self) -> None:
        """Take it that a browser has built the page."""
        on_sockets(lambda: self._session.turns.soon(self._look))
        self._pulse.param.watch(lambda event: self._look(), "hidden")

    def _look(self) -> None:
        """See who is there."""
        sockets = connections()
        if sockets != self._sockets:
            # What was on its way in a socket that broke is lost, and nobody says so.
            self._sockets = sockets
            send_without_delay(sockets)
            self._session.ask(afresh=True)
        is_alone = not sockets or self._pulse.hidden or self._is_silent
        if is_alone != self._is_alone:
            self._is_alone = is_alone
            self._session.rest(is_alone)
            self._session.ask(afresh=True)

    def _on_silence(self) -> None:
        self._is_silent = True
        self._look()

    def _on_beat(self, beat: int) -> None:
        """Answer a sign of life; a page that missed some is given all that it has to show."""
        self._silence.set(SILENT)
        self._pulse.heard = beat
        if self._is_silent:
            self._is_silent = False
            self._look()
        if beat < 0:
            self._session.ask(afresh=True)
