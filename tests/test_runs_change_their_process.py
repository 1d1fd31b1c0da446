"""A run of any scene can be sent to another process, and goes on there as if nothing was."""

from __future__ import annotations

import pickle
from dataclasses import replace
from typing import Any

import pytest

from app.worker.orders import Run
from app.worker.reports import Progress, Report
from app.worker.rivals import References
from app.worker.run import WorkerRun

SMALL: dict[str, dict[str, Any]] = {
    "bar": {"elements": 20, "instants": 21, "substructures": 4},
    "strand": {"elements": 10, "instants": 11, "start": "zero"},
    "block": {"elements": 16, "elements_up": 6, "instants": 13},
    "layers": {"elements": 16, "layers": 2, "instants": 13},
}


def done(order: Run) -> tuple[WorkerRun, list[Report]]:
    said: list[Report] = []
    run = WorkerRun(order, said.append, lambda: False, References())
    while run.rest() is not None:
        run.advance()
    return run, said


def history(reports: list[Report]) -> list[tuple[Any, ...]]:
    """Give what is the same however long it took."""
    records = [entry for part in reports if isinstance(part, Progress) for entry in part.records]
    return [
        (entry.iteration, entry.indicator, entry.behaviour, entry.error_force) for entry in records
    ]


@pytest.mark.parametrize("stage", ["full", "pgd"])
@pytest.mark.parametrize("scene", list(SMALL))
def test_a_run_goes_on_in_another_process_to_the_bit(scene: str, stage: str) -> None:
    values = {**SMALL[scene], "linear_stage": stage, "max_iterations": 6}
    _, whole = done(Run(1, scene, values))
    first, begun = done(Run(1, scene, values, pause_after=3))
    order = pickle.loads(pickle.dumps(first.parked().order))
    second, rest = done(replace(order, pause_after=None))
    assert history(begun) + history(rest) == history(whole)
    # Parked again, now that it has gone on.
    pickle.dumps(second.parked())
