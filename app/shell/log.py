"""The server's log: a line for what happens, and none for what follows from it."""

from __future__ import annotations

import logging

import panel as pn
from tornado.iostream import StreamClosedError
from tornado.websocket import WebSocketClosedError

from app.session.session import Session

LOGGERS = ("asyncio", "bokeh.server.views.ws", "panel.io.document", "tornado.application")
NOT_SENT = "Failed sending message as connection was closed"
"""What Bokeh and Panel say of each message on its way to a page that is closed or reloaded."""


class RunLog:
    """Tells whoever serves a page what its runs come to; a drag is no news till its end."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._told = (0, "")
        session.param.watch(lambda event: self._follow(), "facts")

    def _follow(self) -> None:
        """Say it, if it is news."""
        session = self._session
        if session.facts is None or session.follows_hand:
            return
        facts = session.facts
        came_to = "ended" if facts.is_over else "broke" if facts.is_broken else "started"
        came_to = "waits to be agreed to" if facts.asks else came_to
        if (session.ticket, came_to) != self._told:
            self._told = session.ticket, came_to
            pn.state.log(f"run {session.ticket} of {session.settings.scene} {came_to}")


def leave_out_the_unsent() -> None:
    """Have nothing said of messages that a closed socket did not take: its closing is a line."""
    for name in LOGGERS:
        logging.getLogger(name).addFilter(_is_news)


def _is_news(record: logging.LogRecord) -> bool:
    error = record.exc_info[1] if record.exc_info else None
    is_of_closed = isinstance(error, WebSocketClosedError | StreamClosedError)
    return not is_of_closed and record.getMessage() != NOT_SENT
