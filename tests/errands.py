"""Waiting for the reports that a page has asked for."""

from __future__ import annotations

from processes import wait_for

from app.session.errand import Errand


def until_idle(errand: Errand) -> None:
    def idle() -> bool:
        errand.collect()
        return not errand.is_busy

    wait_for(idle)
