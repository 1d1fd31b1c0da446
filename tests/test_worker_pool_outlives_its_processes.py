"""A process that dies or freezes is replaced, and none is left when the pool or its server ends."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from direct_runs import direct, timeless
from pool_sessions import ENDLESS, SHORT, SOON, Session
from processes import PATIENCE, is_alive, wait_for

from app.worker.orders import Run, Step, Watch
from app.worker.pool import Pool
from app.worker.reports import Died, End, Frame, Progress


def test_killed_worker_is_replaced_and_the_run_starts_again(session: Session) -> None:
    session.seat.run(Run(1, "bar", SHORT, pace=200.0))
    session.until(Progress)
    time.sleep(0.1)
    os.kill(session.pid, signal.SIGKILL)
    died = session.until(Died)
    session.until(End)
    assert died.again
    assert "started again" in died.reason
    assert session.records() == timeless(direct(SHORT).records)


def test_run_whose_workers_keep_dying_is_given_up(session: Session) -> None:
    session.seat.run(Run(1, "bar", ENDLESS, pace=10.0))
    fates = []
    for _ in range(3):
        session.until(Progress)
        os.kill(session.pid, signal.SIGKILL)
        fates.append(session.until(Died).again)
    assert fates == [True, True, False]
    session.seat.run(Run(2, "bar", SHORT))
    session.until(End, ticket=2)


def test_paused_run_is_still_paused_after_its_worker_died(session: Session) -> None:
    session.seat.run(Run(1, "bar", SHORT, pause_after=3))
    wait_for(lambda: session.seat.post is not None and session.seat.post.idle)
    session.seat.send(Step(1))
    while len(session.records()) < 4:
        session.until(Progress)
    os.kill(session.pid, signal.SIGKILL)
    session.until(Died)
    while len(session.records()) < 4:
        session.until(Progress)
    wait_for(lambda: session.seat.post is not None and session.seat.post.idle)
    assert [record.iteration for record in session.records()] == [1, 2, 3, 4]


def test_frozen_worker_is_replaced_when_a_new_run_is_ordered(session: Session) -> None:
    session.seat.run(Run(1, "bar", ENDLESS, pace=10.0))
    session.until(Progress)
    frozen = session.pid
    os.kill(frozen, signal.SIGSTOP)
    session.seat.run(Run(2, "bar", SHORT))
    session.seat.send(Watch(2, frozenset({"spectra"})))
    session.until(Frame, ticket=2, patience=SOON)
    session.until(End, ticket=2)
    assert not is_alive(frozen)
    assert not any(isinstance(report, Died) for report in session.reports)
    frames = [report for report in session.reports if isinstance(report, Frame)]
    assert frames[-1].spectra is not None


@pytest.mark.parametrize("frozen", [False, True])
def test_closed_pool_leaves_no_process(frozen: bool) -> None:
    pool = Pool(2)
    sessions = [Session(pool) for _ in range(4)]
    for each in sessions:
        each.seat.run(Run(1, "bar", ENDLESS, pace=10.0))
    sessions[0].until(Progress)
    sessions[3].seat.close()
    pids = pool.pids
    if frozen:
        os.kill(sessions[0].pid, signal.SIGSTOP)
    pool.close()
    pool.close()
    sessions[1].seat.run(Run(2, "bar", SHORT))
    sessions[1].seat.close()
    assert len(pids) >= 2
    assert not any(is_alive(pid) for pid in pids)
    assert not multiprocessing.active_children()
    assert not pool.pids


SERVER = """
import sys, time
from app.worker.pool import shared_pool
from app.worker.orders import Run
from app.worker.reports import Frame

pool, seen = shared_pool(), set()
for number in range(2):
    seat = pool.seat(lambda report, number=number: seen.add(number))
    seat.run(Run(1, "bar", {"tolerance": 1e-30, "instants": 401}, pace=[2.0, None][number]))
while len(seen) < 2:
    time.sleep(0.01)
print(*pool.pids, flush=True)
sys.stdin.readline()
"""


@pytest.mark.parametrize("killed", [False, True])
def test_workers_end_with_their_server(killed: bool) -> None:
    root = Path(__file__).parents[1]
    server = subprocess.Popen(
        [sys.executable, "-c", SERVER],
        cwd=root,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    with server:
        assert server.stdout is not None
        pids = [int(word) for word in server.stdout.readline().split()]
        assert len(pids) >= 2
        assert all(map(is_alive, pids))
        if killed:
            server.kill()
        _, noise = server.communicate(timeout=PATIENCE)
    assert not noise
    assert server.returncode == (-signal.SIGKILL if killed else 0)
    wait_for(lambda: not any(map(is_alive, pids)))
