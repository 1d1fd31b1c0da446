"""What was set before: steps back through settings, comparisons and lessons, and on again."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from app.session.session import Session
from solver.lessons.lesson import Lesson
from solver.settings import Settings

MOST_STEPS = 50


@dataclass(frozen=True)
class Moment:
    """What is set at a time, and what was predicted in the lesson."""

    settings: Settings
    twin: Settings | None
    lesson: Lesson | None
    choice: int | None

    def is_as(self, other: Moment) -> bool:
        """Tell whether a step would lead from one to the other and change nothing."""
        runs = zip((self.settings, self.twin), (other.settings, other.twin), strict=True)
        return self.lesson is other.lesson and all(_values(a) == _values(b) for a, b in runs)


class Undo:
    """Undoes what was set, step by step, and does it again; a drag is one step.

    Parameters
    ----------
    session
        Of the page.
    take
        Is in a lesson of a name, or in none.
    """

    def __init__(self, session: Session, take: Callable[[str], None]) -> None:
        self._session, self._take = session, take
        self._before: deque[Moment] = deque(maxlen=MOST_STEPS)
        self._after: list[Moment] = []
        self._now = self._moment()
        self._drag = 0
        self._is_step = False
        watched = ["wanted", "twin", "lesson", "choice"]
        session.param.watch(lambda *events: self._note(), watched)

    def undo(self) -> None:
        """Go a step back."""
        if self._before:
            self._after.append(self._now)
            self._go(self._before.pop())

    def redo(self) -> None:
        """Go on by a step that was undone."""
        if self._after:
            self._before.append(self._now)
            self._go(self._after.pop())

    def _moment(self) -> Moment:
        session = self._session
        return Moment(session.wanted, session.twin, session.lesson, session.choice)

    def _note(self) -> None:
        """Take what holds now as a step, unless it is one of ours, of a class, or of a drag."""
        before, self._now = self._now, self._moment()
        session, room = self._session, self._session.attendance.follows
        is_of_class = room is not None and room.settings is session.wanted
        if self._is_step or is_of_class or self._now.is_as(before):
            return
        if session.drag == 0 or session.drag != self._drag:
            self._before.append(before)
        self._after.clear()
        self._drag = session.drag
        self._tell()

    def _go(self, goal: Moment) -> None:
        session = self._session
        self._is_step, self._drag = True, 0
        try:
            with session.together():
                if _values(goal.twin) != _values(session.twin):
                    session.twin = goal.twin
                    session.start(goal.settings)
                else:
                    session.adopt(goal.settings)
            if goal.lesson is not session.lesson:
                self._take(goal.lesson.name if goal.lesson else "")
                session.choice = goal.choice
        finally:
            self._is_step = False
        self._tell()

    def _tell(self) -> None:
        self._session.steps = bool(self._before), bool(self._after)


def _values(settings: Settings | None) -> Any:
    return settings and (settings.scene, settings.values())
