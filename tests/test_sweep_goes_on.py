"""A sweep has a row for every point, whatever becomes of a run or of its process."""

from __future__ import annotations

import math
import os
import signal
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from multiprocessing import Pipe
from pathlib import Path

import numpy as np
import pytest
from processes import PATIENCE, is_alive, wait_for
from sweeps import Here, rows_of, tiny

from solver.definitions import SettingError
from solver.latin.status_step import states_of
from solver.latin.step_cost import Costs
from solver.laws import OPEN
from solver.reference.choice import incremental_solver, reference_of
from solver.running import calls
from solver.running.executors import Processes, opened
from solver.running.pool import EndedError, OverdueError
from solver.running.processes import start_process
from solver.scenes import CATALOGUE, discretise
from solver.study.quantities.finished import finished_run
from solver.study.sweep import VersionsDifferError, sweep
from solver.study.sweep import point as points
from solver.study.sweep.nearest import KEPT, Nearest
from solver.study.sweep.point import field_file


def test_every_point_has_one_row_whose_values_are_those_of_its_run() -> None:
    plan = tiny(["peak=300:900:3", "friction=0.2,0.3"], ["peak_displacement", "iterations"])
    rows = rows_of(plan)
    assert [row.number for row in rows] == list(range(6))
    assert all(row.holds and not row.reason for row in rows)
    alone = points.run_point(plan, 3)
    assert rows[3].values == alone.values
    assert not any(row.was_warm for row in rows)
    assert rows[3].values[1] == rows[3].iterations


def test_processes_give_the_same_rows_as_this_one() -> None:
    plan = tiny(["peak=300:900:13"], ["peak_displacement", "dissipation"])
    with opened("processes:2") as pool:
        rows = rows_of(plan, pool)
    expected = np.array([row.values for row in rows_of(plan)])
    assert np.array([row.values for row in rows]) == pytest.approx(expected, rel=1e-9)


def test_points_that_are_done_are_left_out() -> None:
    plan = tiny(["peak=300:900:5"], ["iterations"])
    assert [row.number for row in rows_of(plan, done={0, 2, 4})] == [1, 3]
    pool = Here()
    assert rows_of(plan, pool, done=range(5)) == []
    assert pool.calls == 0


def test_a_run_that_fails_is_a_row_with_its_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    plan = tiny(["substructures=2,30"], ["iterations"])
    fits, refused = rows_of(plan)
    assert fits.holds
    assert (refused.ending, refused.holds) == ("refused", False)
    assert "substructures = 30 is refused" in refused.reason
    assert math.isnan(refused.values[0])

    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("at the third turn")

    monkeypatch.setattr(points, "finished_run", broken)
    row = rows_of(plan)[0]
    assert (row.ending, row.reason) == ("broken", "ZeroDivisionError: at the third turn")


def test_what_a_run_had_come_to_is_kept_and_marked() -> None:
    plan = tiny(["max_iterations=2,1000"], ["iterations", "peak_displacement"], method="paper")
    short, whole = rows_of(plan)
    assert (short.ending, short.holds, short.values[0]) == ("exhausted", False, 2)
    assert short.reason
    assert whole.holds


def test_a_run_ends_itself_when_its_time_is_up() -> None:
    plan = tiny(["peak=300,900"], ["iterations"], method="paper", accuracy=1e-9)
    for row in rows_of(plan, limit=0.0):
        assert (row.ending, row.iterations) == ("stuck", 1)
        assert "--limit" in row.reason


@pytest.mark.parametrize("scene", CATALOGUE)
def test_runs_start_from_their_neighbours_and_come_to_the_same(scene: str) -> None:
    changes = {"elements_up": 8} if "elements_up" in CATALOGUE[scene].settings.param else {}
    plan = tiny(["friction=0.4:0.5:6"], ["peak_displacement", "dissipation"], scene, **changes)
    warm, cold = rows_of(plan), rows_of(plan, warm=False)
    assert all(row.was_warm for row in warm[1:])
    assert not any(row.was_warm for row in cold)
    apart = np.array([row.values for row in warm]) - np.array([row.values for row in cold])
    assert (np.abs(apart) <= 1e-9 * np.abs([row.values for row in cold]).max(axis=0)).all()


