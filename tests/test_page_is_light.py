"""A page holds what applies to its run and no more, and costs the server little."""

from __future__ import annotations

import gc
import json
import subprocess
import sys
import weakref
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing

import panel as pn
import pytest
from bokeh.document import Document
from bokeh.models import Plot
from browser import ROOT
from lone_link import LoneLink, lone_session
from panel.io.state import set_curdoc

from app.components.innards import forget
from app.session.pages import Pages
from app.session.report_executor import ReportExecutor
from app.session.session import Session
from app.shell.address import settings_from_query, sight_from_query
from app.shell.dashboard import Dashboard
from app.wire.orders import Step
from solver.files import scene_settings


@pytest.fixture
def link() -> LoneLink:
    return LoneLink()


@pytest.fixture
def make(link: LoneLink) -> Iterator[Callable[[str], Dashboard]]:
    """Give what makes the page of an address."""
    pn.extension(notifications=True)
    with ExitStack() as stack:
        executor = stack.enter_context(ReportExecutor())

        def made(query: str) -> Dashboard:
            settings, complaint = settings_from_query(query)
            assert not complaint
            session = stack.enter_context(closing(Session(Pages(9), executor, settings, link.hire)))
            return Dashboard(session, sight=sight_from_query(query)[0])

        yield made


@pytest.fixture
def dashboard(make: Callable[[str], Dashboard]) -> Dashboard:
    return make("")


def test_a_page_that_nobody_looks_at_is_forgotten() -> None:
    """Twenty pages that the server did not let go were 200 MB."""
    with set_curdoc(Document()):
        pn.extension(notifications=True)
        session = lone_session(scene_settings("bar").checked({}))
        page = weakref.ref(Dashboard(session).page)
        del session
    gc.collect()
    assert page() is None


def test_a_page_that_nobody_has_built_starts_no_process(
    dashboard: Dashboard, link: LoneLink
) -> None:
    dashboard.hear()
    assert link.hired == 0
    dashboard.loaded()
    assert link.hired == 1


def test_the_server_makes_no_figure_for_a_page_and_sends_little_of_any() -> None:
    document = Document()
    with set_curdoc(document):
        pn.extension(notifications=True)
        with closing(lone_session(scene_settings("bar").checked({}))) as session:
            dashboard = Dashboard(session)
            dashboard.page.server_doc(document)
            assert len(dashboard._gallery.shown) == 6
            assert not list(document.select({"type": Plot}))
            # Without `defs`, which are of every model that this process has imported so far.
            assert len(json.dumps(document.to_json(deferred=False)["roots"])) < 580_000
            forget(document)


def test_an_address_that_waits_at_an_iteration_costs_one_order_however_far_that_is(
    make: Callable[[str], Dashboard], link: LoneLink
) -> None:
    dashboard = make("?iteration=90000")
    dashboard.loaded()
    assert [order for order in link.orders if isinstance(order, Step)] == [Step(1, 89_999)]
    assert not dashboard.session.goes_on


@pytest.mark.parametrize(
    ("query", "views", "substructures"),
    [
        ("?instants=1", 5, False),
        ("?linear_stage=pgd", 12, True),
        ("?linear_stage=pgd&substructures=1", 12, False),
        ("?linear_stage=pgd&instants=1", 7, True),
        ("?scene=strand&wires=20&broken=0&elements=2&substructures=1", 13, False),
        ("?scene=strand", 13, False),
        ("?scene=block", 9, False),
        ("?scene=layers", 9, False),
        ("?scene=incline", 9, False),
    ],
)
def test_views_and_sliders_are_those_that_apply(
    make: Callable[[str], Dashboard], query: str, views: int, substructures: bool
) -> None:
    dashboard = make(query)
    dashboard.loaded()
    transport = dashboard._transport
    assert sum(len(names) for *_, names in dashboard._gallery.shown) == views
    assert (transport._substructure in transport._sliders.objects) == substructures


def test_a_server_that_draws_no_report_imports_nothing_that_would() -> None:
    program = (
        "import sys, app.server.serve\n"
        "app.server.serve.rehearse()\n"
        "sys.exit(str({'holoviews', 'matplotlib'} & sys.modules.keys() or ''))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.stderr.strip() == ""
