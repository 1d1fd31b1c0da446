"""What tests of several files hold: a served page and a browser, worker processes."""

from __future__ import annotations

# isort: off
import one_thread  # noqa: F401  # before NumPy, which asks but once
# isort: on

from collections.abc import Iterator
from contextlib import ExitStack, closing

import hypothesis.internal.conjecture.providers as draws
import pytest
from browser import Server, browser
from hypothesis.internal.constants_ast import Constants
from pages import Visit, visits
from playwright.sync_api import Browser, expect
from processes import PATIENCE
from worker_line import Line

from solver.study.paper_runs import PaperRuns

# Hypothesis also draws numbers that stand in our modules, those that happen to be loaded: which
# examples a test sees would depend on the tests that ran before it in the same process
draws._get_local_constants = Constants


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    made = Server(tmp_path_factory.mktemp("server") / "log")
    made.wait()
    yield made
    made.stop()


@pytest.fixture(scope="session")
def chrome() -> Iterator[Browser]:
    expect.set_options(timeout=1e3 * PATIENCE)
    with browser() as opened:
        yield opened


@pytest.fixture(scope="session")
def paper_runs() -> PaperRuns:
    """Give the runs behind the paper's figures, each solved when it is first asked for."""
    return PaperRuns()


@pytest.fixture
def open_page(server: Server, chrome: Browser) -> Iterator[Visit]:
    with visits(server, chrome) as visit:
        yield visit


@pytest.fixture
def lines() -> Iterator[list[Line]]:
    """Give two worker processes."""
    with ExitStack() as stack:
        yield [stack.enter_context(closing(Line())) for _ in range(2)]


@pytest.fixture
def line() -> Iterator[Line]:
    with closing(Line()) as opened:
        yield opened
