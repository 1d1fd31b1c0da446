"""What a page says of the class that it leads or follows, and its one button there."""

from __future__ import annotations

import socket
from contextlib import suppress
from functools import cache
from html import escape
from urllib.parse import urlsplit

import panel as pn
import segno

from app.components.innards import accepts
from app.components.panes import button, column, text
from app.session.session import Session
from app.shell.address import CLASS

DOCUMENTATION = "192.0.2.1"
"""An address that nobody has (RFC 5737)."""


class Banner:
    """A line above the run; it is not there without a class.

    Parameters
    ----------
    session
        Of the page.

    Attributes
    ----------
    view
        What stands on the page.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._said = "", ""
        self._words = text(role="class", sizing_mode="stretch_width")
        self._code = text(role="code", visible=False)
        self._button = button("", "group", self._press, variant="outlined", min_width=150)
        line = pn.FlexBox(self._words, self._button, align_items="center", flex_wrap="nowrap")
        self.view = column(line, self._code, role="banner", visible=False)
        session.param.watch(lambda event: self._say(), "in_class")

    def _say(self) -> None:
        attendance = self._session.attendance
        follows, left = attendance.follows, attendance.left
        words, label = "", ""
        if self._code.visible != (attendance.leads is not None):
            code = attendance.leads.code if attendance.leads is not None else ""
            self._code.param.update(visible=bool(code), object=_picture_of(code) if code else "")
        if attendance.leads is not None:
            code, count = attendance.leads.code, attendance.leads.present
            others = urlsplit(address_for_others())
            where = f"{others.netloc}{others.path}" if others.netloc else "this address with "
            counted = f"{count} {'follows' if count == 1 else 'follow'}"
            words = (
                f"Class <b>{code}</b>: whoever opens <b>{escape(where)}?{CLASS}={code}</b> sees "
                f"what you see. {counted}."
            )
            label = "End the class"
        elif follows is not None:
            words = f"You follow class <b>{escape(follows.code)}</b>. " + (
                "It has ended."
                if follows.is_over
                else "Its leader is away: it waits some minutes."
                if follows.is_alone
                else "Change anything to go on by yourself."
            )
            label = "Go on by myself"
        elif left is not None and not left.is_over:
            words = f"You have left class <b>{escape(left.code)}</b>."
            label = "Follow again"
        if self._said != (said := (words, label)):
            self._said = said
            self._words.object, self._button.label = said
            self.view.visible = bool(words)

    def _press(self) -> None:
        session, attendance = self._session, self._session.attendance
        if attendance.leads is not None:
            attendance.end()
        elif attendance.follows is not None:
            session.start(session.settings.replace())
        elif attendance.left is not None and not attendance.left.is_over:
            attendance.follow(attendance.left)


def _picture_of(code: str) -> str:
    """Draw the address of a class as a phone's camera reads it (HTML); say what keeps it away."""
    address = address_for_others()
    if not address:
        name = names()[0]
        port = urlsplit(_here()).port or 80
        return (
            "<p>Others cannot open <b>localhost</b>, which is each machine's own name, and this "
            "server takes no other. For a class start it with the name of this machine, as "
            f"<code>BOKEH_ALLOW_WS_ORIGIN={escape(name)}:{port}</code>, and open "
            f"<b>http://{escape(name)}:{port}</b>.</p>"
        )
    address += f"?{CLASS}={code}"
    drawn = segno.make(address, error="m").svg_inline(scale=6, light="#fff", omitsize=True)
    return f"<details><summary>QR code</summary>{drawn}<p>{escape(address)}</p></details>"


def address_for_others() -> str:
    """Give the address of this page that other machines reach, without its query, or nothing."""
    here = urlsplit(_here())
    if not is_local(here.hostname or ""):
        return here._replace(query="", fragment="").geturl()
    port = f":{here.port}" if here.port else ""
    open_ones = (f"{name}{port}" for name in names() if accepts(f"{name}{port}"))
    found = next(open_ones, "")
    return here._replace(netloc=found, query="", fragment="").geturl() if found else ""


def is_local(host: str) -> bool:
    """Tell whether a name is what every machine calls itself."""
    return host in ("localhost", "::1") or host.startswith("127.")


@cache
def names() -> tuple[str, ...]:
    """Give what others call this machine: its name, and its address in the network."""
    found = [socket.gethostname()]
    with suppress(OSError), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        # Nothing is sent: it only chooses the way that a packet would take.
        probe.connect((DOCUMENTATION, 9))
        found.append(probe.getsockname()[0])
    return tuple(name for name in found if not is_local(name)) or ("THIS-MACHINE",)


def _here() -> str:
    return pn.state.location.href if pn.state.location else ""
