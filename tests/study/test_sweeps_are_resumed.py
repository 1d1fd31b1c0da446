"""Sweeps have a row for every point, with what closed forms say of it."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import BrokenExecutor
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from pebble import ProcessExpired
from processes import is_alive, started, wait_for
from small_scenes import KINDS
from sweeps import Here, rows_in_table, rows_of, sweep_of_bars, tiny

from solver.commands import reports as report_commands
from solver.commands.cli import main
from solver.commands.console import postponed_interrupt
from solver.scenes import CATALOGUE
from solver.settings.values import SettingError
from solver.study.scene_run import finished_run
from solver.study.sweep import run as runs
from solver.study.sweep.executors import opened
from solver.study.sweep.plan import Row
from solver.study.sweep.report import growth
from solver.study.sweep.run import sweep


def test_every_point_has_one_row_whose_values_are_those_of_its_run() -> None:
    plan = tiny(
        ["peak=300:900:3", "friction=0.2,0.3"], ["peak_displacement", "iterations"]
    )
    rows = rows_of(plan)
    assert [row.number for row in rows] == list(range(6))
    assert all(row.holds and not row.reason for row in rows)
    alone = finished_run(plan.settings_at(3), errors=False, indicators=False)
    assert rows[3].values == tuple(reading(alone) for reading in plan.quantities)
    assert not any(row.was_warm for row in rows)
    assert rows[3].values[1] == rows[3].iterations


def test_processes_give_the_same_rows_as_this_one() -> None:
    plan = tiny(["peak=300:900:13"], ["peak_displacement", "dissipation"])
    with opened("processes:2") as executor:
        rows = rows_of(plan, executor)
    expected = np.array([row.values for row in rows_of(plan)])
    assert np.array([row.values for row in rows]) == pytest.approx(expected, rel=1e-9)


def test_a_run_that_fails_is_a_row_with_its_reason(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plan = tiny(["substructures=2,30"], ["iterations"])
    fits, refused = rows_of(plan)
    assert fits.holds
    assert (refused.ending, refused.holds) == ("refused", False)
    assert "substructures = 30 is refused" in refused.reason
    assert math.isnan(refused.values[0])

    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("at the third turn")

    monkeypatch.setattr(runs, "finished_run", broken)
    row = rows_of(plan)[0]
    assert (row.ending, row.reason) == (
        "broken",
        "ZeroDivisionError: at the third turn",
    )


def test_values_of_unconverged_runs_are_stored_and_marked() -> None:
    plan = tiny(
        ["max_iterations=2,1000"], ["iterations", "peak_displacement"], method="paper"
    )
    short, whole = rows_of(plan)
    assert (short.ending, short.holds, short.values[0]) == ("exhausted", False, 2)
    assert short.reason
    assert whole.holds


def test_a_run_ends_itself_when_its_time_is_up() -> None:
    plan = tiny(["peak=300,900"], ["iterations"], method="paper", accuracy=1e-9)
    for row in rows_of(plan, limit=0.0):
        assert (row.ending, row.iterations) == ("stuck", 1)
        assert "--limit" in row.reason


@pytest.mark.parametrize("scene", KINDS)
def test_runs_start_from_their_neighbours_and_come_to_the_same(scene: str) -> None:
    if "elements_up" in CATALOGUE[scene].param:
        changes = {"elements_up": 8}
    else:
        changes = {}
    # Of so few bodies that a step is soon worth a trial.
    if scene == "wall":
        changes = {"elements_up": 2, "bricks": 3, "courses": 3, "displacement": 5e-5}
    if scene == "arch":
        changes = {"voussoirs": 7, "elements": 2}
    if scene == "mesh":
        changes = {"substructures": 1, "displacement": 1.5e-5}
    plan = tiny(
        ["friction=0.4,0.45"], ["peak_displacement", "dissipation"], scene, **changes
    )
    warm = rows_of(plan)
    cold = rows_of(plan, warm=False)
    assert all(row.was_warm for row in warm[1:])
    assert not any(row.was_warm for row in cold)
    apart = np.array([row.values for row in warm]) - np.array(
        [row.values for row in cold]
    )
    assert (
        np.abs(apart) <= 1e-9 * np.abs([row.values for row in cold]).max(axis=0)
    ).all()


@pytest.mark.parametrize("of", ["iterations", "seconds", "error_force", "indicator@2"])
def test_quantities_of_the_course_of_runs_are_of_runs_started_from_zero(
    of: str,
) -> None:
    plan = tiny(["friction=0.4:0.42:6"], ["peak_displacement", of])
    assert not any(row.was_warm for row in rows_of(plan))


def test_a_process_that_is_killed_takes_one_row_with_it_and_says_so() -> None:
    with opened("processes:1") as executor:
        first = executor.submit(os.getpid).result()
        calls = [executor.submit(time.sleep, 60.0), executor.submit(os.getpid)]
        wait_for(calls[0].running)
        os.kill(first, signal.SIGKILL)
        assert calls[1].result() != first
        with pytest.raises(ProcessExpired):
            calls[0].result()


def test_after_a_process_is_killed_that_did_nothing_the_next_sweep_has_all_rows() -> (
    None
):
    plan = tiny(["peak=300:900:6"], ["stiffness"])
    with opened("processes:1") as executor:
        idle = executor.submit(os.getpid).result()
        os.kill(idle, signal.SIGKILL)
        with suppress(BrokenExecutor):
            rows_of(plan, executor)
        assert all(row.holds for row in rows_of(plan, executor))


class Ending(Here):
    """Loses the run of a point."""

    def __init__(self, point: int, trouble: Exception) -> None:
        super().__init__()
        self.point = point
        self.trouble = trouble

    def submit(self, fn, /, *args, **kwargs):  # type: ignore[no-untyped-def]
        if args[0] == self.point:
            fn = _raise
            args = (self.trouble,)
        return super().submit(fn, *args, **kwargs)


def _raise(trouble: Exception) -> None:
    raise trouble


@pytest.mark.parametrize(
    ("trouble", "ending", "words"),
    [
        (TimeoutError(), "stuck", "--limit"),
        (ProcessExpired("killed"), "lost", "killed"),
    ],
)
def test_only_the_run_whose_process_was_ended_has_no_answer(
    trouble: Exception, ending: str, words: str
) -> None:
    rows = rows_of(tiny(["peak=300:900:6"], ["iterations"]), Ending(2, trouble))
    assert [row.ending for row in rows] == ["converged"] * 2 + [ending] + [
        "converged"
    ] * 3
    assert words in rows[2].reason


def test_an_executor_that_is_broken_ends_the_sweep() -> None:
    executor = Ending(2, BrokenExecutor("it is gone"))
    rows = sweep(tiny(["peak=300:900:6"], ["iterations"]), executor)
    with pytest.raises(BrokenExecutor, match="it is gone"):
        list(rows)


def test_a_call_that_takes_too_long_is_ended_and_the_next_goes_on() -> None:
    with opened("processes:1", 1.0) as executor:
        first = executor.submit(os.getpid).result()
        with pytest.raises(TimeoutError):
            executor.submit(time.sleep, 60.0).result()
        assert executor.submit(os.getpid).result() != first
        wait_for(lambda: not is_alive(first))


def test_a_call_that_is_cancelled_is_ended_and_the_next_goes_on() -> None:
    with opened("processes:1") as executor:
        first = executor.submit(os.getpid).result()
        call = executor.submit(time.sleep, 60.0)
        wait_for(call.running)
        call.cancel()
        assert executor.submit(os.getpid).result() != first
        wait_for(lambda: not is_alive(first))


def test_an_executor_ends_with_all_that_it_does() -> None:
    with opened("processes:2") as executor:
        processes = {executor.submit(_late_pid).result() for _ in range(4)}
        for _ in range(4):
            executor.submit(time.sleep, 60.0)
    assert not any(map(is_alive, processes))
    with pytest.raises(RuntimeError, match="not active"):
        executor.submit(int)


def _late_pid() -> int:
    time.sleep(0.1)
    return os.getpid()


CALLS = """
import time
from solver.study.sweep.executors import opened

