"""Driving a sweep: pieces of its path to an executor, and rows as they come."""

from __future__ import annotations

import json
import math
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass, field

from solver.running.pool import EndedError, OverdueError, Pool
from solver.study.sweep.order import snake
from solver.study.sweep.plan import Plan
from solver.study.sweep.point import (
    LOST,
    STUCK,
    Piece,
    Row,
    VersionsDifferError,
    nothing,
    run_piece,
    versions,
)

PATIENCE = 0.2
"""Seconds between two looks at whether a sweep is still wanted, and how many workers there are."""
AHEAD = 2
"""Pieces under way for each process, so that none waits for the next."""
MOST = 64
"""Points of a piece: far more than the time budget of one allows."""
TRIES = 3
"""Times that a point is tried alone if its process is ended; then it is taken for the cause."""


def sweep(
    plan: Plan,
    pool: Pool,
    *,
    done: Collection[int] = (),
    limit: float = math.inf,
    fields: str | None = None,
    warm: bool = True,
    cancelled: Callable[[], bool] = lambda: False,
) -> Iterator[Row]:
    """Run the points of a plan that are not done yet.

    Parameters
    ----------
    plan
        What to run.
    pool
        Where.
    done
        Numbers of the points to leave out.
    limit
        Seconds that a run may take.
    fields
        Folder for the fields of every run, which all processes share; None keeps none.
    warm
        Whether runs may start from their neighbours, where no reading is of how they went.
    cancelled
        Asked several times a second whether to end it.

    Yields
    ------
    One row for every other point, as they come, in any order. Closing the generator ends the
    sweep: what is not begun is not done, and what runs in processes of this machine is ended.

    Raises
    ------
    VersionsDifferError
        Where a worker's results would be those of other code.
    GoneError
        Where there is no cluster any more; the same sweep can go on in another.
    """
    course = Schedule(plan, pool, limit, fields, warm, _waiting(plan, done))
    try:
        while not cancelled() and course.send():
            yield from course.hear()
    finally:
        course.cancel()


def _waiting(plan: Plan, done: Collection[int]) -> deque[int]:
    left = set(range(plan.size)) - set(done)
    return deque(number for number in snake(plan.shape) if number in left)


@dataclass(eq=False)
class Schedule:
    """What of a sweep waits, and what is under way.

    Attributes
    ----------
    waiting
        Points along the path.
    suspects
        Points of pieces whose process was ended: they are tried alone.
    tries
        How often each was.
    pieces
        What is under way.
    """

    plan: Plan
    pool: Pool
    limit: float
    fields: str | None
    warm: bool
    waiting: deque[int]
    suspects: deque[int] = field(default_factory=deque)
    tries: dict[int, int] = field(default_factory=dict)
    pieces: dict[Future[list[Row]], tuple[int, ...]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._text = json.dumps(self.plan.plain())

    def send(self) -> bool:
        """Send pieces until enough are under way; tell whether any is."""
        width = self.pool.width
        while len(self.pieces) < AHEAD * width and (self.suspects or self.waiting):
            if self.suspects:
                numbers = [self.suspects.popleft()]
            else:
                fair = math.ceil(len(self.waiting) / (AHEAD * width))
                numbers = [self.waiting.popleft() for _ in range(min(MOST, fair))]
            piece = Piece(
                self._text, tuple(numbers), self.limit, self.fields, self.warm, versions()
            )
            self.pieces[self.pool.submit(run_piece, piece)] = piece.numbers
        return bool(self.pieces)

    def cancel(self) -> None:
        """End what is under way."""
        for future in self.pieces:
            future.cancel()

    def hear(self) -> Iterator[Row]:
        """Wait a moment for a piece; give its rows, and have the rest of it wait again."""
        finished, _ = wait(self.pieces, timeout=PATIENCE, return_when=FIRST_COMPLETED)
        for future in finished:
            numbers = self.pieces.pop(future)
            try:
                rows = future.result()
            except ImportError as trouble:
                raise VersionsDifferError(f"it cannot run this: {trouble}") from None
            except EndedError as trouble:
                yield from self._lost(numbers, trouble)
            else:
                yield from rows
                self.waiting.extendleft(reversed(numbers[len(rows) :]))

    def _lost(self, numbers: Iterable[int], trouble: EndedError) -> Iterator[Row]:
        """Try the points of a lost piece again, each alone, and give up those that end it."""
        alone = len(numbers := tuple(numbers)) == 1
        for number in numbers:
            if alone:
                self.tries[number] = self.tries.get(number, 0) + 1
            is_overdue = alone and isinstance(trouble, OverdueError)
            if is_overdue or self.tries.get(number, 0) >= TRIES:
                why = f"It was given up: {trouble}."
                yield nothing(self.plan, number, STUCK if is_overdue else LOST, why)
            else:
                self.suspects.append(number)
