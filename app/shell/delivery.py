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
        self._sent = 0
        self._sent_at = 0.0
        self._lost = session.turns.timer(self._ask_again)
        self._scene = session.settings.scene
        self._is_dimmed = False
        pulse.on("painted", self._on_painted)
        session.param.watch(lambda *events: self._dim(), ["facts", "settings"])

    def send(self, block: bytes) -> None:
        """Send a picture; it is of the run at work, once there is something to say of that."""
        self._sent_at = time.monotonic()
        self._lost.set(LOST_AFTER)
        self._sent += 1
        self._pulse.paint(self._sent, block)
        if self._session.facts is not None:
            self._scene = self._session.settings.scene
        self._dim()

    def _ask_again(self) -> None:
        """Ask for all of the page again where the last picture does not arrive."""
        self._lost.set(LOST_AFTER)
        self._session.ask(afresh=True)

    def _dim(self) -> None:
        """Tell plots that do not show the run's scene from those that do."""
        is_dimmed = self._session.facts is None and not self._sent
        is_dimmed = is_dimmed or self._session.settings.scene != self._scene
        if is_dimmed != self._is_dimmed:
            self._is_dimmed = is_dimmed
            self._plots.styles = DIMMED if is_dimmed else CLEAR

    def _on_painted(self, number: int) -> None:
        if number < self._sent:
            return
        self._lost.stop()
        if self._is_seen():
            self._session.ask(rest=REST * (time.monotonic() - self._sent_at))
