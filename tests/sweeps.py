"""Small sweeps, and where tests run them."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from solver.running.pool import Pool
from solver.scenes import CATALOGUE
from solver.study.sweep import Plan, Row, plan_of, sweep

TINY = {"elements": 20, "instants": 21, "substructures": 2}


class Here(Pool):
    """Does every call at once, in this process."""

    def __init__(self) -> None:
        self.calls = 0

    @property
    def width(self) -> int:
        return 1

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        self.calls += 1
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as trouble:
            future.set_exception(trouble)
        return future


def tiny(vary: list[str], of: list[str], scene: str = "bar", **changes: Any) -> Plan:
    settings = CATALOGUE[scene].settings.checked({**TINY, **changes})
    return plan_of(settings, vary, of)


def rows_of(plan: Plan, pool: Pool | None = None, **rest: Any) -> list[Row]:
    """Run a sweep; its rows by number."""
    return sorted(sweep(plan, pool or Here(), **rest), key=lambda row: row.number)
