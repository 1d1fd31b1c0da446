"""How a page opens: the load goes through its cycle, until somebody touches the page."""

from __future__ import annotations

from app.components.pulse import Pulse
from app.session.session import Session
from app.session.state import TABS, VIEWS
from app.shell.transport import Transport

LOOPS = 3
"""Cycles after which it rests if nobody has touched it."""
LARGEST = 5000
"""Nodes of a scene whose pictures come often enough."""


class Opening:
    """Plays through time again and again once the first run has ended.

    The browser says whether the page may move at all, and when it is first touched.

    Parameters
    ----------
    session, pulse, transport
        What is shown, what the browser says, and what plays.
    is_still
        Whether the page was asked for at an instant, or at an iteration.
    """

    def __init__(
        self, session: Session, pulse: Pulse, transport: Transport, *, is_still: bool
    ) -> None:
        self._session, self._pulse, self._transport = session, pulse, transport
        self._rest = session.look.phase
        self._is_past = is_still
        watch = session.param.watch
        watch(lambda *events: self._look(), ["facts", "settings", "lesson", "room", "tab", "view"])
        pulse.param.watch(lambda *events: self._look(), ["calm", "hidden"])

    def _look(self) -> None:
        """Begin as soon as there is an answer to show, and end for good as soon as one may not."""
        session, facts = self._session, self._session.facts
        if self._is_past:
            return
        if session.opens:
            if not (self._may() and self._transport.plays):
                self._end()
        elif facts is not None and (facts.is_over or facts.is_broken):
            self._is_past = not (facts.is_over and self._may())
            if not self._is_past:
                session.opens = True
                self._transport.loop(LOOPS, self._end)

    def _may(self) -> bool:
        """Tell whether the page is one that stands alone, in sight, untouched, and quick."""
        session = self._session
        is_own = session.lesson is None and session.room is None and not session.attendance.leads
        is_seen = session.tab == TABS[0] and session.view == VIEWS[0] and not self._pulse.hidden
        is_light = session.settings.n_nodes <= LARGEST and session.settings.instants > 1
        return is_own and is_seen and is_light and not self._pulse.calm

    def _end(self) -> None:
        """Rest at the instant that is looked at first."""
        self._is_past = True
        self._transport.stop()
        self._session.watch(phase=self._rest)
        self._session.opens = False
