"""The thread between browser and server: pictures one way, acknowledgements the other."""

from __future__ import annotations

import param

from app.innards import Plain


class Pulse(Plain):
    """An invisible component that paints pictures, and says when they are painted.

    Both are messages: as parameters, which Panel keeps on both sides, they took the server twice
    as long.
    """

    narrow = param.Boolean(default=False, doc="Whether the window has no room for a sidebar.")
    hidden = param.Boolean(default=False, doc="Whether the browser shows another page instead.")
    phone = param.Boolean(default=False, doc="Whether the header has no room for the tabs.")
    query = param.String(default="", doc="What an address has to say to come back to this.")
    copy = param.Integer(default=0, doc="Counts how often the address was to be copied.")
    copied = param.Integer(default=0, doc="The last of them that was; negative if it could not be.")
    beat = param.Integer(default=0, doc="Counts signs of life; negative asks for all of a picture.")
    heard = param.Integer(default=0, doc="The last sign of life that the server has heard.")

    _esm = "pulse.js"

    def paint(self, number: int, block: bytes) -> None:
        """Send a picture, as `app.worker.block` packs it; once painted, its number comes back."""
        self._send_msg([number, block])
