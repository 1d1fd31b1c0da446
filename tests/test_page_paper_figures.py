"""The paper's figures as the page has them computed, and draws them."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import closing
from typing import Any

import numpy as np
import pytest
from bokeh.document import Document
from panel.io.state import set_curdoc

from app.errand import Errand
from app.views import paper_figures
from app.views.panels import overlay
from app.views.paper_figures import PaperFigures
from app.worker.bench import Bench
from app.worker.job import Doing, Part, Send
from app.worker.studies import figures_of_the_paper
from solver.study.figure_data import PaperFigure

PATIENCE = 60.0


def refuse(send: Send) -> None:
    raise ValueError("no such thing")


def sleep(send: Send) -> None:
    send(Doing("asleep", 0.5))
    time.sleep(600.0)


def wait_for(condition: Callable[[], Any]) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


@pytest.fixture(scope="module")
def said() -> list[Any]:
    found: list[Any] = []
    figures_of_the_paper(found.append)
    return found


@pytest.fixture(scope="module")
def figures(said: list[Any]) -> list[PaperFigure]:
    return [one.value for one in said if isinstance(one, Part)]


@pytest.fixture(autouse=True)
def computed(monkeypatch: pytest.MonkeyPatch) -> list[PaperFigure]:
    """Give what the server has computed: nothing yet."""
    nothing: list[PaperFigure] = []
    monkeypatch.setattr(paper_figures, "COMPUTED", nothing)
    return nothing


@pytest.fixture
def errand() -> Iterator[Errand]:
    with closing(Bench()) as bench:
        yield Errand(bench)


@pytest.fixture
def view(errand: Errand) -> PaperFigures:
    made = PaperFigures(errand, "")
    made.view.visible = True
    return made


def test_they_come_one_by_one_and_say_how_far_they_are(
    said: list[Any], figures: list[PaperFigure]
) -> None:
    assert [figure.number for figure in figures] == [3, 4, 5, 6, 7, 8]
    shares = [one.share for one in said if isinstance(one, Doing)]
    assert shares == sorted(shares)
    assert shares[0] == 0.0


def test_every_curve_is_drawn_with_its_values(figures: list[PaperFigure]) -> None:
    for figure in figures:
        for panel in figure.panels:
            drawn = {part.label: part for part in overlay(panel) if type(part).__name__ == "Curve"}
            assert list(drawn) == [curve.label for curve in panel.curves]
            for curve in panel.curves:
                part = drawn[curve.label]
                assert np.array_equal(part.dimension_values(0), curve.x)
                shown = part.dimension_values(1)
                fits = (curve.y > 0.0) if panel.y.logarithmic else np.ones(len(curve.y), bool)
                assert np.array_equal(shown[fits], curve.y[fits])
                assert np.isnan(shown[~fits]).all()


def test_claims_findings_and_panels_stand_on_a_page_that_finds_them_computed(
    view: PaperFigures, errand: Errand, computed: list[PaperFigure], figures: list[PaperFigure]
) -> None:
    computed[:] = figures
    view.open()
    assert not errand.is_busy
    assert not view._start.visible
    for (words, row), figure in zip(view._results, figures, strict=True):
        assert f"Fig. {figure.number}" in words.object
        assert figure.verdict in words.object
        assert words.object.count("<li>") == len(figure.findings)
        assert len(row) == len(figure.panels)


def test_a_page_draws_one_panel_at_a_time(
    view: PaperFigures, computed: list[PaperFigure], figures: list[PaperFigure]
) -> None:
    """Twelve of them would hold up every page of the server for seconds."""
    later: list[Callable[[], None]] = []

    class Page(Document):
        def add_next_tick_callback(self, callback: Callable[[], None]) -> None:
            later.append(callback)

    computed[:] = figures
    drawn = []
    with set_curdoc(Page()):
        view.open()
        while later:
            drawn.append(sum(len(row) for _, row in view._results))
            view.refresh()
            later.pop(0)()
    assert drawn == list(range(1, sum(len(figure.panels) for figure in figures) + 1))


def test_a_failure_is_told_and_can_be_tried_again(
    view: PaperFigures, errand: Errand, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(paper_figures, "figures_of_the_paper", refuse)
    view.open()
    assert not view._start.visible
    wait_for(lambda: errand.collect() and not errand.is_busy)
    view.refresh()
    assert "no such thing" in view._progress.object
    assert view._start.visible
    assert not view._start.disabled
    monkeypatch.setattr(paper_figures, "figures_of_the_paper", sleep)
    view._on_start()
    assert errand.is_busy
    assert not view._start.visible


def test_it_can_be_cancelled_and_another_page_has_them_later(
    view: PaperFigures,
    errand: Errand,
    computed: list[PaperFigure],
    figures: list[PaperFigure],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(paper_figures, "figures_of_the_paper", sleep)
    view.open()
    wait_for(lambda: errand.collect() and errand.doing == "asleep")
    view.refresh()
    assert view._cancel.visible
    view._on_cancel()
    assert "Cancelled." in view._progress.object
    assert view._start.visible
    computed[:] = figures
    view.open()
    assert len(view._results) == len(figures)
    assert not view._start.visible
