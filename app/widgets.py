"""Widgets that several parts of the page have alike."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui


def button(label: str, act: Callable[[], object], **look: Any) -> pmui.Button:
    """A small button."""
    look = {"size": "small", **look}
    return pmui.Button(label=label, on_click=lambda event: act(), **look)


def wrapped(*objects: Any, **look: Any) -> pn.Row:
    """A row that goes on in the next line where there is no room: simpler than a `FlexBox`."""
    return pn.Row(*objects, margin=0, **{"styles": {"flex-wrap": "wrap"}, **look})


def dialog(title: str, *objects: Any, **look: Any) -> pmui.Dialog:
    """A dialog that a click beside it closes, too."""
    return pmui.Dialog(*objects, title=title, show_close_button=True, close_on_click=True, **look)


def download(label: str, filename: str, make: Callable[[], str | bytes], **look: Any) -> Any:
    """A button that saves what a function makes once it is pressed."""

    def data() -> io.BytesIO:
        content = make()
        return io.BytesIO(content if isinstance(content, bytes) else content.encode())

    made = pmui.FileDownload(label=label, filename=filename, callback=data, **look)
    # Its constructor warns of a variant, whatever it is.
    made.variant = "outlined"
    return made
