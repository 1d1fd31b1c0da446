"""Many kills of its worker, and many drops of its connection, leave a page as it was."""

from __future__ import annotations

import asyncio
import os
import signal
import threading
from contextlib import closing
from pathlib import Path

import pytest
from processes import is_alive, wait_for
from web_pages import WebPage, give_up_pages, run_apart, serve_pages, until

from app.server import serve
from app.session.pages import Pages
from app.session.report_executor import ReportExecutor
from app.session.session import Session
from app.worker.link import warm_up
from solver.scenes.bar import BarSettings

TIMES = 8
ROW = 4
"""Kills of one run: a process has to get farther than the one before it."""


def open_files() -> int:
    return len(list(Path("/proc/self/fd").iterdir()))


def workers() -> int:
    return sum(thread.name.startswith("worker-") for thread in threading.enumerate())


def test_many_kills_in_a_row_leave_nothing_and_the_run_goes_on() -> None:
    warm_up()
    endless = {"method": "paper", "tolerance": 1e-30, "elements": 10, "instants": 11}
    settings = BarSettings.checked({**endless, "max_iterations": 100_000, "substructures": 2})
    files, threads = open_files(), workers()
    killed = []
    with closing(Session(Pages(1), ReportExecutor(), settings)) as session:
        session.set_pace(None)
        session.start()

        def gets_beyond(done: int) -> bool:
            if session.collect():
                session.ask()
            return session.facts is not None and session.facts.done > done

        for time in range(TIMES):
            if time % ROW == 0:
                session.change("friction", round(0.2 + 1e-3 * time, 3))
                done = 0
            wait_for(lambda done=done: gets_beyond(done))
            assert session.facts is not None
            done = session.facts.done
            link = session.worker.link
            assert link is not None
            assert link.pid is not None
            killed.append(link.pid)
            os.kill(link.pid, signal.SIGKILL)
            wait_for(lambda link=link: session.collect() and session.worker.link is not link)
        wait_for(lambda: gets_beyond(done))
        assert session.settings.changed() == {**settings.changed(), "friction": 0.204}
        assert session.goes_on
        assert len(set(killed)) == TIMES
        # Its pipes live as long as it does.
        del link
    wait_for(lambda: workers() <= threads)
    wait_for(lambda: open_files() <= files)
    assert not any(map(is_alive, killed))


# Panel hands its download button both names of one parameter.
@pytest.mark.filterwarnings("ignore")
def test_many_drops_in_a_row_leave_nothing_and_pictures_come() -> None:
    async def drops() -> None:
        server = serve_pages()
        page = WebPage(f"http://localhost:{server.port}/app?method=paper&tolerance=1e-30")
        await page.open()
        for _ in range(TIMES):
            life = asyncio.create_task(page.live())
            came = len(page.times)
            await until(lambda came=came: len(page.times) > came)
            page.close()
            await life
            await page.connect()
        (session,) = server.get_sessions("/app")
        assert session.connection_count <= 2
        page.close()
        give_up_pages(server)
        await until(lambda: not server.get_sessions("/app"))
        await until(lambda: len(serve.PAGES) == 0)
        server.stop()

    threads = workers()
    run_apart(drops())
    wait_for(lambda: workers() <= threads)
