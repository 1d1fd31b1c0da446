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
        self._stood = session.wanted

    def complain(self, text: str) -> None:
        """Tell what was refused and why; without words, that nothing is any more."""
        if self._refusal is not None:
            self._refusal.destroy()
        self._refusal, self._stood = None, self._session.wanted
        if text and pn.state.notifications is not None:
            self._refusal = pn.state.notifications.error(text, duration=STAYS)

    def follow(self) -> None:
        """Take back what was refused, once other settings are wanted, wherever they come from."""
        if self._refusal is not None and self._session.wanted is not self._stood:
            self.complain("")

    def tell(self, text: str) -> None:
        """Tell what was done."""
        if pn.state.notifications is not None:
            pn.state.notifications.success(text, duration=TOLD_FOR)
