"""Paints the views in sight: the next picture follows once the browser has painted the last."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import panel as pn
from bokeh.core.properties import Int
from bokeh.model import DataModel
from bokeh.models import CustomJS

from app.messages import Ready
from app.state import PageState

if TYPE_CHECKING:
    from app.views.view import View

log = logging.getLogger(__name__)
LOST = 5.0
"""Seconds after which a picture counts as lost, as when the network broke."""
PAINTED = "requestAnimationFrame(() => requestAnimationFrame(() => { pulse.painted = pulse.sent }))"


class Pulse(DataModel):
    """Number of the newest picture, and of the last one that is on the screen."""

    sent: int = Int(default=0)  # type: ignore[assignment]
    painted: int = Int(default=0)  # type: ignore[assignment]


class Display:
    """The views in sight.

    Parameters
    ----------
    state
        Of the page.
    also
        Called with each picture, inside its hold: what is not a view, as the status line.

    Attributes
    ----------
    pulse
        The model by which the browser says what it has painted.
    """

    def __init__(self, state: PageState, also: Callable[[], None]) -> None:
        self._state, self._also = state, also
        self._views: Sequence[View] = ()
        self._is_due = False
        self._sent_at = 0.0
        self.pulse = Pulse(name="pulse")
        self.pulse.js_on_change("sent", CustomJS(args={"pulse": self.pulse}, code=PAINTED))
        self.pulse.on_change("painted", lambda name, old, new: self._painted())
        state.param.watch(lambda *events: self.update(), ["frame", "selection", "ghost"])

    @property
    def views(self) -> Sequence[View]:
        """The views in sight."""
        return self._views

    @views.setter
    def views(self, views: Sequence[View]) -> None:
        self._views = views
        self._state.needs = frozenset(need for view in views for need in view.needs)
        self.update()

    @property
    def is_waiting(self) -> bool:
        """Whether a picture is on its way to the screen."""
        return (
            bool(self.pulse.painted < self.pulse.sent) and time.monotonic() < self._sent_at + LOST
        )

    def update(self) -> None:
        """Paint what there is, now or once the last picture is on the screen."""
        self._is_due = True
        if not self.is_waiting:
            self._paint()

    def catch_up(self) -> None:
        """Ask again whether the last picture is on the screen, once its answer counts as lost."""
        if self.pulse.painted < self.pulse.sent and not self.is_waiting:
            if self._is_due:
                self._paint()
            else:
                self._sent_at = time.monotonic()
                self.pulse.sent += 1

    def _paint(self) -> None:
        state, frame = self._state, self._state.frame
        self._is_due = False
        if frame is None:
            return
        with pn.io.hold():
            for view in self._views:
                try:
                    view.update(frame, state.selection, state.ghost)
                except Exception:
                    # The other views, and the page, outlive it.
                    log.exception("The view %s failed.", view.name)
            self._also()
            self._sent_at = time.monotonic()
            self.pulse.sent += 1

    def _painted(self) -> None:
        if self._is_due:
            self._paint()
        self._state.send(Ready())
