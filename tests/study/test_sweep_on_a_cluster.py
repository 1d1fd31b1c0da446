"""Sweeps on a Dask cluster are as here, whatever becomes of workers and clients."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import suppress
from pathlib import Path
from threading import Thread

import numpy as np
import pytest
from processes import PATIENCE, wait_for
from sweeps import rows_in_table, rows_of, sweep_of_bars, tiny

from solver.commands.cli import main
from solver.settings.values import SettingError
from solver.study.sweep.executors import opened
from solver.study.sweep.run import sweep, versions

ROOT = Path(__file__).resolve().parents[2]


SCHEDULER = """
import asyncio, sys
from distributed import Scheduler, Worker

async def serve():
    address = {"host": "127.0.0.1", "port": 0, "dashboard": False}
    async with Scheduler(**address, scheduler_file=sys.argv[1]) as scheduler:
        async with Worker(scheduler.address, nthreads=1):
            await scheduler.finished()

asyncio.run(serve())
"""
"""A scheduler with a worker in its own process: to import them takes a while."""


class Cluster:
    """A scheduler with a worker, and further workers, as processes of this machine."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._processes: list[subprocess.Popen[bytes]] = []
        file = folder / "scheduler.json"
        self._start("-c", SCHEDULER, str(file))
        wait_for(
            lambda: file.exists() and file.read_text(encoding="utf-8").endswith("}")
        )
        self.address = json.loads(file.read_text(encoding="utf-8"))["address"]

    @property
    def on(self) -> str:
        return self.address.replace("tcp://", "dask://")

    def worker(self) -> None:
        options = ["--nthreads", "1", "--no-nanny", "--no-dashboard"]
        self._start("-m", "distributed.cli.dask_worker", self.address, *options)

    def wait_for_workers(self, number: int) -> None:
        # It takes a second, in each process that collects this test.
        from distributed import Client

        with Client(self.address, set_as_default=False) as client:
            client.wait_for_workers(number, timeout=PATIENCE)

    @property
    def workers(self) -> list[subprocess.Popen[bytes]]:
        """Workers with a process of their own."""
        return self._processes[1:]

    def _start(self, *arguments: str) -> None:
        process = subprocess.Popen(
            [sys.executable, *arguments],
            cwd=self._folder,
            env=os.environ | {"PYTHONPATH": str(ROOT)},
            stderr=subprocess.DEVNULL,
        )
        self._processes.append(process)

    def end(self) -> None:
        for process in self._processes:
            process.kill()
            process.wait()


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    """A scheduler with two workers."""
    found = Cluster(tmp_path_factory.mktemp("cluster"))
    try:
        found.worker()
        found.wait_for_workers(2)
        yield found
    finally:
        found.end()


@pytest.fixture
def executor(cluster: Cluster) -> Iterator[Executor]:
    with opened(cluster.on) as found:
        yield found


def test_workers_give_the_same_rows_as_this_process(executor: Executor) -> None:
    plan = tiny(
        ["peak=300:900:3", "friction=0.2,0.3"], ["peak_displacement", "dissipation"]
    )
    here, there = (
        [row.values for row in rows_of(plan, place)] for place in (None, executor)
    )
    assert np.array(there) == pytest.approx(np.array(here), rel=1e-9)


def test_workers_of_other_versions_are_refused(
    executor: Executor, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("solver.study.sweep.run.versions", lambda: "numpy 1.0")
    with pytest.raises(SettingError, match=versions()):
        rows_of(tiny(["peak=300,900"], ["iterations"]), executor)


def test_a_worker_that_is_killed_takes_no_row_with_it(
    cluster: Cluster, executor: Executor
) -> None:
    plan = tiny(["peak=300:900:20"], ["peak_displacement"])
    rows = []
    for row in sweep(plan, executor):
        rows.append(row)
        if len(rows) == 1:
            # none but this test needs both
            os.kill(cluster.workers[-1].pid, signal.SIGKILL)
    assert sorted(row.number for row in rows) == list(range(20))
    assert all(row.holds for row in rows)


@pytest.mark.parametrize("on", ["dask://127.0.0.1:9", "dask://nowhere", "dask://:x"])
def test_a_cluster_that_does_not_answer_is_refused_in_a_line(
    on: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("solver.study.sweep.executors.PATIENCE", 0.5)
    with pytest.raises(SettingError, match="a Dask scheduler that answers") as refusal:
        opened(on).__enter__()
    assert len(str(refusal.value).splitlines()) == 1


def test_without_distributed_a_cluster_is_refused_in_a_line(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(SettingError, match=r"pip install 'slipfront\[cluster\]'"):
        opened("dask://127.0.0.1:9").__enter__()


def test_a_scheduler_that_is_gone_is_told(
    cluster: Cluster,
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The last of all, which ends the cluster."""
    monkeypatch.setattr("solver.study.sweep.executors.PATIENCE", 1.0)
    table = tmp_path / "sweep.csv"
    asked = sweep_of_bars(400)

    def end() -> None:
        with suppress(AssertionError):
            wait_for(lambda: rows_in_table(table) > 3)
        cluster.end()

    ending = Thread(target=end)
    ending.start()
    assert main([*asked, "--on", cluster.on, "--out", str(tmp_path)]) == 1
    ending.join()
    said = capfd.readouterr()
    assert "does not answer any more; the same command goes on from here" in said.err
    assert "Traceback" not in said.err
    assert "of 400 runs" in said.out
