"""What the server does for a page costs little, whatever the page holds."""

from __future__ import annotations

import gc
import urllib.request
import weakref
from collections.abc import Iterator
from pathlib import Path

import panel as pn
import pytest
from bokeh.document import Document
from browser import Server
from lone_seat import Seat
from panel.io.state import set_curdoc
from panel.util import edit_readonly

from app.dashboard import Dashboard
from app.session import Session
from app.worker.bench import Bench
from app.worker.pool import Pool
from solver.files import scene_settings


@pytest.fixture
def dashboard() -> Iterator[Dashboard]:
    pn.extension(notifications=True)
    pool = Pool(1)
    made = Dashboard(Session(pool, Bench(), scene_settings("bar").checked({})))
    yield made
    made.session.close()
    pool.close()


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


def test_the_server_starts_without_complaint_and_with_a_worker_at_hand(tmp_path: Path) -> None:
    server = Server(tmp_path / "log")
    try:
        server.wait()
        urllib.request.urlopen(server.address, timeout=30).close()
        assert len(server.processes()) > 1
        for word in ("Error", "WARNING", "Traceback"):
            assert word not in server.log, server.log
    finally:
        server.stop()
