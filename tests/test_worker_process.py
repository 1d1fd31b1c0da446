"""A worker computes what `solve` computes, gives way to the next run, and ends with its page."""

from __future__ import annotations

import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from direct_runs import direct
from processes import PATIENCE
from shown_pages import ALL, Shown, run_of
from worker_line import SHORT, STALLING, Line

from app.picture.recording import COLUMNS, History
from app.picture.sampler import Sampler
from app.wire.orders import Seek
from app.worker import run
from solver import latin
from solver.latin import Ending, Iterate, Record
from solver.reference.closed_forms.pulled_bar import closed_form
from solver.scenes.bar import BarSettings, bar

SLOW_TO_SET_UP = {"elements": 5000, "instants": 2001, "substructures": 500}
LONG_REFERENCE = {"elements": 300, "instants": 4000, "load": "random"}
OTHER = {**SHORT, "friction": 0.31}


def same(found: History, expected: list[Record]) -> bool:
    """Tell whether all is the same but what is measured."""
    other = History(expected)
    names = [name for name in COLUMNS if name != "seconds"]
    return all(
        np.array_equal(found.column(name), other.column(name), equal_nan=True) for name in names
    )


def shown_run(values: dict[str, Any], *, is_quick: bool = False, **options: Any) -> Shown:
    shown = Shown(is_quick=is_quick)
    shown.run(1, "bar", values, **options)
    return shown


WHOLE = {"method": "paper", "substructures": 1, "max_iterations": 40}


@pytest.mark.parametrize("values", [{}, STALLING, WHOLE])
def test_worker_gives_the_numbers_of_a_direct_solution(values: dict[str, Any]) -> None:
    shown, expected = shown_run(values), direct(values)
    assert shown.recording.status == expected.status
    assert same(shown.recording.history, expected.records)
    settings = BarSettings.checked(values)
    sampler = Sampler(expected.iterate.problem, settings, ALL)
    frame, other = shown.frame(), sampler.frame(expected.iterate, ALL)
    assert frame.iteration == other.iteration
    for name in ("friction", "status", "end_displacement"):
        assert np.array_equal(getattr(frame.fields, name), getattr(other.fields, name))


def test_the_answer_is_a_picture_of_its_own_beside_the_iterates() -> None:
    shown = shown_run({"finish": "accuracy"}, is_quick=True)
    last, end = (picture.facts for picture in shown.pictures[-2:])
    done = shown.recording.searched
    assert (last.iteration, last.is_over) == (done, False)
    assert (end.iteration, end.is_over) == (done + 1, True)
    assert f"after {done} iterations" in shown.words
    assert "answer" in shown.words
    assert shown.page["iteration"]["text"] == "answer"
    assert shown.recording.first_within(0.01) == done
    assert max(map(max, (one for one in shown.page["convergence.curves"]["xs"][:-1]))) == done
    assert list(shown.page["convergence.ring"]["x"]) == [done + 1]


def test_an_iterate_of_a_search_is_shown_again_beside_its_answer() -> None:
    shown = shown_run({**SHORT, "finish": "accuracy"})
    done = shown.recording.searched
    shown.obey(Seek(1, done))
    assert shown.page["iteration"]["text"] == f"{done} of {done}"
    assert f"showing iteration {done}" in shown.words


def test_the_first_picture_comes_before_the_reference() -> None:
    shown = shown_run(SHORT)
    first = shown.models[0]
    assert shown.pictures[0].facts.iteration == 1
    assert "reference" not in first["friction-force.title"]["text"]
    assert "reference" in shown.page["friction-force.title"]["text"]
    assert "closed form" in shown.page["friction-force.title"]["text"]
    assert not np.isnan(shown.recording.history.column("error_force")).any()


def test_a_run_that_ends_at_its_first_iteration_is_shown_with_its_end() -> None:
    shown = shown_run({"method": "paper", "peak": 0.0})
    assert len(shown.recording.history) == 1
    assert shown.pictures[-1].facts.is_over
    assert "at rest" in shown.words


def test_friction_is_shown_as_force_per_length_within_its_bound() -> None:
    values = {"elements": 3000, "instants": 31, "max_iterations": 2}
    recording = shown_run(values).recording
    stand, reference = recording.stand, recording.reference
    assert reference is not None
    assert stand.bound is not None
    assert reference.friction.shape == (400, 31) == (len(stand.positions), len(stand.instants))
    assert np.all(np.abs(reference.friction) <= stand.bound * (1.0 + 1e-6))
    assert np.abs(reference.friction).max() == pytest.approx(1500.0)
    assert stand.positions[[0, -1]] == pytest.approx([0.0, 1.0])


