"""What is to be run as soon as the last change was shown, and the hand that moves it."""

from __future__ import annotations

import time

from solver.settings import Settings

HELD_STILL = 0.5
"""Seconds after which a slider that does not move counts as let go."""


class Pending:
    """The newest of the changes that a page has asked for.

    Attributes
    ----------
    settings
        With that change; None where all changes are at work.
    by_hand
        Whether it is one of many while a slider is dragged.
    """

    def __init__(self) -> None:
        self.settings: Settings | None = None
        self.by_hand = False
        self._moved_at = 0.0

    def put(self, settings: Settings, *, by_hand: bool) -> None:
        """Have these be run in place of those that were to be."""
        self.settings, self.by_hand = settings, by_hand
        self._moved_at = time.monotonic()

    @property
    def is_still(self) -> bool:
        """Whether a hand that has moved something moves it no more."""
        return time.monotonic() - self._moved_at > HELD_STILL
