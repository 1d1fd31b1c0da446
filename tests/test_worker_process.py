"""A worker computes what `solve` computes, and says what a page needs to know."""

from __future__ import annotations

import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from direct_runs import direct, timeless
from worker_line import SHORT, STALLING, Line, is_same_picture, shown

from app.worker.orders import Run
from app.worker.reports import Begun, End, Frame, Progress, Reference, Refused, Taken, Waiting
from app.worker.rivals import References
from app.worker.run import WorkerRun
from solver.latin import Ending, Iterate, StopRules, Verdict


@pytest.mark.parametrize("values", [{}, STALLING, {"substructures": 1}])
def test_worker_gives_the_numbers_of_a_direct_solution(line: Line, values: dict[str, Any]) -> None:
    line.send(Run(1, "bar", values))
    end = line.until(End, Refused)
    line.until(Waiting)
    expected = direct(values)
    assert end == End(1, expected.status, expected.iterate.number)
    assert timeless(line.records()) == timeless(expected.records)
    assert is_same_picture(line.all(Frame)[-1], shown(expected.iterate))


def test_first_picture_comes_before_the_reference_and_every_record_after_it(line: Line) -> None:
    line.send(Run(1, "bar", SHORT))
    line.until(End)
    kinds = [type(report) for report in line.reports]
    assert kinds[:6] == [Taken, Begun, Frame, Begun, Reference, Progress]
    assert [begun.closed_form is not None for begun in line.all(Begun)] == [False, True]
    assert line.all(Frame)[0].iteration == 1
    assert [record.iteration for record in line.records()] == list(range(1, 51))
    assert not any(math.isnan(record.error_force) for record in line.records())


def test_run_that_ends_at_its_first_iteration_sends_its_record_and_its_end(line: Line) -> None:
    line.send(Run(1, "bar", {"method": "paper", "peak": 0.0}))
    line.until(Waiting)
    assert [record.iteration for record in line.records()] == [1]
    assert [frame.iteration for frame in line.all(Frame)] == [1]
    assert line.all(End)[0].iteration == 1


def test_friction_is_sent_as_force_per_length_within_its_bound(line: Line) -> None:
    line.send(Run(1, "bar", {"elements": 3000, "instants": 31, "max_iterations": 2}))
    line.until(End)
    begun, reference = line.all(Begun)[0], line.all(Reference)[0]
    assert reference.friction.shape == (400, 31) == (len(begun.positions), len(begun.instants))
    assert np.all(np.abs(reference.friction) <= begun.bound[:, None] * (1.0 + 1e-6))
    assert np.abs(reference.friction).max() == pytest.approx(1500.0)
    assert begun.positions[[0, -1]] == pytest.approx([0.0, 1.0])


def test_reference_is_computed_once_for_the_same_physics(line: Line) -> None:
    line.send(Run(1, "bar", {"k_scale": 1.0}))
    line.until(End)
    line.send(Run(2, "bar", {"k_scale": 3.0, "substructures": 5}))
    line.until(End, ticket=2)
    line.send(Run(3, "bar", {"friction": 0.31}))
    line.until(End, ticket=3)
    first, second, third = (line.all(Reference, ticket)[0].seconds for ticket in (1, 2, 3))
    assert first == second != third


def test_run_that_diverges_keeps_its_last_good_iterate(monkeypatch: pytest.MonkeyPatch) -> None:
    def judge(rules: StopRules, iterate: Iterate) -> Verdict:
        nowhere = np.full_like(iterate.incoming, np.nan)
        return plain(rules, replace(iterate, incoming=nowhere) if iterate.number == 5 else iterate)

    plain = StopRules.judge
    monkeypatch.setattr(StopRules, "judge", judge)
    said: list[Any] = []
    work = WorkerRun(Run(1, "bar", SHORT), said.append, lambda: False, References())
    while work.rest() is not None:
        work.advance()
    (end,) = (report for report in said if isinstance(report, End))
    frames = [report for report in said if isinstance(report, Frame)]
    records = [entry for part in said if isinstance(part, Progress) for entry in part.records]
    assert (end.status.ending, end.iteration) == (Ending.DIVERGED, 4)
    assert frames[-1].iteration == 4
    assert [entry.iteration for entry in records] == [1, 2, 3, 4]


def test_begun_gives_bound_load_and_cuts_in_si(line: Line) -> None:
    path = {"load": [[0.0, 0.0], [2.0, 700.0]], "duration": 2.0, "instants": 11}
    rod = {"length": 2.0, "young": 1e9, "elements": 20, "substructures": 4}
    line.send(Run(1, "bar", {**path, **rod, "friction": 0.4, "friction_profile": "rising"}))
    line.until(End)
    begun = line.all(Begun)[0]
    assert begun.positions == pytest.approx(np.linspace(0.0, 2.0, 21))
    assert begun.cuts == pytest.approx([0.5, 1.0, 1.5])
    assert begun.load == pytest.approx(np.linspace(0.0, 700.0, 11))
    assert begun.all_instants == pytest.approx(np.linspace(0.0, 2.0, 11))
    factor = np.linspace(0.2, 1.8, 21)
    assert begun.bound == pytest.approx(0.4 * 5000.0 * factor)


def test_run_without_a_closed_form_sends_none(line: Line) -> None:
    line.send(Run(1, "bar", {**SHORT, "body_force": 100.0}))
    line.until(Reference)
    assert [begun.closed_form for begun in line.all(Begun)] == [None, None]


def test_worker_loads_no_part_of_the_page() -> None:
    script = (
        "import sys, app.worker.process\n"
        "page = {'panel', 'bokeh', 'holoviews', 'tornado', 'pandas', 'app.session'}\n"
        "print(*sorted(page & set(sys.modules)))"
    )
    root = Path(__file__).parents[1]
    found = subprocess.run(
        [sys.executable, "-c", script], cwd=root, capture_output=True, text=True, check=True
    )
    assert found.stdout.split() == []