def test_reference_is_computed_once_for_the_same_physics() -> None:
    shown, seconds = Shown(), []
    for ticket, change in enumerate([{}, {"k_scale": 3.0, "substructures": 5}, {"friction": 0.31}]):
        shown.run(ticket, "bar", {"method": "paper", "max_iterations": 3, **change})
        assert shown.recording.reference is not None
        seconds.append(shown.recording.reference_seconds)
    assert seconds[0] == seconds[1] != seconds[2]


def test_a_run_that_diverges_keeps_its_last_good_iterate(monkeypatch: pytest.MonkeyPatch) -> None:
    class Rules(latin.StopRules):
        def judge(self, iterate: Iterate) -> latin.Verdict:
            verdict = super().judge(iterate)
            status = latin.Status(Ending.DIVERGED, "made to")
            return replace(verdict, status=status) if iterate.number == 5 else verdict

    monkeypatch.setattr(run, "StopRules", Rules)
    shown = shown_run(SHORT)
    assert shown.pictures[-1].facts.iteration == 4
    assert list(shown.recording.history.column("iteration")) == [1, 2, 3, 4]
    assert "diverged" in shown.words


def test_what_fields_stand_on_is_in_si() -> None:
    path = {"load": [[0.0, 0.0], [2.0, 700.0]], "duration": 2.0, "instants": 11}
    rod = {"length": 2.0, "young": 1e9, "elements": 20, "substructures": 4}
    values = {**path, **rod, "friction": 0.4, "friction_profile": "rising"}
    stand = shown_run(values).recording.stand
    assert stand.positions == pytest.approx(np.linspace(0.0, 2.0, 21))
    assert stand.cuts == pytest.approx([0.5, 1.0, 1.5])
    assert stand.load == pytest.approx(np.linspace(0.0, 700.0, 11))
    assert stand.all_instants == pytest.approx(np.linspace(0.0, 2.0, 11))
    assert stand.bound[:, 0] == pytest.approx(0.4 * 5000.0 * np.linspace(0.2, 1.8, 21))


def test_a_closed_form_is_shown_where_there_is_one() -> None:
    stand = shown_run(SHORT).recording.stand
    exact = closed_form(bar(BarSettings.checked(SHORT)))
    assert exact is not None
    (loop,) = stand.known("loop")
    assert loop.across == pytest.approx(exact.end_displacement, rel=1e-6)
    assert shown_run({**SHORT, "body_force": 100.0}).recording.stand.exact == ()


def test_history_grows_and_is_thinned_from_end_to_end() -> None:
    nothing = [math.nan] * 4
    history = History([Record(number, 0.1 * number, *nothing, 0.0) for number in range(1, 1001)])
    assert len(history) == 1000
    few = history.thinned(50)["iteration"]
    assert len(few) == 50
    assert (few[0], few[-1]) == (1, 1000)
    assert len(History().thinned(50)["seconds"]) == 0


@pytest.mark.parametrize("values", [SLOW_TO_SET_UP, LONG_REFERENCE], ids=["set-up", "reference"])
def test_a_run_that_takes_long_gives_way_to_the_next(line: Line, values: dict[str, Any]) -> None:
    line.send(run_of(1, "bar", SHORT))
    line.until(lambda picture: picture.facts.is_over)
    line.send(run_of(2, "bar", values, is_agreed=True), run_of(3, "bar", OTHER))
    picture = line.until(lambda picture: picture.ticket == 3 and picture.facts.is_over)
    assert not picture.facts.is_broken


@pytest.mark.parametrize("busy", [False, True])
def test_a_process_ends_with_its_pipe_whatever_it_does(line: Line, busy: bool) -> None:
    line.send(run_of(1, "bar", SHORT))
    line.until(lambda picture: picture.facts.is_over)
    if busy:
        line.send(run_of(2, "bar", SLOW_TO_SET_UP, is_agreed=True))
    line.connection.close()
    line.process.join(PATIENCE)
    assert line.process.exitcode == 0


def test_worker_loads_no_part_of_the_page() -> None:
    script = (
        "import sys, app.worker.process\n"
        "page = {'panel', 'bokeh', 'holoviews', 'tornado', 'pandas', 'app.session.session'}\n"
        "print(*sorted(page & set(sys.modules)))"
    )
    root = Path(__file__).parents[1]
    found = subprocess.run(
        [sys.executable, "-c", script], cwd=root, capture_output=True, text=True, check=True
    )
    assert found.stdout.split() == []
