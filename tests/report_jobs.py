"""Waiting for the reports that a page has asked for."""

from __future__ import annotations

from processes import wait_for

from app.session.report_job import ReportJob


def until_idle(job: ReportJob) -> None:
    def idle() -> bool:
        job.collect()
        return not job.is_busy

    wait_for(idle)
