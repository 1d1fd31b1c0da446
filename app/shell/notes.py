"""Notes that come up: of what was done for a while, of what was refused until a change."""

from __future__ import annotations

from typing import Any

import panel as pn

from app.session.session import Session

STAYS, TOLD_FOR = 0, 8000
"""Milliseconds for which a note stands; none has it stand until it is taken away."""


class Notes:
    """What the user is told beside what stands on the page."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._refusal: Any = None
        # What is told again may have been taken away in the browser.
        watch = session.param.watch
        watch(lambda event: self._complain(event.new), "refusal", onlychanged=False)
        watch(lambda event: self._tell(event.new), "told", onlychanged=False)

    def _complain(self, text: str) -> None:
        if self._refusal is not None:
            self._refusal.destroy()
            self._refusal = None
        if text and pn.state.notifications is not None:
            self._refusal = pn.state.notifications.error(self._session.say(text), duration=STAYS)

    def _tell(self, text: str) -> None:
        if pn.state.notifications is not None:
            pn.state.notifications.success(self._session.say(text), duration=TOLD_FOR)
