"""What a page says of the class that it leads or follows, and its one button there."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from urllib.parse import urlsplit

import panel as pn
import segno

from app.address import CLASS
from app.panes import button, column, text
from app.session import Session


class Banner:
    """A line above the run; it is not there without a class.

    Parameters
    ----------
    session
        Of the page.
    rearrange
        Called when other settings or views are to be shown.

    Attributes
    ----------
    view
        What stands on the page.
    """

    def __init__(self, session: Session, rearrange: Callable[[], None]) -> None:
        self._session = session
        self._rearrange = rearrange
        self._said = "", ""
        self._views: tuple[str, ...] = ()
        self._words = text(role="class", sizing_mode="stretch_width")
        self._code = text(role="code", visible=False)
        self._button = button("", "group", self._press, variant="outlined")
        line = pn.FlexBox(self._words, self._button, align_items="center", flex_wrap="nowrap")
        self.view = column(line, self._code, role="banner", visible=False)

    def catch_up(self) -> None:
        """Follow the class to other settings or views, and say how it stands."""
        session, room = self._session, self._session.attendance.follows
        if room is not None and room.settings is not session.settings:
            session.start(room.settings)
            self._rearrange()
        elif room is not None and room.views != self._views:
            self._rearrange()
        self._views = room.views if room else ()
        self._say()

    def _say(self) -> None:
        attendance = self._session.attendance
        follows, left = attendance.follows, attendance.left
        words, label = "", ""
        if self._code.visible != (attendance.leads is not None):
            code = attendance.leads.code if attendance.leads is not None else ""
            self._code.param.update(visible=bool(code), object=_picture_of(code) if code else "")
        if attendance.leads is not None:
            code, count = attendance.leads.code, attendance.leads.present
            words = (
                f"Class <b>{code}</b>: whoever opens this address with <b>?{CLASS}={code}</b> sees "
                f"what you see. {count} {'follows' if count == 1 else 'follow'}."
            )
            label = "End the class"
        elif follows is not None:
            words = f"You follow class <b>{escape(follows.code)}</b>. " + (
                "It has ended." if follows.is_over else "Change anything to go on by yourself."
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
            session.start(attendance.left.settings)
        self._rearrange()
        self._say()


def _picture_of(code: str) -> str:
    """Draw the address of a class as a phone's camera reads it (HTML)."""
    here = urlsplit(pn.state.location.href if pn.state.location else "")
    address = here._replace(query=f"{CLASS}={code}", fragment="").geturl()
    drawn = segno.make(address, error="m").svg_inline(scale=6, light="#fff", omitsize=True)
    return f"<details><summary>QR code</summary>{drawn}<p>{escape(address)}</p></details>"
