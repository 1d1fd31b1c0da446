"""A scene that was solved plays its load cycle until somebody does something."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from app import transport
from app.messages import Needs
from app.server import PAGES
from app.state import PageState, Selection, default_settings
from app.transport import Transport
from app.worker.sampling import Sampler
from solver.scenes import discretise
from solver.study.scene_run import finished_run


class Document:
    """A document whose periodic callbacks are called by hand."""

    def __init__(self) -> None:
        self.periodic: list[Callable[[], Any]] = []

    def add_periodic_callback(
        self, callback: Callable[[], Any], period: int
    ) -> Callable[[], Any]:
        self.periodic.append(callback)
        return callback

    def remove_periodic_callback(self, callback: Callable[[], Any]) -> None:
        self.periodic.remove(callback)


class Watched:
    """A page that has just solved its first run, and a clock that is set by hand."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 0.0
        monkeypatch.setattr(
            transport, "time", SimpleNamespace(monotonic=lambda: self.now)
        )
        settings = default_settings("bar").replace(elements=10, instants=11)
        self.state = PageState(settings)
        self.document = Document()
        self.transport = Transport(self.state, self.document)
        run = finished_run(settings)
        sampler = Sampler(discretise(settings), settings, self.state.number)
        frame = sampler.frame(
            run.iterate, run.solution.records, run.solution.status, Needs()
        )
        self.state.param.update(newest=frame, frame=frame)
        self.wait(1.0)

    def wait(self, seconds: float) -> None:
        self.now += seconds
        for callback in list(self.document.periodic):
            callback()

    def plays(self) -> bool:
        before = self.state.selection.phase
        self.wait(0.3)
        return self.state.selection.phase != before


@pytest.mark.parametrize(("pages", "seconds"), [(1, 60.0), (3, 20.0), (30, 2.0)])
def test_pages_share_the_minute_of_playing(
    monkeypatch: pytest.MonkeyPatch, pages: int, seconds: float
) -> None:
    monkeypatch.setattr(PAGES, "count", pages)
    page = Watched(monkeypatch)
    page.wait(0.9 * seconds)
    assert page.plays()
    page.wait(0.2 * seconds)
    assert not page.plays()
    assert page.state.selection.phase == Selection.phase


def test_a_scene_plays_until_the_user_acts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    page = Watched(monkeypatch)
    assert page.plays()
    page.state.settings = page.state.settings.replace(friction=0.2)
    assert not page.plays()
    assert page.state.selection.phase == Selection.phase


def test_the_range_of_iterations_moves_seldom_in_a_run_and_is_exact_at_its_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    page = Watched(monkeypatch)
    end = page.state.frame
    slider = page.transport.scrub
    starts = []
    for number, status in (
        (100, None),
        (110, None),
        (190, None),
        (210, None),
        (220, end.status),
    ):
        frame = replace(end, iteration=number, is_answer=False, status=status)
        page.state.param.update(newest=frame, frame=frame)
        page.wait(0.4)
        starts.append(slider.start)
    assert starts == [-99, -99, -99, -209, -219]


def test_a_first_run_that_failed_plays_nothing() -> None:
    state = PageState(default_settings("bar"), has_failed=True)
    document = Document()
    followed = Transport(state, document)
    followed._follow()
    assert followed.play_button.icon == "play_circle"
