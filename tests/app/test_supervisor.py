"""A worker that is stuck is replaced, and none that only waits for its page to load."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import app.supervisor
from app.messages import Began, Order, Start
from app.state import PageState, default_settings
from app.supervisor import Supervisor


class Document:
    """A document whose time goes on when it is told."""

    def add_periodic_callback(
        self, callback: Callable[[], Any], milliseconds: int
    ) -> None:
        assert milliseconds > 0
        self.look = callback

    def add_next_tick_callback(self, callback: Callable[[], Any]) -> None:
        callback()


class Process:
    """A worker that reports what it is made to."""

    hangs = False

    def __init__(self, hear: Callable[[Any, Any], None]) -> None:
        self.hear = hear
        self.orders: list[Order] = []

    def send(self, order: Order) -> None:
        self.orders.append(order)

    def end(self) -> None:
        self.orders.clear()


def test_a_worker_is_stuck_only_once_its_page_has_loaded(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made: list[Process] = []

    def worker(hear: Callable[[Any, Any], None], others: int) -> Process:
        made.append(Process(hear))
        return made[-1]

    monkeypatch.setattr(app.supervisor, "Worker", worker)
    monkeypatch.setattr(app.supervisor, "STUCK", -1.0)
    document = Document()
    state = PageState(default_settings("bar"))
    supervisor = Supervisor(state, document)
    supervisor.begin()
    state.run()
    document.look()
    assert len(made) == 1
    made[0].hear(made[0], Began(state.number))
    assert state.began != state.number
    supervisor.open()
    assert state.began == state.number
    document.look()
    assert len(made) == 1
    state.run()
    document.look()
    assert len(made) == 2
    assert any(isinstance(order, Start) for order in made[1].orders)
