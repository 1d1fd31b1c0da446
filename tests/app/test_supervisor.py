"""A worker that is stuck is replaced, and none that only waits for its page to load."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from processes import PATIENCE

import app.supervisor
from app.messages import Began, Order, Start
from app.state import PageState, default_settings
from app.supervisor import Supervisor


class Document:
    """A document whose time goes on when it is told."""

    def add_periodic_callback(
        self, callback: Callable[[], Any], milliseconds: int
    ) -> None:
        assert milliseconds > 0
        self.look = callback

    def add_next_tick_callback(self, callback: Callable[[], Any]) -> None:
        callback()


class Process:
    """A worker that reports what it is made to."""

    hangs = False

    def __init__(self, hear: Callable[[Any, Any], None]) -> None:
        self.hear = hear
        self.orders: list[Order] = []

    def send(self, order: Order) -> None:
        self.orders.append(order)

    def end(self) -> None:
        self.orders.clear()


def test_a_worker_is_stuck_only_once_its_page_has_loaded(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made: list[Process] = []

    def worker(hear: Callable[[Any, Any], None], others: int) -> Process:
        made.append(Process(hear))
        return made[-1]

    monkeypatch.setattr(app.supervisor, "Worker", worker)
    monkeypatch.setattr(app.supervisor, "STUCK", -1.0)
    document = Document()
    state = PageState(default_settings("bar"))
    supervisor = Supervisor(state, document)
    supervisor.begin()
    state.run()
    document.look()
    assert len(made) == 1
    made[0].hear(made[0], Began(state.number))
    assert state.began != state.number
    supervisor.open()
    assert state.began == state.number
    document.look()
    assert len(made) == 1
    state.run()
    document.look()
    assert len(made) == 2
    assert any(isinstance(order, Start) for order in made[1].orders)


PRESSES = """
import os, signal

# As a terminal does, to all processes of the session.
os.killpg(0, signal.SIGINT)
"""
"""Module that presses Ctrl-C while a fork server imports it."""

STARTS_A_WORKER = """
import signal, threading
from app.worker.process import PROCESSES, Worker

signal.signal(signal.SIGINT, lambda *_: print("pressed", flush=True))
PROCESSES.set_forkserver_preload(["presses"])
reports = threading.Event()
worker = Worker(lambda worker, report: reports.set())
reports.wait(60.0)
worker.end()
"""


def test_an_interrupt_while_workers_are_prepared_is_for_the_server_alone(
    tmp_path: Path,
) -> None:
    (tmp_path / "presses.py").write_text(PRESSES, encoding="utf-8")
    root = Path(__file__).resolve().parents[2]
    done = subprocess.run(
        [sys.executable, "-c", STARTS_A_WORKER],
        cwd=root,
        env=dict(os.environ, PYTHONPATH=str(tmp_path)),
        start_new_session=True,
        capture_output=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, b"pressed\n", b"")


MANY_AND_A_STOPPED_ONE = """
import multiprocessing, os, signal, threading
from app.messages import Start
from app.state import default_settings
from app.worker.process import Worker, niceness

first, *more = workers = [Worker(lambda worker, report: None, n) for n in range(3)]
pids = [process.pid for process in multiprocessing.active_children()]
print([niceness(pid) - niceness() for pid in pids])
first.end()
late = Worker(lambda worker, report: None, 2)
workers = [*more, late, Worker(lambda worker, report: None, 40)]
pids = [process.pid for process in multiprocessing.active_children()]
print([niceness(pid) for pid in pids])
for worker in workers:
    worker.end()

reports = threading.Event()
worker = Worker(lambda worker, report: reports.set())
reports.wait(60.0)
(process,) = multiprocessing.active_children()
os.kill(process.pid, signal.SIGSTOP)
settings = default_settings("wall")
for number in range(200):
    worker.send(Start(number, settings, 0.0))
worker.end()
for thread in set(threading.enumerate()) - {threading.current_thread()}:
    thread.join(60.0)
print(multiprocessing.active_children(), threading.active_count())
"""


@pytest.fixture(scope="module")
def lines() -> list[str]:
    """Lines that a program with workers prints."""
    done = subprocess.run(
        [sys.executable, "-c", MANY_AND_A_STOPPED_ONE],
        cwd=Path(__file__).resolve().parents[2],
        capture_output=True,
        check=False,
        text=True,
        timeout=PATIENCE,
    )
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout.splitlines()


def test_all_workers_give_the_same_way_to_a_server_of_many_pages(
    lines: list[str],
) -> None:
    assert lines[:2] == ["[7, 7, 7]", "[19, 19, 19, 19]"]


def test_a_worker_that_takes_no_orders_keeps_nobody_waiting_and_leaves_nothing(
    lines: list[str],
) -> None:
    assert lines[2:] == ["[] 1"]
