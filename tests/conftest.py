"""What tests of several files hold: a served page and a browser, worker processes."""

from __future__ import annotations

# isort: off
import one_thread  # noqa: F401  # before NumPy, which asks but once
# isort: on

import gc
import os
import sys
from collections.abc import Iterator
from contextlib import ExitStack, closing

import hypothesis.internal.conjecture.providers as draws
import pytest
from browser import Chrome, Server, free_port
from hypothesis import settings
from hypothesis.internal.constants_ast import Constants
from pages import Visit, visits
from playwright.sync_api import expect, sync_playwright
from processes import PATIENCE
from proxy import Proxy
from worker_line import Line

from app.session.report_executor import ReportExecutor
from app.session.report_job import ReportJob
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


def pytest_collection_finish() -> None:
    """Have no collection of garbage look through all that was imported again."""
    gc.collect()
    gc.freeze()


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
    expect.set_options(timeout=1e3 * PATIENCE)
    with sync_playwright() as playwright, closing(Chrome(playwright)) as opened:
        yield opened


@pytest.fixture(scope="session")
def paper_runs() -> PaperRuns:
    """Give the runs behind the paper's figures, each solved when it is first asked for."""
    return PaperRuns()


@pytest.fixture
def open_page(server: Server, chrome: Chrome) -> Iterator[Visit]:
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
