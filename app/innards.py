"""Private parts of Panel and Bokeh that the page touches, each with its reason.

`tests/test_private_parts_are_still_there.py` notices when one of them changes.
"""

from __future__ import annotations

from typing import Any

import panel as pn
from bokeh.document import Document
from panel.util import edit_readonly

GATHER_MS = 1
"""For how long Panel gathers what a widget sends, instead of 50 ms: only what came while the server
was busy, and a slider's two messages about one move, each of which costs Panel 4 ms."""


def gather_briefly(widget: Any) -> None:
    """Hear of a widget's changes at once."""
    widget._debounce = GATHER_MS


def connections() -> set[Any]:
    """Give the present session's sockets: one that broke and was opened again is another one."""
    context = pn.state.curdoc.session_context if pn.state.curdoc else None
    return set(context.session._subscribed_connections) if context is not None else set()


def send_without_delay(sockets: set[Any]) -> None:
    """Let sockets send small messages at once.

    A message of Bokeh's protocol is three small writes or more. By default (Nagle's algorithm) the
    second waits until the browser acknowledges the first, and browsers put that off for 40 ms.
    """
    for connection in sockets:
        connection._socket.set_nodelay(True)


def ignore_business(page: Any) -> None:
    """Keep a page from following the server's being busy.

    That costs a walk over all models twice for every event of the browser (60 ms), and would only
    turn an indicator that is not there. A value would leave the server's hold on the page, for
    good; another reference ends it.
    """
    with edit_readonly(page):
        page.busy = page.param.loading


def forget(document: Document) -> None:
    """Take a document that is closed from Panel's table of views.

    Panel leaves the roots there that it adds by itself, and with them, whole, every page that ever
    was: 4 to 5.5 MB each.
    """
    for reference, (_, _, owner, _) in list(pn.state._views.items()):
        if owner is document:
            del pn.state._views[reference]
