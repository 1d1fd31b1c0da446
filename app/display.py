"""Pictures of a page: the next one when the browser has painted the last."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterable
from itertools import chain
from typing import Any

import panel as pn
from bokeh.core.properties import Int
from bokeh.model import DataModel
from bokeh.models import CustomJS

from app.messages import Ready
from app.server import PAGES
from app.state import PageState
from app.views.view import View

log = logging.getLogger(__name__)
LOST = 5.0
"""Seconds after which a picture counts as lost, as when the network broke."""
PAINTED = (
    "requestAnimationFrame(() => setTimeout(() => { pulse.painted = pulse.sent }))"
)
"""Script that reports a picture once it is on the screen: a task set within an
animation frame runs after that frame is painted."""
SHORTEST = 0.02
"""Shortest pause between pictures that is kept, s."""


class Pulse(DataModel):
    """Model with the numbers of the newest picture and of the last painted one.

    `looks` counts how often the server looked in vain for the answer.
    """

    sent: int = Int(default=0)  # type: ignore[assignment]
    painted: int = Int(default=0)  # type: ignore[assignment]
    looks: int = Int(default=0)  # type: ignore[assignment]


class Display:
    """Display of the visible views: next picture when the browser has painted the last.

    `views` are those in sight. `also` is called with each picture, inside its hold, for
    parts that are not views, such as the status line. A view that is held when it comes
    in sight is painted from the next picture on: as the browser mounts a page it lays
    each figure out several times.
    """

    def __init__(
        self, state: PageState, document: Any, also: Callable[[], None]
    ) -> None:
        self._state = state
        self._document = document
        self._also = also
        self.views: list[View] = []
        self._is_due = False
        self._sent_at = 0.0
        self._took = 0.0
        self.pulse = Pulse(name="pulse")
        self.pulse.js_on_change(
            "sent", CustomJS(args={"pulse": self.pulse}, code=PAINTED)
        )
        self.pulse.on_change("painted", lambda name, old, new: self._on_painted())
        state.param.watch(
            lambda *events: self._update(),
            ["frame", "selection", "ghost", "is_new", "is_dark"],
        )

    def look_at(self, views: list[View], also: Iterable[str] = ()) -> None:
        """Set the visible views, and further needs of frames."""
        needs = chain.from_iterable(view.needs for view in views)
        self._state.needs = frozenset([*needs, *also])
        if views != self.views or any(view.is_held for view in views):
            self.views = views
            self._update()

    def catch_up(self) -> None:
        """Ask again for the last picture, if its answer counts as lost.

        Until then any message will do. Panel keeps one that comes just as another has
        been written, until it writes the next one.
        """
        if self.pulse.painted == self.pulse.sent:
            return
        if self._is_waiting():
            with pn.io.hold():
                self.pulse.looks += 1
        elif self._is_due:
            self._paint()
        else:
            with pn.io.hold():
                self._count()

    def _is_waiting(self) -> bool:
        """Check whether the browser still paints a picture that is not lost."""
        is_sent = self.pulse.painted < self.pulse.sent
        return is_sent and time.monotonic() < self._sent_at + LOST

    def _update(self) -> None:
        """Paint the newest frame, now or when the last picture is painted."""
        self._is_due = True
        if not self._is_waiting():
            self._paint()

    def _paint(self) -> None:
        """Send the newest frame to all visible views as one message."""
        state = self._state
        frame = self._state.frame
        self._is_due = False
        if frame is None:
            return
        began = time.thread_time()
        with pn.io.hold():
            for view in self.views:
                try:
                    view.update(frame, state.selection, state.ghost)
                except Exception:
                    # The other views, and the page, outlive it.
                    log.exception("The view %s failed.", view.name)
            self._also()
            is_seen = self.pulse.painted == self.pulse.sent
            self._count()
        self._took = time.thread_time() - began
        if is_seen and not state.is_dragged:
            # The next frame is made while the browser paints this one.
            state.send(Ready())

    def _count(self) -> None:
        """Number a picture after all its changes: the browser returns the number."""
        self._sent_at = time.monotonic()
        self.pulse.sent += 1

    def _on_painted(self) -> None:
        """Continue after a pause for other pages.

        All pages share the server's thread.
        """
        with pn.io.hold():
            for view in self.views:
                if view.is_held:
                    view.hold(False)
        pause = self._sent_at + PAGES.pause(self._took) - time.monotonic()
        if pause < SHORTEST:
            self._go_on()
        else:
            self._document.add_timeout_callback(self._go_on, int(1000 * pause))

    def _go_on(self) -> None:
        if self._is_due:
            self._paint()
        else:
            self._state.send(Ready())
