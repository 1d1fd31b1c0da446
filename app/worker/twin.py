"""Run A, which goes in step with the run at work, B: at equal iterations, each to its own end."""

from __future__ import annotations

from app.picture.recording import Recording
from app.picture.sampler import Frame
from app.picture.shown import Look
from app.wire.orders import Pace, Rate, Seek, Step
from app.worker.run import WorkerRun
from solver.settings import Settings


class Twin:
    """Run A, kept from one run B to the next.

    It is as far as B is shown. Where B has ended and A has not, A goes on at the pace of the page.

    Parameters
    ----------
    run
        That of A, at a pace of 0.
    pace
        Of the page, as in a Run.
    """

    def __init__(self, run: WorkerRun, pace: Rate) -> None:
        self._run = run
        self._pace = pace
        self._sought: int | None = None
        self._is_free = False

    @property
    def recording(self) -> Recording:
        """What is kept of it."""
        return self._run.recording

    @property
    def is_over(self) -> bool:
        """Whether it has ended."""
        return self.recording.status is not None

    def is_of(self, settings: Settings) -> bool:
        """Tell whether it has these settings."""
        own = self.recording.settings
        return (own.scene, own.values()) == (settings.scene, settings.values())

    def begin(self, pace: Rate) -> None:
        """Go in step with another run B, from its first iteration on."""
        self._pace, self._sought = pace, None

    def obey(self, order: Pace | Step | Seek, leader: WorkerRun) -> None:
        """Follow an order to both runs; B has followed it already."""
        self._sought = order.iteration if isinstance(order, Seek) else self._sought
        if isinstance(order, Pace):
            self._pace = order.pace
        if isinstance(order, Step):
            self._pace, self._sought = 0.0, None
        if self._goal(leader) is None:
            self._run.obey(order)

    def is_behind(self, leader: WorkerRun) -> bool:
        """Tell whether it has to do something before both are shown side by side."""
        return self._run.is_compared and self._goal(leader) is not None and self._rest(leader) == 0

    def rest(self, leader: WorkerRun) -> float | None:
        """Give the seconds until `advance` has something to do; None waits for an order."""
        return self._rest(leader) if leader.is_presentable else None

    def advance(self, leader: WorkerRun) -> None:
        """Do the next piece of work that brings it to where B is."""
        if self._run.is_compared:
            self._direct(self._goal(leader))
        self._run.advance()

    def look_at(self, look: Look) -> None:
        """Look elsewhere."""
        self._run.look_at(look)

    def keep_frame(self, look: Look) -> Frame | None:
        """Keep the fields that are to be drawn beside those of B, and give what they are of."""
        return self._run.keep_frame(look) if self._run.is_presentable else None

    def _direct(self, goal: int | None) -> None:
        run = self._run
        if goal is None and not self._is_free:
            run.obey(Seek(run.ticket, None))
            run.obey(Pace(run.ticket, self._pace))
        elif goal is not None and self._is_short_of(goal):
            run.obey(Step(run.ticket))
        elif goal is not None and run.seeks != goal:
            run.obey(Seek(run.ticket, goal))
        self._is_free = goal is None

    def _rest(self, leader: WorkerRun) -> float | None:
        goal = self._goal(leader)
        if not self._run.is_compared or (goal is None and not self._is_free):
            return 0.0
        if goal is None:
            return self._run.rest()
        is_there = not self._is_short_of(goal) and self._run.at == min(
            goal, self.recording.iteration
        )
        return None if is_there else 0.0

    def _goal(self, leader: WorkerRun) -> int | None:
        """Give the iteration that it is to be shown at; None lets it go on."""
        if self._sought is not None:
            return self._sought
        return leader.at if leader.recording.status is None else None

    def _is_short_of(self, goal: int) -> bool:
        return self.recording.iteration < goal and not self.is_over
