"""What of a run is still to be sent: all of its records, and of its frames the newest."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace

from app.worker.bases import sizes
from app.worker.reports import Frame, Progress, Report
from solver.latin import Record

PUBLISH_EVERY = 1.0 / 25.0
"""Seconds between two frames of a run that goes on by itself."""


class Outbox:
    """Records that wait, and whether a frame is owed.

    Parameters
    ----------
    ticket
        Of the run.
    send
        Takes reports.
    """

    def __init__(self, ticket: int, send: Callable[[Report], None]) -> None:
        self._ticket = ticket
        self._send = send
        self._records: list[Record] = []
        self._beside: list[Record] = []
        self._owes_frame = False
        self._publish_at = 0.0

    def add(self, entry: Record, beside: Sequence[Record]) -> None:
        """Take the record of an iteration, and those of the full stage beside it."""
        self._records.append(entry)
        self._beside += beside

    def owe_frame(self) -> None:
        """Note that there is a newer iterate than the one that was shown."""
        self._owes_frame = True

    def rest(self) -> float | None:
        """Give the seconds until a frame is due; None if none is owed."""
        return max(self._publish_at - time.monotonic(), 0.0) if self._owes_frame else None

    def publish(self, frame: Callable[[], Frame]) -> None:
        """Send all records, and if one is owed, the frame that is then made."""
        if self._records:
            self._send(
                Progress(
                    self._ticket,
                    tuple(
                        replace(entry, reduction=()) if entry.reduction else entry
                        for entry in self._records
                    ),
                    sizes(self._records),
                    tuple(self._beside),
                )
            )
            self._records.clear()
            self._beside.clear()
        if self._owes_frame:
            self._send(frame())
            self._owes_frame = False
        self._publish_at = time.monotonic() + PUBLISH_EVERY
