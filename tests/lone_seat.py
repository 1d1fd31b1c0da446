"""A session's place in no pool, for tests of the page that need no run."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from app.worker.orders import Run
from app.worker.reports import Report


class Seat:
    """It stands for the pool too: it keeps the orders, and says what it is told to say."""

    def __init__(self) -> None:
        self.orders: list[Any] = []
        self.others_at_work = 0
        self.say: Callable[[Report], None] = lambda report: None

    def seat(self, listener: Callable[[Report], None]) -> Seat:
        self.say = listener
        return self

    def run(self, order: Run) -> None:
        self.orders.append(order)

    def send(self, order: Any) -> None:
        self.orders.append(order)

    def close(self) -> None:
        pass
