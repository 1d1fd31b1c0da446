"""What a page keeps of a run: every record, the newest frame, and the one that is looked at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from app.worker.reports import (
    Begun,
    End,
    Frame,
    Progress,
    Reference,
    Refused,
    Report,
    Taken,
    Unrivalled,
    Waiting,
)
from solver.latin import Record, Status
from solver.latin.warm import StartChoice
from solver.settings import Settings

HISTORY = (
    "iteration",
    "seconds",
    "indicator",
    "behaviour",
    "estimated_error",
    "error_displacement",
    "error_force",
)


@dataclass
class Recording:
    """One run, filled by the reports of its worker.

    Attributes
    ----------
    records
        Of all iterations done.
    sizes
        Modes of the substructures `thinned(number, MOST_SIZES)`, one array per record, shape
        (n_shown,); empty with the full linear stage.
    beside
        Records of the full linear stage beside a run on separated bases.
    newest, sought
        The newest frame, and the one last sought.
    is_warm
        Whether it was to start from the run before, where that is better.
    is_broken
        Whether the worker refused it, or it was given up.
    """

    ticket: int
    settings: Settings
    label: str
    begun: Begun | None = None
    reference: Reference | None = None
    records: list[Record] = field(default_factory=list)
    sizes: list[NDArray[np.int16]] = field(default_factory=list)
    beside: list[Record] = field(default_factory=list)
    newest: Frame | None = None
    sought: Frame | None = None
    status: Status | None = None
    notice: str = ""
    is_warm: bool = False
    is_broken: bool = False

    def take(self, report: Report) -> None:
        """Add what a worker reports."""
        match report:
            case Begun():
                if self.begun is not None and self.begun.interface != report.interface:
                    self.reference = self.newest = self.sought = None
                self.begun = report
            case Reference():
                self.reference = report
            case Unrivalled():
                self.reference = None
            case Progress():
                self.records.extend(report.records)
                self.beside.extend(report.beside)
                if report.sizes is not None:
                    self.sizes.extend(report.sizes)
            case Frame(sought=True):
                self.sought = report
            case Frame():
                self.newest = report
            case End():
                self.status = report.status
            case Refused():
                self.notice, self.is_broken = report.reason, True
            case Taken() | Waiting():
                pass
            case _:
                raise TypeError(f"no place for a report of type {type(report).__name__}")

    def lose(self, notice: str, *, is_broken: bool = False) -> None:
        """Forget all iterates: their process is gone."""
        for kept in (self.records, self.sizes, self.beside):
            kept.clear()
        self.newest = self.sought = self.status = None
        self.notice, self.is_broken = notice, is_broken

    @property
    def choice(self) -> StartChoice | None:
        """Which start was chosen, where there was a choice."""
        return self.begun.start if self.begun else None

    @property
    def title(self) -> str:
        """What is new in it, and whether it started from the run before it."""
        warm = self.choice is not None and self.choice.is_previous
        label = self.label or ("first settings" if self.settings.changed() else "defaults")
        return f"{label}{', from the run before it' if warm else ''}"

    @property
    def is_over(self) -> bool:
        """Whether it ended or broke: only another run can go on."""
        return self.status is not None or self.is_broken

    @property
    def iteration(self) -> int:
        """Iterations done, as far as is known."""
        return self.records[-1].iteration if self.records else 0

    @property
    def is_worth_keeping(self) -> bool:
        """Whether the run got far enough to be compared with."""
        return self.status is not None or len(self.records) >= 10

    def history(self, since: int = 0) -> dict[str, NDArray[np.float64]]:
        """Give the columns of the records from a place on, for plots."""
        return columns(self.records[since:])

    def first_within(self, level: float) -> Record | None:
        """Find the first record whose friction force error is at most `level`."""
        return next((entry for entry in self.records if entry.error_force <= level), None)

    def record_of(self, frame: Frame) -> Record | None:
        """Find the record of a frame's iteration."""
        place = frame.iteration - 1
        return self.records[place] if 0 <= place < len(self.records) else None


def columns(records: Sequence[Record]) -> dict[str, NDArray[np.float64]]:
    """Give records as columns, for plots."""
    return {name: np.array([getattr(entry, name) for entry in records]) for name in HISTORY}
