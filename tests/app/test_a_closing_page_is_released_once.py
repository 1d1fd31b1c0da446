"""A page that closes while all pages are asked for a sign of life."""

from __future__ import annotations

import pytest
from panel.io.server import WSHandler
from tornado.websocket import WebSocketClosedError

from app.server import PageSocket


def test_a_page_that_closes_is_not_let_go_of_before_it_has_closed() -> None:
    """Bokeh lets go of a page whose socket says that it is closed.

    Once more would be an error in the log ("Uncaught exception GET /app/ws"): 5 of 300
    sockets that closed while asked each millisecond.
    """
    closed = PageSocket.__new__(PageSocket)
    closed.ws_connection = None
    with pytest.raises(WebSocketClosedError):
        WSHandler.ping(closed)
    closed.ping()
