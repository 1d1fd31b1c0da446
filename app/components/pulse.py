"""The thread between browser and server: pictures one way, acknowledgements the other."""

from __future__ import annotations

import secrets
from collections.abc import Callable
from typing import Any

import param

from app.components.innards import Plain
from app.components.panes import script


class Pulse(Plain):
    """An invisible component that paints pictures, says when they are painted, and that it lives.

    All of these are messages: as parameters, which Panel keeps on both sides, pictures took the
    server twice as long.
    """

    page = param.String(default="", doc="Tells this page from that of a server's heir.")
    narrow = param.Boolean(default=False, doc="Whether the window has no room for a sidebar.")
    hidden = param.Boolean(default=False, doc="Whether the browser shows another page instead.")
    phone = param.Boolean(default=False, doc="Whether the header has no room for the tabs.")
    calm = param.Boolean(default=True, doc="Whether nothing is to move by itself.")
    query = param.String(default="", doc="What an address has to say to come back to this.")
    entries = param.Integer(default=0, doc="Counts the tabs that one can go back from.")
    copy = param.Integer(default=0, doc="Counts how often the address was to be copied.")
    copied = param.Integer(default=0, doc="The last of them that was; negative if it could not be.")
    leads = param.String(default="", doc="What leads a class again after the page was loaded anew.")
    recalls = param.Boolean(default=False, doc="Whether the browser is to say what it knows of it.")
    heard = param.Integer(default=0, doc="The last sign of life that the server has heard.")

    _esm = script("unpacked.js", "pulse.js")

    def paint(self, number: int, block: bytes) -> None:
        """Send a picture, as `app.wire.block` packs it; once painted, its number comes back."""
        self._send_msg([number, block])

    def on(self, kind: str, does: Callable[[Any], None]) -> None:
        """Have something done with what a message tells.

        It is the number of a picture that is "painted", or of a "beat", which counts signs of life,
        and if it is negative asks for all of a picture; or it is what "leads" a class again,
        or the address to which one "went" in the browser's history.
        """

        def hear(message: Any) -> None:
            told, page, number = message.data
            # A server that is started again has models of the same names as the one before.
            if told == kind and page == self.page:
                does(number)

        self.on_msg(hear)


def pulse() -> Pulse:
    """Give that of a page."""
    return Pulse(page=secrets.token_hex(8))
