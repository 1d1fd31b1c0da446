"""A link to no process, for tests of the page that need no run."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from app.session.pages import Pages
from app.session.report_executor import ReportExecutor
from app.session.session import Session
from app.session.turns import Turns
from app.wire.orders import Order
from app.wire.reports import Report
from solver.settings import Settings


class LoneLink:
    """It keeps the orders, and says what it is told to say."""

    def __init__(self) -> None:
        self.orders: list[Any] = []
        self.say: Callable[[Report], None] = lambda report: None
        self.hired = 0
        self.is_closed = False

    def hire(self, listener: Callable[[Report], None]) -> Any:
        self.say, self.is_closed = listener, False
        self.hired += 1
        return self

    def send(self, order: Order) -> None:
        self.orders.append(order)

    def close(self) -> None:
        self.is_closed = True


def lone_session(settings: Settings, turns: Turns | None = None) -> Session:
    """Give the only page of a server, without a process."""
    return Session(Pages(1), ReportExecutor(), settings, LoneLink().hire, turns)