with opened("processes:2") as executor:
    calls = [executor.submit(time.sleep, 600.0) for _ in range(2)]
    while not all(call.running() for call in calls):
        time.sleep(0.01)
    print("at work", flush=True)
    time.sleep(600.0)
"""


@pytest.mark.skipif(not Path("/proc").exists(), reason="no list of processes")
def test_a_program_that_is_killed_leaves_no_process_whatever_these_do() -> None:
    options = {"start_new_session": True, "stdout": subprocess.PIPE}
    with started([sys.executable, "-c", CALLS], **options) as program:
        assert program.stdout is not None
        assert program.stdout.readline() == b"at work\n"
        assert len(in_session(program.pid)) > 2
        program.kill()
        wait_for(lambda: not in_session(program.pid))


def test_a_sweep_that_is_killed_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = sweep_of_bars(24)
    asked += ["--on", "processes:1", "--out", str(tmp_path)]
    table = tmp_path / "sweep.csv"
    with started([sys.executable, "-m", "solver", *asked]):
        wait_for(lambda: rows_in_table(table) > 3)
    rows = table.read_text(encoding="utf-8").splitlines()
    monkeypatch.setattr(report_commands, "write_sweep", lambda *given: None)
    assert main(asked) == 0
    assert rows_in_table(table) == 24
    assert {*rows[:-1]} <= {*table.read_text(encoding="utf-8").splitlines()}


def in_session(leader: int) -> list[int]:
    """Processes of a session that have not ended, whatever their parents are."""
    found = []
    for process in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            state, _, _, session = (
                process.read_text("utf-8").rpartition(")")[2].split()[:4]
            )
            if int(session) == leader and state not in "ZX":
                found.append(int(process.parent.name))
    return found


@pytest.mark.parametrize(
    "on",
    [
        "",
        "process",
        "processes:0",
        "processes:x",
        "processes:2:2",
        "processes:1000",
        "dask",
    ],
)
def test_a_foolish_executor_is_refused_in_a_line(on: str) -> None:
    with pytest.raises(
        SettingError, match=r"processes:COUNT, or dask://HOST:PORT"
    ) as refusal:
        opened(on).__enter__()
    assert "\n" not in str(refusal.value)


def test_growth_is_told_of_a_setting_over_decades_for_every_name() -> None:
    plan = tiny(["elements=10:40:3:log", "method=fast,paper"], ["iterations"])
    rows = [
        Row(n, "converged", "", (float(plan.point(n)["elements"] ** (1 + n % 2)),))
        for n in range(6)
    ]
    assert growth(plan, rows) == [
        "iterations, method=fast: elements^1.00, of 3 runs",
        "iterations, method=paper: elements^2.00, of 3 runs",
    ]
    assert growth(tiny(["elements=10,20,40"], ["iterations"]), rows[:3]) == []


def test_an_interrupt_from_a_terminal_ends_a_sweep_in_a_line(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    command = [sys.executable, "-m", "solver", "sweep", "bar", "--out", str(folder)]
    command += ["--vary", "friction=0.1:0.6:400", "--of", "dissipation"]
    command += ["--on", "processes:1"]
    options = {"stderr": subprocess.PIPE, "stdout": subprocess.DEVNULL}
    with started(command, start_new_session=True, **options) as process:
        wait_for(lambda: rows_in_table(folder / "sweep.csv") > 5)
        # A terminal sends it to all processes of the command.
        os.killpg(process.pid, signal.SIGINT)
        _, said = process.communicate()
        wait_for(lambda: not in_session(process.pid))
    assert process.returncode == 130
    *progress, last = said.decode().splitlines()
    assert last == "slipfront: stopped; the same command goes on from here"
    assert all(line.endswith(" s left") for line in progress)


SLOW_START = """
import sys, time
from multiprocessing.util import Finalize
from pathlib import Path

