"""Results of another program, laid beside what is looked at."""

from __future__ import annotations

from app.picture.sampler import Frame
from solver.discrete.problem import Problem
from solver.settings import Settings
from solver.study.other_programs.beside import Beside
from solver.study.other_programs.brought import Brought


class Laid:
    """A table, laid beside the problem and the interface that were looked at last.

    Attributes
    ----------
    brought
        The table, if there is one.
    """

    def __init__(self) -> None:
        self.brought: Brought | None = None
        self._beside: Beside | None = None
        self._problem: Problem | None = None

    def beside(self, frame: Frame, settings: Settings) -> Beside | None:
        """Lay it beside an iterate of a run with these settings, if they are of its scene."""
        brought, problem, interface = self.brought, frame.iterate.problem, frame.fields.interface
        if brought is None or brought.scene != settings.scene:
            return None
        known = self._beside
        if (
            known is None
            or known.brought is not brought
            or self._problem is not problem
            or known.interface != interface
        ):
            known = self._beside = Beside(brought, problem, interface)
            self._problem = problem
        return known
