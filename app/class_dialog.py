"""The line of a class, and the dialog in which one begins or joins it."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui
import segno

from app.addresses import address_for_others, how_to_open
from app.classroom import CLASSROOMS, Member


class ClassDialog:
    """Begins a class and shows its code, or joins one.

    Parameters
    ----------
    member
        The part of the page in a class.

    Attributes
    ----------
    view
        The line that stands on the page while it is in a class, or has left one.
    dialog
        What the header's button opens.
    """

    def __init__(self, member: Member) -> None:
        self._member = member
        self._message = pn.pane.HTML(margin=(4, 8))
        self._act = _button("", self._do, variant="text")
        self._code = _button("Code", lambda: self.open(), variant="text")
        self.view = pn.Row(
            self._message,
            self._act,
            self._code,
            visible=False,
            margin=0,
            align="center",
            css_classes=["class"],
        )
        self.dialog = pmui.Dialog(
            title="A class", width_option="sm", show_close_button=True, close_on_click=True
        )
        member.param.watch(lambda event: self._say(), "message")
        self._say()

    def open(self) -> None:
        """Open the dialog."""
        self.dialog[:] = self._led() if self._member.leads else self._offered()
        self.dialog.open = True

    def _offered(self) -> list[Any]:
        # Models that were taken off the page are not put on it again.
        self._field = pmui.TextInput(label="Code", max_length=4, size="small", width=120)
        self._refusal = pn.pane.Markdown(margin=0)
        begin = _button("Begin a class", self._begin)
        join = _button("Join", self._join, variant="outlined")
        return [
            pn.pane.Markdown("Whoever joins a class sees what its leader sees, and predicts too."),
            begin,
            pn.Row(self._field, join, align="end", margin=(12, 0)),
            self._refusal,
        ]

    def _led(self) -> list[Any]:
        room = self._member.room
        assert room is not None
        large = pn.pane.HTML(f'<div style="font-size: 64px; letter-spacing: 8px">{room.code}</div>')
        address = address_for_others()
        if not address:
            return [large, pn.pane.HTML(how_to_open()), _button("End the class", self._end)]
        link = f"{address}?class={room.code}"
        svg = segno.make(link, error="m").svg_inline(scale=6, light="#fff", omitsize=True)
        picture = f'<div style="width: 260px">{svg}</div><p>{escape(link)}</p>'
        return [large, pn.pane.HTML(picture), _button("End the class", self._end)]

    def _begin(self) -> None:
        self._member.begin()
        self.open()

    def _join(self) -> None:
        code = self._field.value_input or self._field.value
        if CLASSROOMS.find(code) is None:
            self._refusal.object = f"There is no class {code[:4] or 'without a code'}."
            return
        self._member.leave()
        self._member.enter(code)
        self.dialog.open = False

    def _end(self) -> None:
        self._member.end()
        self.dialog.open = False

    def _do(self) -> None:
        member = self._member
        if member.leads:
            self._end()
        elif member.follows:
            member.leave()
        else:
            member.follow_again()

    def _say(self) -> None:
        member = self._member
        can_return = member.left is not None and not member.left.is_over
        label = "Follow again" if can_return else ""
        if member.leads or member.follows:
            label = "End the class" if member.leads else "Go on by myself"
        self._message.object = escape(member.message)
        self._act.param.update(label=label or " ", visible=bool(label))
        self._code.visible = member.leads
        self.view.visible = bool(member.message)


def _button(label: str, does: Callable[[], None], **more: Any) -> pmui.Button:
    look = {"variant": "contained", "size": "small", "sx": {"textTransform": "none"}, **more}
    return pmui.Button(label=label, on_click=lambda event: does(), **look)