@pytest.mark.parametrize("of", ["iterations", "seconds", "error_force", "indicator@2"])
def test_what_tells_how_a_run_went_is_taken_of_runs_with_a_start_of_their_own(of: str) -> None:
    plan = tiny(["friction=0.4:0.42:6"], ["peak_displacement", of])
    assert not any(row.was_warm for row in rows_of(plan))


def test_a_run_that_fits_no_other_starts_alone() -> None:
    for vary in ("elements=12,24", "instants=11,21"):
        assert not any(row.was_warm for row in rows_of(tiny([vary], ["peak_displacement"])))


def test_a_step_that_costs_more_than_a_run_is_not_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    plan = tiny(["friction=0.45:0.47:3"], ["peak_displacement"])
    dear = Costs(condensing=1e3, system=1e-3, iteration=1e-3, n_instants=21)
    monkeypatch.setattr("solver.study.quantities.finished.costs_of", lambda problem, moving: dear)
    assert not any(row.was_warm for row in rows_of(plan))


def test_the_nearest_run_is_the_start_and_the_oldest_are_forgotten() -> None:
    nearest = Nearest((3, 4000))
    assert nearest.to(5) is None
    states = {number: np.full((1, 1), number % 100, np.int8) for number in (0, 3999, 4001, 8100)}
    for number, one in states.items():
        nearest.keep(number, one)
    # one of 3 lines away is farther than 100 of 4000 places
    assert nearest.to(10) is states[0]
    assert nearest.to(8001) is states[8100]
    for number in range(KEPT):
        nearest.keep(4002 + number, states[0])
    assert nearest.to(8100) is states[0]


@pytest.mark.parametrize("scene", ["bar", "block"])
def test_a_foolish_start_costs_little_and_changes_nothing(scene: str) -> None:
    settings = tiny(["friction=0.4,0.5"], ["dissipation"], scene).settings
    problem = discretise(settings)
    right = reference_of(problem)
    states = states_of(finished_run(settings).iterate)
    foolish = np.where(states == OPEN, OPEN, 1).astype(np.int8)
    for guess in (states, -foolish, foolish):
        found = incremental_solver(problem).march(guess=guess)
        assert found.contact_force == pytest.approx(
            right.contact_force, abs=1e-9 * np.abs(right.contact_force).max()
        )
        assert found.steps <= right.steps + 3 * problem.n_instants


def test_fields_are_kept_where_they_are_asked_for(tmp_path: Path) -> None:
    plan = tiny(["peak=300,900"], ["peak_displacement"])
    rows = rows_of(plan, fields=str(tmp_path))
    for row in rows:
        with np.load(tmp_path / field_file(row.number)) as found:
            assert np.abs(found["displacement"]).max() == row.values[0]


def test_a_process_that_is_killed_takes_no_row_with_it() -> None:
    plan = tiny(["peak=300:900:60"], ["peak_displacement"])
    with opened("processes:2") as pool:
        killed, rows = set(), []
        for row in sweep(plan, pool):
            rows.append(row)
            if len(killed) < 2:
                pid = pool.submit(os.getpid).result()
                os.kill(pid, signal.SIGKILL)
                wait_for(lambda pid=pid: not is_alive(pid))
                killed.add(pid)
    assert sorted(row.number for row in rows) == list(range(60))
    assert all(row.holds for row in rows)
    assert len(killed) == 2


def test_a_call_that_takes_too_long_is_ended_and_the_next_goes_on() -> None:
    with opened("processes:1", 1.0) as pool:
        first = pool.submit(os.getpid).result()
        with pytest.raises(OverdueError, match="longer than 1 s"):
            pool.submit(time.sleep, 60.0).result()
        second = pool.submit(os.getpid).result()
        assert first != second
        assert not is_alive(first)


class Ending(Here):
    """Loses every piece that holds a point."""

    def __init__(self, point: int, trouble: Exception, times: int = 1000) -> None:
        super().__init__()
        self.point, self.trouble, self.times = point, trouble, times

    def submit(self, fn, /, *args, **kwargs):  # type: ignore[no-untyped-def]
        if self.point in args[0].numbers and self.times:
            self.times -= 1
            fn, args = _raise, (self.trouble,)
        return super().submit(fn, *args, **kwargs)


def _raise(trouble: Exception) -> None:
    raise trouble


