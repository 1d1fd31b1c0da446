"""The reports and the sweep that one page has asked for."""

from __future__ import annotations

from collections.abc import Callable

from app.session.inquiry import Inquiry
from app.session.report_executor import ReportExecutor
from app.session.report_job import ReportJob


class Asked:
    """What goes on beside the run.

    Parameters
    ----------
    executor
        Where reports are made.
    began
        Is told that there is something to look at.

    Attributes
    ----------
    figures, study, stability, proof, mesh, inquiry
        Four reports, a quantity on three meshes, and a sweep.
    """

    def __init__(self, executor: ReportExecutor, began: Callable[[], None]) -> None:
        self.figures, self.study, self.stability, self.proof, self.mesh = (
            ReportJob(executor, began) for _ in range(5)
        )
        self.inquiry = Inquiry(began=began)
        reports = self.figures, self.study, self.stability, self.proof
        self._all = *reports, self.mesh, self.inquiry

    @property
    def is_busy(self) -> bool:
        """Whether any of it is at work."""
        return any(one.is_busy for one in self._all)

    def collect(self) -> bool:
        """See what all has come to; tell if any of that is new."""
        news = [one.collect() for one in self._all]
        return any(news)

    def cancel(self) -> None:
        """End all of it."""
        for one in self._all:
            one.cancel()
