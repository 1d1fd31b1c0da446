"""Turns of a page whose time goes on as a test wants it."""

from __future__ import annotations

from app.session.turns import Act, Turns

MOST = 500
"""Things that are done in a while that a test lets pass."""


class Clock(Turns):
    """Nothing is done before a test lets time pass."""

    def __init__(self) -> None:
        super().__init__()
        self.now = 0.0
        self._due: list[tuple[float, Act]] = []

    @property
    def is_idle(self) -> bool:
        """Whether nothing is to come."""
        return not self._due

    def soon(self, act: Act) -> None:
        self.later(0.0, act)

    def later(self, seconds: float, act: Act) -> Act:
        made = self.now + seconds, act
        self._due.append(made)
        return lambda: self._due.remove(made)

    def pass_(self, seconds: float) -> None:
        """Let time pass; what comes meanwhile is done in its turn."""
        end, done = self.now + seconds, 0
        while due := [one for one in self._due if one[0] <= end]:
            done += 1
            assert done < MOST, "it goes round and round"
            first = min(due, key=lambda one: one[0])
            self._due.remove(first)
            self.now = first[0]
            first[1]()
        self.now = end
