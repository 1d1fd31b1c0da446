"""The dialog to begin or join a class, and the line about the class on the page."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui
import segno

from app.classroom import ClassMember, find, no_class
from app.server import address_for_others, port
from app.templates import html
from app.widgets import PlainText, button, dialog


class ClassDialog:
    """Dialog that begins a class and shows its code, or joins a class.

    `view` is the line on the page while it is in a class, or has left one; `dialog` is
    opened by a button in the header. `visit` has the browser open the page of a class,
    by its code: whoever joins has a page that was made for what the class shows.
    """

    def __init__(self, member: ClassMember, visit: Callable[[str], None]) -> None:
        self._member = member
        self._visit = visit
        self._message = PlainText(margin=(4, 8))
        self._again = button("Follow again", self._return, variant="text")
        self.view = pn.Row(
            self._message,
            self._again,
            visible=False,
            margin=0,
            align="center",
            css_classes=["class"],
        )
        self.dialog = dialog("A class", width_option="sm")
        member.param.watch(lambda event: self._show(), "message")

    def open(self) -> None:
        """Open the dialog."""
        # It is filled again: models that were taken off the page cannot come back.
        if self._member.leads:
            self.dialog[:] = self._led()
        else:
            self.dialog[:] = self._offered()
        self.dialog.open = True

    def _offered(self) -> list[Any]:
        self._field = pmui.TextInput(
            label="Code", max_length=4, size="small", width=120
        )
        join = button("Join", self._join, variant="outlined")
        return [
            pn.pane.Markdown(
                "Whoever joins a class sees what its leader sees, and predicts too."
            ),
            button("Begin a class", self._begin),
            pn.Row(self._field, join, align="end", margin=(12, 0)),
        ]

    def _led(self) -> list[Any]:
        code = self._member.room.code
        address = address_for_others()
        link = ""
        picture = ""
        if address:
            link = f"{address}?class={code}"
            picture = segno.make(link, error="m").svg_inline(
                scale=6, light="#fff", omitsize=True
            )
        text = html(
            "class_dialog.html", code=code, link=link, picture=picture, port=port()
        )
        return [pn.pane.HTML(text), button("End the class", self._leave)]

    def _begin(self) -> None:
        self._member.begin()
        self.open()

    def _join(self) -> None:
        code = self._field.value_input or self._field.value
        refusal = "Write a code."
        if code:
            refusal = self._enter(code)
        if refusal:
            self._field.param.update(error_state=True, helper_text=refusal)

    def _return(self) -> None:
        if refusal := self._enter(self._member.left):
            self._member.message = refusal

    def _enter(self, code: str) -> str:
        """Open the page of a class; return a refusal if there is no such class."""
        room = find(code)
        if room is None:
            return no_class(code)
        self._visit(room.code)
        return ""

    def _leave(self) -> None:
        self._member.leave()
        self.dialog.open = False

    def _show(self) -> None:
        member = self._member
        self._message.object = member.message
        self._again.visible = member.room is None and bool(member.left)
        self.view.visible = bool(member.message)
