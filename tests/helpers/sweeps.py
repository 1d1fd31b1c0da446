"""Small sweeps, and where tests run them."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

from solver.scenes import CATALOGUE
from solver.study.sweep.plan import Plan, Row, plan_of
from solver.study.sweep.run import sweep

TINY = {"elements": 20, "instants": 21, "substructures": 2}
"""Settings of a bar that runs in no time."""


def sweep_of_bars(peaks: int) -> list[str]:
    """Arguments of the command that runs tiny bars over a number of peak loads."""
    arguments = ["sweep", "bar", "--vary", f"peak=300:900:{peaks}"]
    arguments += ["--of", "iterations"]
    for name, value in TINY.items():
        arguments += ["--set", f"{name}={value}"]
    return arguments


class Here(ThreadPoolExecutor):
    """Does one call after the other in this process, and counts them."""

    def __init__(self) -> None:
        super().__init__(1)
        self.calls = 0

    def submit(
        self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any
    ) -> Future[Any]:
        self.calls += 1
        return super().submit(fn, *args, **kwargs)


def tiny(vary: list[str], of: list[str], scene: str = "bar", **changes: Any) -> Plan:
    kind = CATALOGUE[scene]
    # A mesh of a file has no number of elements.
    sizes = {name: TINY[name] for name in TINY if name in kind.definitions()}
    settings = kind.checked(sizes | changes)
    return plan_of(settings, vary, of)


def rows_of(plan: Plan, executor: Executor | None = None, **rest: Any) -> list[Row]:
    """Run a sweep; its rows by number."""
    return sorted(sweep(plan, executor or Here(), **rest), key=lambda row: row.number)


def rows_in_table(file: Path) -> int:
    """Rows that a sweep has written so far."""
    if file.exists():
        lines = file.read_text(encoding="utf-8").splitlines()
    else:
        lines = []
    return max(0, sum(not line.startswith("#") for line in lines) - 1)
