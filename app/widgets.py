"""Widgets used by several parts of the page."""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from html import escape
from pathlib import Path
from typing import Any
from urllib.parse import quote

import panel as pn
import panel_material_ui as pmui
import param
from panel.models import HTML

from app.templates import html
from solver.settings.scene import Icon

SHEET = (Path(__file__).parents[1] / "static" / "widgets.css").read_text(
    encoding="utf-8"
)

GLOSSARY = (Path(__file__).parent / "glossary.md").read_text(encoding="utf-8")
"""Keys, words and plots of the page, in Markdown."""
ROW = re.compile(r"^\| (.+) \| (.+) \|$", re.MULTILINE)

FOCUS = {"&:focus-within": {"outline": "2px solid", "outlineOffset": "2px"}}
"""Look of a file button while keys go to it: its focus lies on a field within it."""

WRAPPED = {
    "& .MuiDialogTitle-root": {"flex": "1 1 0", "minWidth": 0},
    # In the dark it would be nearly black.
    "& .MuiDialogTitle-root + .MuiIconButton-root": {"color": "inherit"},
}
"""Look of a dialog whose title wraps: on a phone it would push the button that closes
the dialog out of sight."""


def _meanings() -> dict[str, str]:
    """Meanings of the glossary by word."""
    meanings = {}
    for words, meaning in ROW.findall(GLOSSARY):
        for word in words.split(", "):
            meanings[word] = meaning
    return meanings


MEANINGS = _meanings()


@contextmanager
def rebuilt() -> Iterator[None]:
    """Change much of what stands on a page in one message.

    After each change Bokeh goes through all models of the page, but here once.
    """
    document = pn.state.curdoc
    with pn.io.hold(document), document.models.freeze():
        yield


def looks(*roles: str) -> dict[str, Any]:
    """Look of a widget in roles that `widgets.css` knows."""
    rules = [
        rule
        for rule in SHEET.split("\n\n")
        if any(f":host(.{role})" in rule for role in roles)
    ]
    return {"css_classes": list(roles), "stylesheets": ["\n".join(rules)]}


class PlainText(pn.viewable.Viewer):
    """Text that is shown literally, without markup.

    All texts from a file, an address or a class are shown by this. Markdown, HTML and
    `Str` panes, and the `Alert`, `Typography` and `StaticText` of panel-material-ui,
    would run scripts in them. The text may change as soon as it is in sight, while a
    component of panel-material-ui begins to listen once it is painted, and loses
    changes before.
    """

    object = param.String(doc="The text.")

    def __init__(self, **look: Any) -> None:
        super().__init__()
        self._pane = pn.pane.HTML("", **(looks("line") | look))

    @param.depends("object", watch=True)
    def _show(self) -> None:
        self._pane.object = escape(self.object)

    def __panel__(self) -> pn.pane.HTML:
        return self._pane


def changing_text(**look: Any) -> HTML:
    """Words that change with each picture, as escaped text.

    It is the model of Panel's pane, of which all properties would be set each time.
    """
    return HTML(disable_math=True, **look)


def button(label: str, act: Callable[[], object], **look: Any) -> pmui.Button:
    """A small button."""
    look = {"size": "small", **look}
    return pmui.Button(label=label, on_click=lambda event: act(), **look)


def wrapped(*objects: Any, **look: Any) -> pn.Row:
    """A row that wraps: simpler than a `FlexBox`."""
    return pn.Row(*objects, margin=0, **{"styles": {"flex-wrap": "wrap"}, **look})


def up_to(width: int) -> dict[str, Any]:
    """CSS width of a part: px, or less on a narrow screen."""
    return {"sizing_mode": "stretch_width", "max_width": width}


def dialog(title: str, *objects: Any, **look: Any) -> pmui.Dialog:
    """A dialog that a click outside closes, too."""
    return pmui.Dialog(
        *objects,
        title=title,
        show_close_button=True,
        close_on_click=True,
        sx=WRAPPED,
        **look,
    )


def file_button(
    label: str, accept: str, take: Callable[[bytes, str], object], **look: Any
) -> pmui.FileInput:
    """A button to open a file: calls a function with content and name.

    It keeps its label: a message tells what became of the file.
    """
    file = pmui.FileInput(
        label=label, uploaded_label=label, accept=accept, sx=FOCUS, **look
    )

    def wait() -> None:
        """Wait for the next file, which may be the same once more, or an empty one.

        Of an empty file the browser sends neither name nor content.
        """
        file.param.update(value=b"", filename=None)

    def pass_on(event: Any) -> None:
        if event.new == b"":
            return
        name = file.filename or "The file"
        wait()
        take(event.new or b"", name)

    wait()
    file.param.watch(pass_on, "value")
    return file


def download(
    label: str, filename: str, make: Callable[[], str | bytes], **look: Any
) -> Any:
    """A button to save a text, which a function makes when the button is pressed."""

    def data() -> io.BytesIO:
        content = make()
        if isinstance(content, str):
            content = content.encode()
        return io.BytesIO(content)

    file = pmui.FileDownload(label=label, filename=filename, callback=data, **look)
    # Its constructor warns of a variant, whatever it is.
    file.variant = "outlined"
    return file


def mask_of(emblem: Icon) -> dict[str, str]:
    """A small picture as a CSS mask in the colour of its text."""
    picture = quote(html("icon.svg", icon=emblem))
    return {"mask": f'url("data:image/svg+xml,{picture}") center / contain no-repeat'}