from solver.study.sweep.executors import opened

HERE = Path(sys.argv[1])


def wait_for(name, seconds):
    end = time.monotonic() + seconds
    while not (HERE / name).exists() and time.monotonic() < end:
        time.sleep(0.01)


def hold():
    (HERE / "first is told to end").touch()
    # The second has begun, or a complaint has been printed; a pool waits for 3 s.
    wait_for("second has begun", 2.0)


def work():
    Finalize(None, hold, exitpriority=10)
    (HERE / "first works").touch()
    time.sleep(600.0)


if __name__ == "__mp_main__":
    # Each process imports this file before it looks for the pool's locks.
    try:
        (HERE / "first").mkdir()
    except FileExistsError:
        wait_for("first is told to end", 60.0)
elif __name__ == "__main__":
    with opened("processes:2") as executor:
        executor.submit(work)
        wait_for("first works", 60.0)
"""
"""Program that ends its executor while one of two processes is still starting."""


def test_an_executor_ends_in_silence_while_a_process_starts(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text(SLOW_START, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, str(program), str(tmp_path)], capture_output=True, check=False
    )
    assert (tmp_path / "first is told to end").exists()
    assert (done.returncode, done.stderr) == (0, b"")


INTERRUPTED_EXIT = """
import atexit, os, runpy, signal, sys

atexit.register(os.kill, os.getpid(), signal.SIGINT)
sys.argv = ["solver", "scenes"]
runpy.run_module("solver", run_name="__main__")
"""


def test_an_interrupt_of_an_exit_ends_in_silence() -> None:
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED_EXIT], capture_output=True, check=False
    )
    assert (done.returncode, done.stderr) == (-signal.SIGINT, b"")


def press() -> None:
    os.kill(os.getpid(), signal.SIGINT)


def test_interrupts_wait_for_the_end_of_the_body_and_are_one() -> None:
    steps = []

    def body() -> None:
        with postponed_interrupt() as is_interrupted:
            steps.append(is_interrupted())
            press()
            press()
            steps.append(is_interrupted())

    # A server that was started in this process may have left a handler of its own.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            body()
        assert steps == [False, True]
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)


def test_an_interrupt_that_is_ignored_stays_so() -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with postponed_interrupt() as is_interrupted:
            press()
            assert not is_interrupted()
    finally:
        signal.signal(signal.SIGINT, before)


INTERRUPTED_IMPORT = """
import os, runpy, signal, sys

class Interrupts:
    def find_spec(self, name, path, target=None):
        if name == "scipy.linalg":
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Interrupts())
runpy.run_module("solver", run_name="__main__")
"""


def test_an_interrupt_while_libraries_are_imported_ends_in_silence() -> None:
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED_IMPORT], capture_output=True
    )
    assert (done.returncode, done.stderr) == (-signal.SIGINT, b"")