@pytest.mark.parametrize(
    ("trouble", "ending"), [(OverdueError("late"), "stuck"), (EndedError("gone"), "lost")]
)
def test_only_the_point_that_ends_its_process_is_given_up(trouble: Exception, ending: str) -> None:
    rows = rows_of(tiny(["peak=300:900:6"], ["iterations"]), Ending(2, trouble))
    assert [row.ending for row in rows] == ["converged"] * 2 + [ending] + ["converged"] * 3
    assert str(trouble) in rows[2].reason


def test_a_point_is_not_given_up_for_one_lost_process() -> None:
    rows = rows_of(tiny(["peak=300:900:6"], ["iterations"]), Ending(2, EndedError("gone"), 2))
    assert [row.number for row in rows if row.holds] == list(range(6))


def test_closing_a_sweep_ends_what_runs() -> None:
    plan = tiny(["peak=300:900:9"], ["iterations"])
    with opened("processes:1") as pool:
        assert isinstance(pool, Processes)
        running = sweep(plan, pool)
        next(running)
        running.close()
        assert pool.submit(int, 3).result() == 3
        sleeping = pool.submit(time.sleep, 60.0)
        wait_for(sleeping.running)
        assert not sleeping.cancel()
        with pytest.raises(EndedError):
            sleeping.result()
        pid = pool.submit(os.getpid).result()
    wait_for(lambda: not is_alive(pid))


def test_an_executor_ends_with_all_that_it_does() -> None:
    with opened("processes:2") as pool:
        calls = [pool.submit(time.sleep, 60.0) for _ in range(4)]
        wait_for(lambda: sum(call.running() for call in calls) == 2)
    assert all(call.done() for call in calls)
    with pytest.raises(RuntimeError, match="shut down"):
        pool.submit(int)


def test_an_error_of_a_call_is_told() -> None:
    with opened("processes:1") as pool:
        with pytest.raises(ZeroDivisionError):
            pool.submit(divmod, 1, 0).result()
        assert pool.submit(divmod, 7, 2).result() == (3, 1)


def test_a_call_whose_process_has_gone_keeps_nothing_of_what_was_sent(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    process, _ = start_process(calls.obey, preloaded=["solver.running.calls"])
    ours, theirs = Pipe()
    theirs.close()
    monkeypatch.setattr(calls, "start_process", lambda *_, **__: (process, ours))
    call = calls.Call(partial(int))
    with pytest.raises(EndedError) as ended:
        calls.ProcessSlot(None).do(call)
    assert ended.value.__context__ is None


def test_a_call_that_runs_nowhere_any_more_has_left_no_process(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ended: list[int | None] = []
    clear = calls.ProcessSlot.clear

    def watched(slot: calls.ProcessSlot) -> None:
        if slot._process is not None:
            ended.append(call.pid)
        clear(slot)

    monkeypatch.setattr(calls.ProcessSlot, "clear", watched)
    call = calls.Call(partial(time.sleep, 600.0))
    slot = calls.ProcessSlot(None)
    with ThreadPoolExecutor(1) as thread:
        done = thread.submit(slot.do, call)
        wait_for(lambda: call.pid is not None)
        pid = call.pid
        assert call.set_running_or_notify_cancel()
        assert not call.cancel()
        with pytest.raises(EndedError):
            done.result(timeout=PATIENCE)
    assert ended == [pid]
    assert call.pid is None


def test_other_versions_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    plan = tiny(["peak=300,900"], ["iterations"])
    with opened("processes:1") as pool:
        monkeypatch.setattr("solver.study.sweep.drive.versions", lambda: "numpy 1.0")
        with pytest.raises(VersionsDifferError, match=r"here are numpy 1\.0"):
            rows_of(plan, pool)


@pytest.mark.parametrize(
    "on",
    [
        "",
        "process",
        "processes:",
        "processes:0",
        "processes:-1",
        "processes:x",
        "threads",
        "processes:2:2",
        "processes:1000",
        "dask",
        "processes: 2",
    ],
)
def test_a_foolish_executor_is_refused_in_a_line(on: str) -> None:
    with pytest.raises(SettingError, match=r"processes:COUNT, or dask://HOST:PORT") as refusal:
        opened(on).__enter__()
    assert "\n" not in str(refusal.value)
