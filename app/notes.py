"""Notes that come up on the page and go by themselves."""

from __future__ import annotations

from typing import Any

import panel as pn

TOLD_FOR = 8000
"""Milliseconds for which a note stands."""


class Notes:
    """What the user is told beside what stands on the page."""

    def __init__(self) -> None:
        self._refusal: Any = None

    def complain(self, text: str) -> None:
        """Tell what was refused and why; without words, that nothing is any more."""
        if self._refusal is not None:
            self._refusal.destroy()
        self._refusal = None
        if text and pn.state.notifications is not None:
            self._refusal = pn.state.notifications.error(text, duration=TOLD_FOR)

    def tell(self, text: str) -> None:
        """Tell what was done."""
        if pn.state.notifications is not None:
            pn.state.notifications.success(text, duration=TOLD_FOR)
