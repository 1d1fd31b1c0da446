"""Pictures on their way to the browser, until it has painted them."""

from __future__ import annotations

import time
from collections.abc import Callable

from app.components.pulse import Pulse
from app.session.session import Session
from app.shell.gallery import Gallery

CLEAR, DIMMED = {"opacity": "1"}, {"opacity": "0.35"}
"""Plots that show the scene at work, and those that do not yet."""
LOST_AFTER = 2.0
"""Seconds after which a picture that was not acknowledged is taken for lost."""
REST = 0.2
"""Times what a browser needs for a picture, left to it to listen to its user."""


class Delivery:
    """Sends pictures, and has the next one made when the last was painted, or is lost.

    Parameters
    ----------
    session
        Has them made.
    pulse
        Takes them, and says when they are painted.
    plots
        What they are painted in.
    is_seen
        Whether the page shows its plots.
    """

    def __init__(
        self, session: Session, pulse: Pulse, plots: Gallery, is_seen: Callable[[], bool]
    ) -> None:
        self._session = session
        self._pulse = pulse
        self._plots = plots
        self._is_seen = is_seen
        self._sent = self._painted = 0
        self._sent_at = 0.0
        self._scene = session.settings.scene
        self._is_dimmed = False
        pulse.on("painted", self._on_painted)

    def send(self, block: bytes) -> None:
        """Send a picture; it is of the run at work, once there is something to say of that."""
        self._sent_at = time.monotonic()
        self._sent += 1
        self._pulse.paint(self._sent, block)
        if self._session.facts is not None:
            self._scene = self._session.settings.scene

    def seek_the_lost(self) -> None:
        """Ask for all of the page again where the last picture does not arrive."""
        if self._painted < self._sent and time.monotonic() - self._sent_at > LOST_AFTER:
            self._sent_at = time.monotonic()
            self._session.ask(afresh=True)

    def dim(self) -> None:
        """Tell plots that do not show the run's scene from those that do."""
        is_dimmed = self._session.facts is None and not self._sent
        is_dimmed = is_dimmed or self._session.settings.scene != self._scene
        if is_dimmed != self._is_dimmed:
            self._is_dimmed = is_dimmed
            self._plots.styles = DIMMED if is_dimmed else CLEAR

    def _on_painted(self, number: int) -> None:
        self._painted = number
        if number == self._sent and self._is_seen():
            self._session.ask(rest=REST * (time.monotonic() - self._sent_at))
