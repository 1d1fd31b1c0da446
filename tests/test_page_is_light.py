"""A page holds what applies to its run and no more, and costs the server little."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing

import panel as pn
import pytest
from bokeh.document import Document
from lone_seat import Seat
from panel.io.state import set_curdoc
from panel.util import edit_readonly

from app.address import settings_from_query
from app.dashboard import Dashboard
from app.session import Session
from app.worker.bench import Bench
from app.worker.pool import Pool
from solver.files import scene_settings


@pytest.fixture
def make() -> Iterator[Callable[[str], Dashboard]]:
    """Give what makes the page of an address."""
    pn.extension(notifications=True)
    with ExitStack() as stack:
        pool = stack.enter_context(closing(Pool(1)))
        bench = stack.enter_context(closing(Bench()))

        def made(query: str) -> Dashboard:
            settings, complaint = settings_from_query(query)
            assert not complaint
            return Dashboard(stack.enter_context(closing(Session(pool, bench, settings))))

        yield made


@pytest.fixture
def dashboard(make: Callable[[str], Dashboard]) -> Dashboard:
    return make("")


def test_a_busy_server_changes_nothing_on_the_page(dashboard: Dashboard) -> None:
    """Following the server's business walks all models, twice for every event of a browser."""
    changes: list[object] = []
    dashboard.page.param.watch(changes.append, "busy")
    with edit_readonly(pn.state):
        pn.state.busy = True
        pn.state.busy = False
    assert not changes


def test_a_page_that_nobody_looks_at_is_forgotten() -> None:
    """Twenty pages that the server did not let go were 200 MB."""
    with set_curdoc(Document()):
        pn.extension(notifications=True)
        session = Session(Seat(), Bench(), scene_settings("bar").checked({}))
        page = weakref.ref(Dashboard(session).page)
    gc.collect()
    assert page() is None


# panel-material-ui gives its download button both names of one parameter.
@pytest.mark.filterwarnings("ignore:Both 'variant' and 'button_style'")
def test_the_first_picture_is_in_the_page_and_the_controls_are_not_yet(
    dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.dashboard.FIRST_PATIENCE", 20.0)
    dashboard.prepare()
    assert dashboard.session.run.newest is not None
    assert "iteration" in dashboard._status.object
    assert len(dashboard._plots) == 3
    assert not dashboard._sidebar.view.objects
    dashboard.loaded()
    assert len(dashboard._plots) == 6
    assert dashboard._sidebar.view.objects


@pytest.mark.filterwarnings("ignore:Both 'variant' and 'button_style'")
@pytest.mark.parametrize(
    ("query", "views", "substructures"),
    [
        ("?instants=1", 4, False),
        ("?linear_stage=pgd", 9, True),
        ("?linear_stage=pgd&substructures=1", 9, False),
        ("?linear_stage=pgd&instants=1", 6, True),
        ("?scene=strand&wires=20&broken=0&elements=2&substructures=1", 7, False),
    ],
)
def test_views_and_sliders_are_those_that_apply(
    make: Callable[[str], Dashboard], query: str, views: int, substructures: bool
) -> None:
    dashboard = make(query)
    dashboard.prepare()
    dashboard.loaded()
    transport = dashboard.transport
    assert len(dashboard._plots) == views
    assert (transport._substructure in transport._sliders.objects) == substructures
