"""What tests of several files hold: a served page and a browser, worker processes."""

from __future__ import annotations

# isort: off
import one_thread  # noqa: F401  # before NumPy, which asks but once
# isort: on

import gc
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing
from pathlib import Path
from typing import Any

import hypothesis.internal.conjecture.providers as draws
import pytest
from browser import NO_BROWSER, Chrome, Server, chromium, free_port
from hypothesis import settings
from hypothesis.internal.constants_ast import Constants
from pages import Visit, visits
from playwright.sync_api import expect, sync_playwright
from processes import PATIENCE
from proxy import Proxy
from worker_line import Line
from xdist.scheduler import LoadFileScheduling

from app.session.report_executor import ReportExecutor
from app.session.report_job import ReportJob
from solver.study.figures import paper_runs as runs_of_the_paper
from solver.study.figures.paper_runs import PaperRuns

LONGEST_FIRST = (
    "test_page_fits_its_window",
    "test_page_tabs",
    "test_page_asks_what_if",
    "test_a_class_in_a_browser",
    "test_page_for_everybody",
    "test_page_in_a_browser",
    "test_sweep_on_a_cluster",
    "test_terms_are_explained",
    "test_installed_as_in_the_container",
    "test_every_setting_can_be_moved",
    "test_page_survives_its_server",
    "test_page_on_a_phone",
    "test_page_is_taken_away",
    "test_page_teaches",
    "test_figures_command",
    "test_converged_means_it",
    "test_the_scene_is_pictured_in_a_browser",
    "test_page_paper_figures",
    "test_engine_reaches_the_reference",
    "test_sweep_command",
    "test_page_shows_the_bases",
    "test_page_controls",
    "test_survey_judges_random_runs",
    "test_lessons_hold",
    "test_server_leaves_nothing_behind",
    "test_strand_agrees_with_the_reference",
    "test_strand_whatever_the_method",
    "test_stability",
    "test_worker_process",
    "test_long_reports_are_made_in_turn",
    "test_estimated_error",
    "test_broken_wire_regains_its_force",
    "test_nothing_is_kept_of_closed_pages",
    "test_converged_is_near_the_reference",
    "test_pgd_linear_stage",
    "test_study_command",
    "test_acceleration",
    "test_block_on_a_slope",
    "test_worker_shows_the_bases",
    "test_quantities_of_a_run",
    "test_random_scenes",
    "test_page_is_light",
    "test_charts_are_drawn",
    "test_sweep_goes_on",
)
"""Files of some four seconds of a processor or more. A worker has a file to itself, so whoever
came to one of these last would work on alone."""
TOGETHER = {
    "the paper's runs": (
        "test_figures_command",
        "test_page_paper_figures",
        "test_paper_figures_3_and_4",
        "test_paper_figures_5_to_8",
    ),
}
"""Files that one worker has, one after the other, by what it keeps from each to the next."""

# What the first process compiles is there for the hundreds after it, servers and commands too
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

# The same examples each time, however long a busy machine takes over one
settings.register_profile("same", derandomize=True, deadline=None)
settings.load_profile("same")

# Hypothesis also draws numbers that stand in our modules, those that happen to be loaded: which
# examples a test sees would depend on the tests that ran before it in the same process
draws._get_local_constants = Constants


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the files that take longest, and keep the order of all else."""
    places = {name: place for place, name in enumerate(LONGEST_FIRST)}
    items.sort(key=lambda item: places.get(item.path.stem, len(places)))


class Together(LoadFileScheduling):
    """Gives a worker a file at a time, or all files that share what one of them made."""

    def _split_scope(self, nodeid: str) -> str:
        file = super()._split_scope(nodeid)
        return next((name for name, files in TOGETHER.items() if Path(file).stem in files), file)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Together:
    return Together(config, log)


def pytest_collection_finish() -> None:
    """Have no collection of garbage look through all that was imported again."""
    gc.collect()
    gc.freeze()


def pytest_unconfigure(config: pytest.Config) -> None:
    """Say in the last line how many tests of the page were skipped, and why."""
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    reports = reporter.stats.get("skipped", []) if reporter else []
    skipped = sum(NO_BROWSER in str(report.longrepr) for report in reports)
    if skipped:
        reporter.write_line(f"{skipped} tests skipped: {NO_BROWSER}")


@pytest.fixture(scope="session")
def proxy() -> Iterator[Proxy]:
    """Give a network by which a page may come to the server too."""
    with closing(Proxy()) as opened:
        yield opened


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory, proxy: Proxy) -> Iterator[Server]:
    port = free_port()
    origins = [f"--allow-websocket-origin=localhost:{one}" for one in (port, proxy.port)]
    made = Server(tmp_path_factory.mktemp("server") / "log", port, *origins)
    made.wait()
    yield made
    made.stop()


@pytest.fixture(scope="session")
def chrome() -> Iterator[Chrome]:
    chromium()
    expect.set_options(timeout=1e3 * PATIENCE)
    with sync_playwright() as playwright, closing(Chrome(playwright)) as opened:
        yield opened


@pytest.fixture(scope="session")
def solved() -> list[str]:
    """Give what was called to solve the runs of the paper's figures, in order."""
    return []


@pytest.fixture(scope="session")
def paper_runs(solved: list[str]) -> Iterator[PaperRuns]:
    """Give the runs behind the paper's figures, each solved when it is first asked for."""
    with pytest.MonkeyPatch.context() as patch:
        for name in ("solve", "incremental"):
            patch.setattr(runs_of_the_paper, name, counted(name, solved))
        yield PaperRuns()


def counted(name: str, calls: list[str]) -> Callable[..., object]:
    """Give a function of these runs that also says that it was called."""
    real = getattr(runs_of_the_paper, name)

    def call(*given: object, **options: object) -> object:
        calls.append(name)
        return real(*given, **options)

    return call


@pytest.fixture
def open_page(chrome: Chrome, server: Server) -> Iterator[Visit]:
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


@pytest.fixture
def executor() -> Iterator[ReportExecutor]:
    with ReportExecutor() as opened:
        yield opened


@pytest.fixture
def job(executor: ReportExecutor) -> Iterator[ReportJob]:
    made = ReportJob(executor)
    yield made
    made.cancel()
