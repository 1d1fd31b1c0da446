"""Private parts of Panel and Bokeh that the page touches, each with its reason.

`tests/test_private_parts_are_still_there.py` notices when one of them changes.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from typing import Any

import panel as pn
from bokeh.document import Document
from bokeh.server import session as bokeh_session
from bokeh.server.contexts import ApplicationContext
from bokeh.server.protocol_handler import ProtocolHandler
from bokeh.server.tornado import BokehTornado
from bokeh.server.util import check_allowlist
from panel.custom import JSComponent
from panel.io.liveness import LivenessHandler
from panel.io.server import DocHandler
from panel.util.parameters import edit_readonly
from tornado.web import OutputTransform

THREADS = "_run_in_executor"
"""Of Bokeh 3.10: what gives threads the messages of browsers and the callbacks of sessions."""
MADE_ON_A_THREAD = "_can_initialize_document_in_worker"
"""Of Bokeh 3.10: what tells whether a page is made on a thread."""


class Plain(JSComponent):
    """A component whose program is JavaScript as browsers know it.

    Panel takes a program for TypeScript, and has every page translate it in the browser: 0.2 s for
    all of ours. What has a bundle is taken as it is.
    """

    def _get_properties(self, doc: Document | None) -> dict[str, Any]:
        return {**super()._get_properties(doc), "bundle": type(self).__name__}


def connections() -> set[Any]:
    """Give the present session's sockets: one that broke and was opened again is another one."""
    context: Any = pn.state.curdoc.session_context if pn.state.curdoc else None
    return set(context.session._subscribed_connections) if context is not None else set()


def on_sockets(does: Callable[[], None]) -> None:
    """Have something done now, and whenever a socket of the present session opens or closes."""
    context: Any = pn.state.curdoc.session_context if pn.state.curdoc else None
    if context is None:
        return
    for name in ("subscribe", "unsubscribe"):
        act = getattr(context.session, name)

        def heed(connection: Any, act: Callable[[Any], None] = act) -> None:
            act(connection)
            does()

        setattr(context.session, name, heed)
    does()


def accepts(host: str) -> bool:
    """Tell whether the server of the present session takes pages of a host, named with its port."""
    return any(
        check_allowlist(host, connection._socket.application.websocket_origins)
        for connection in connections()
    )


def send_without_delay(sockets: set[Any]) -> None:
    """Let sockets send small messages at once.

    A message of Bokeh's protocol is three small writes or more. By default (Nagle's algorithm) the
    second waits until the browser acknowledges the first, and browsers put that off for 40 ms.
    """
    for connection in sockets:
        connection._socket.set_nodelay(True)


def alive_with(facts: Callable[[], Mapping[str, Any]]) -> None:
    """Have the liveness endpoint of Panel, which says but `true`, say how the server fares."""
    get: Any = LivenessHandler.get

    async def tell(handler: LivenessHandler) -> None:
        await get(handler)
        if handler.get_argument("endpoint", default=None) is None:
            # What was written is not sent yet.
            handler.clear()
            handler.write({handler.request.path: True, **facts()})

    LivenessHandler.get = tell  # type: ignore[method-assign]


def answer_heads(is_open: Callable[[str], bool]) -> None:
    """Have a page be asked for without its contents: 410 if it is named, and not open here."""

    async def head(handler: DocHandler, *_: Any) -> None:
        page = handler.get_argument("page", "")
        if page and not is_open(page):
            handler.set_status(410)

    DocHandler.head = head


def send_by(transform: type[OutputTransform]) -> None:
    """Have all that follows the first page that is asked for go through a transform."""
    prepare: Any = DocHandler.prepare

    async def prepare_all(handler: DocHandler) -> None:
        if transform not in handler.application.transforms:
            handler.application.add_transform(transform)
        await prepare(handler)

    DocHandler.prepare = prepare_all  # type: ignore[assignment,method-assign]


def let_come_back(seconds: int) -> None:
    """Have the socket of a page opened again so long after the page was asked for, s.

    Bokeh refuses that after five minutes, unless told otherwise, and the page has to be made anew.
    """
    told: Any = BokehTornado.session_token_expiration

    def longest(server: BokehTornado) -> int:
        return max(seconds, int(told.fget(server)))

    BokehTornado.session_token_expiration = property(longest)  # type: ignore[assignment,method-assign]


def open_in_turn() -> None:
    """Have pages opened one after the other.

    What has come in meanwhile is all done in one turn of the event loop: of thirty pages that are
    asked for together, everybody else waits for all.
    """
    get: Any = DocHandler.get
    turn = asyncio.Lock()

    async def wait(handler: DocHandler, *args: Any, **options: Any) -> None:
        async with turn:
            await get(handler, *args, **options)
            await asyncio.sleep(0)

    DocHandler.get = wait  # type: ignore[method-assign]


def stay_on_loop() -> None:
    """Have pages made on the event loop, and all that they do done there, one after the other.

    Bokeh does it on threads from 3.10 on. What pages share is made for one at a time; a thread has
    an event loop of its own, which nobody runs: what a page leaves there keeps it for good; and
    Panel 1.10, busy for the first time on a thread, asks for the loop from there without end.
    """

    async def do(what: Callable[..., Any], *args: Any, **options: Any) -> Any:
        return what(*args, **options)

    if hasattr(bokeh_session, THREADS):
        setattr(bokeh_session, THREADS, do)
    if hasattr(ApplicationContext, MADE_ON_A_THREAD):
        setattr(ApplicationContext, MADE_ON_A_THREAD, lambda _: False)


def ignore_the_lost() -> None:
    """Have no messages heeded of pages that were given up: a server that ends still reads them."""
    handlers: Any = ProtocolHandler
    handle = handlers.handle

    async def heed(handler: ProtocolHandler, message: Any, connection: Any) -> Any:
        return await handle(handler, message, connection) if connection._session else None

    handlers.handle = heed


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
