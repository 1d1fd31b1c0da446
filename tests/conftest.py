"""Fixtures of tests in several files: a served page and a browser."""

from __future__ import annotations

# isort: off
import one_thread  # noqa: F401  # before NumPy, which asks but once
# isort: on

import gc
import os
import signal
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import hypothesis.internal.conjecture.providers as draws
import pytest
from browser import NO_BROWSER, Chrome, Server, free_port, serving
from hypothesis import settings
from hypothesis.internal.constants_ast import Constants
from playwright.sync_api import sync_playwright
from proxy import Proxy
from xdist.scheduler import LoadFileScheduling

LONGEST_FIRST = (
    "test_journey_",
    "test_installed_as_in_the_container",
    "test_measured_loops_are_fitted",
    "test_lessons",
    "test_closed_pages_leave_no_memory",
    "test_random_settings",
    "test_sweeps_are_resumed",
    "test_friction_changes_with_slip",
    "test_controls",
    "test_free_hinges",
    "test_scene_view",
    "test_views",
    "test_remarks_on_runs",
    "test_paper_figures",
)
"""Files of many seconds: whoever came to one of these last would work on alone."""
OPENS = "test_journey_run"
"""Journeys the first of which opens the page that stays open for all others."""

# Modules are no garbage, however many are imported: a tenth of the time of collection
gc.disable()

# What the first process compiles is there for the hundreds after it, servers and
# commands too
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

# A shell's background job ignores interrupts, and what it starts would, too
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# The same examples each time, however long a busy machine takes over one
settings.register_profile("same", derandomize=True, deadline=None)
settings.load_profile("same")

# Hypothesis also draws numbers that stand in our modules, those that happen to be
# loaded: which examples a test sees would depend on the tests that ran before it in the
# same process
draws._get_local_constants = Constants


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the files that take longest, and keep the order of all else."""

    def place(item: pytest.Item) -> tuple[bool, bool]:
        name = item.path.stem
        return name != OPENS, not name.startswith(LONGEST_FIRST)

    items.sort(key=place)


class Together(LoadFileScheduling):
    """Scheduler that gives a worker a file at a time, or all journeys."""

    def _split_scope(self, nodeid: str) -> str:
        file = super()._split_scope(nodeid)
        return "journeys" if Path(file).stem.startswith("test_journey_") else file


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Together:
    return Together(config, log)


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop() -> None:
    """Keep the garbage collector from searching the imported modules."""
    # What of them is garbage stays: to find it takes a third of a second a process
    gc.freeze()
    gc.enable()
    # Pages and figures are rings of thousands of models: as the server does
    gc.set_threshold(50_000, 20, 20)


def pytest_unconfigure(config: pytest.Config) -> None:
    """Print the number of skipped tests of the page, and the reason."""
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    if reporter:
        reports = reporter.stats.get("skipped", [])
    else:
        reports = []
    skipped = sum(NO_BROWSER in str(report.longrepr) for report in reports)
    if skipped:
        reporter.write_line(f"{skipped} tests skipped: {NO_BROWSER}")


@pytest.fixture(scope="session")
def proxy() -> Iterator[Proxy]:
    """A network by which a page may come to the server too."""
    with closing(Proxy()) as opened:
        yield opened


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory, proxy: Proxy) -> Iterator[Server]:
    """Server of the page."""
    port = free_port()
    origins = [
        f"--allow-websocket-origin=localhost:{each}" for each in (port, proxy.port)
    ]
    quick = ("--unused-session-lifetime", "8000", "--check-unused-sessions", "500")
    # As `slipfront serve` has it: on a busy machine a page is five minutes old when its
    # network breaks, and by default could not come back.
    patient = ("--session-token-expiration", "86400")
    with serving(
        tmp_path_factory.mktemp("server") / "log", port, *origins, *quick, *patient
    ) as made:
        proxy.target = made.port
        yield made


@pytest.fixture(scope="session")
def chrome() -> Iterator[Chrome]:
    """The browser."""
    with sync_playwright() as playwright, closing(Chrome(playwright)) as opened:
        yield opened
