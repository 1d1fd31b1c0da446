"""A worker process as tests hold it."""

from __future__ import annotations

import time
from collections.abc import Callable

import pytest
from processes import PATIENCE
from shown_pages import ALL

from app.wire.orders import Order, Ready, Watch
from app.wire.reports import Picture
from app.worker import link

SHORT = {"method": "paper", "tolerance": 1e-8, "max_iterations": 50}
STALLING = {
    "method": "paper",
    "tolerance": 1e-30,
    "elements": 20,
    "substructures": 4,
    "max_iterations": 60,
}


class Line:
    """A worker process and all that it has sent; it is asked for every picture."""

    def __init__(self) -> None:
        self.process, self.connection = link.start()
        self.pictures: list[Picture] = []
        self.send(Watch(ALL), Ready())

    def close(self) -> None:
        self.process.kill()
        self.process.join()
        self.connection.close()

    def send(self, *orders: Order) -> None:
        for order in orders:
            self.connection.send(order)

    def until(self, condition: Callable[[Picture], bool]) -> Picture:
        """Listen until such a picture comes."""
        end = time.monotonic() + PATIENCE
        while self.connection.poll(max(end - time.monotonic(), 0.0)):
            picture: Picture = self.connection.recv()
            self.pictures.append(picture)
            self.send(Ready())
            if isinstance(picture, Picture) and condition(picture):
                return picture
        pytest.fail("no such picture")
