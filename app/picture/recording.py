"""What is kept of a run: every record, and what its fields stand on."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.picture.frames import DrawnFields, Stand
from app.picture.shown import Counts, thinned
from app.picture.usual import changed
from solver.latin import Iterate, Record, Status
from solver.latin.warm import StartChoice
from solver.phrases import Phrase
from solver.reference.distance import Distance
from solver.settings import Settings

COLUMNS = (
    "iteration",
    "seconds",
    "indicator",
    "behaviour",
    "estimated_error",
    "error_displacement",
    "error_force",
)
WORTH_KEEPING = 10
"""Iterations from which a run that has not ended is compared with."""


class History:
    """The scalars of all iterations, as columns that grow."""

    def __init__(self, records: Sequence[Record] = ()) -> None:
        self._table = np.empty((len(COLUMNS), 64))
        self._count = 0
        for entry in records:
            self.add(entry)

    def __len__(self) -> int:
        return self._count

    def add(self, entry: Record) -> None:
        """Add the record of an iteration."""
        if self._count == self._table.shape[1]:
            self._table = np.concatenate([self._table, np.empty_like(self._table)], axis=1)
        self._table[:, self._count] = [getattr(entry, name) for name in COLUMNS]
        self._count += 1

    def change(self, iteration: int, **figures: float) -> None:
        """Put in what was not known yet when an iteration was added."""
        for name, value in figures.items():
            self._table[COLUMNS.index(name), iteration - 1] = value

    def column(self, name: str) -> NDArray[np.float64]:
        """Give one quantity of all iterations."""
        return self._table[COLUMNS.index(name), : self._count]

    def records(self, count: int) -> list[Record]:
        """Give the first records, with what is kept of them."""
        rows = self._table[:, : min(count, self._count)].T.tolist()
        return [Record(int(number), *scalars) for number, *scalars in rows]

    def thinned(self, most: int, count: int | None = None) -> dict[str, NDArray[np.float64]]:
        """Give all columns, of so many iterations at most, the first and the last among them.

        They are those of the first `count`, or of all.
        """
        done = self._count if count is None else min(count, self._count)
        chosen = thinned(done, most) if done else slice(0)
        return dict(zip(COLUMNS, self._table[:, :done][:, chosen], strict=True))


@dataclass
class Recording:
    """One run.

    Attributes
    ----------
    label, notice
        As in a Run.
    stand, reference
        Of the interface that is looked at; a run has no reference before it is found.
    reference_seconds
        Time that the reference took, s.
    last
        Record of the newest iteration.
    history, beside
        Of the run, and of the full linear stage beside one on separated bases.
    sizes
        Modes of the substructures `thinned(number, MOST_SIZES)`, one array per record, shape
        (n_shown,); empty with the full linear stage.
    frame, shown
        Fields that others are compared with, once the run is one of the past or a run A, and the
        number of their iteration.
    answer
        The number under which its answer is shown, beside the iterates of its search.
    is_warm
        Whether it was to start from the run before, where that is better.
    """

    ticket: int
    settings: Settings
    label: str
    notice: str
    stand: Stand
    reference: DrawnFields | None = None
    reference_seconds: float = math.nan
    last: Record | None = None
    history: History = field(default_factory=History)
    beside: History = field(default_factory=History)
    sizes: list[Counts] = field(default_factory=list)
    frame: DrawnFields | None = None
    shown: int = 0
    status: Status | None = None
    answer: int | None = None
    is_warm: bool = False
    choice: StartChoice | None = None

    def add(self, entry: Record, sizes: Counts | None, beside: Sequence[Record]) -> None:
        """Add an iteration."""
        self.last = entry
        self.answer = entry.iteration if entry.is_answer else None
        self.history.add(entry)
        if sizes is not None:
            self.sizes.append(sizes)
        for other in beside:
            self.beside.add(other)

    def measure(self, iterates: Sequence[Iterate], distance: Distance) -> None:
        """Put in the errors of iterates that were recorded before there was a reference."""
        for iterate in iterates:
            errors: dict[str, Any] = {
                "error_displacement": distance.of_displacement(iterate),
                "error_force": distance.of_friction_force(iterate),
            }
            self.history.change(iterate.number, **errors)
            if self.last is not None and self.last.iteration == iterate.number:
                self.last = replace(self.last, **errors)

    @property
    def title(self) -> str:
        """What is new in it, and whether it started from the run before it."""
        warm = self.choice is not None and self.choice.is_previous
        label = self.label or ("first settings" if changed(self.settings) else "defaults")
        return f"{label}{', from the run before it' if warm else ''}"

    @property
    def iteration(self) -> int:
        """Iterations done, whose records are here, and the answer after them."""
        return self.last.iteration if self.last else 0

    @property
    def searched(self) -> int:
        """Iterations done; the answer beside them is none."""
        return self.iteration - (self.answer is not None)

    def called(self, number: int) -> str:
        """Name an iterate, or the answer."""
        return "answer" if number == self.answer else Phrase("iteration {}", number)

    @property
    def is_worth_keeping(self) -> bool:
        """Whether the run got far enough to be compared with."""
        return self.status is not None or self.iteration >= WORTH_KEEPING

    def first_within(self, level: float) -> int | None:
        """Find the first iteration whose friction force error is at most `level`."""
        within = np.flatnonzero(self.history.column("error_force")[: self.searched] <= level)
        return int(self.history.column("iteration")[within[0]]) if len(within) else None

    def last_within(self, seconds: float) -> int:
        """Find the last iteration that was done after so much run time; 0 before the first."""
        return int(np.searchsorted(self.history.column("seconds"), seconds, side="right"))

    def figures_of(self, iteration: int) -> dict[str, float] | None:
        """Give the scalars of an iteration."""
        if not 0 < iteration <= len(self.history):
            return None
        return {name: float(self.history.column(name)[iteration - 1]) for name in COLUMNS}
