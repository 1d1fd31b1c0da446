"""What the tabs of long reports share: ask, watch, cancel, read, and take away.

What is read is the page that the command line writes, as it grows.
"""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from io import BytesIO
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.errand import Errand, Found


class Report:
    """A tab on which a report is asked for, watched while it is made, and read.

    A subclass says what is asked (`_ask`) and what can be chosen (`_choices`).

    Parameters
    ----------
    errand
        The state that it shows.
    style
        Style sheet.
    title, words
        What the report is, and what asking for it means for the page.

    Attributes
    ----------
    view
        What stands on the page; it is empty until `open`.
    """

    def __init__(self, errand: Errand, style: str, title: str, words: str) -> None:
        self._errand = errand
        self._style = style
        self._words = f"<h2>{escape(title)}</h2><p>{escape(words)}</p>"
        self._shown: tuple[Found | None, bool] = None, False
        self._newest: Found | None = None
        self._progress = self._text("", role="progress")
        self._heading, self._sheet = self._text(""), self._text("")
        self._past = pmui.Select(label="Shown", options=[], width=260, size="small", visible=False)
        self._past.param.watch(lambda event: self._put(event.new), "value")
        self._files = self._row(margin=(0, 6, 8, 6))
        self._card = self._column(
            self._heading, self._sheet, self._files, role="card paper", visible=False
        )
        self.view = self._column(margin=(4, 10), visible=False)

    def open(self) -> None:
        """Show the report; nothing is computed before somebody asks."""
        if not self.view.objects:
            top = self._column(self._text(self._words), *self._bar(), role="card paper")
            top.margin = (0, 0, 12, 0)
            self.view[:] = [top, self._card]
        self._refresh()

    def refresh(self) -> None:
        """Follow the errand, as soon as somebody looks."""
        if self.view.visible:
            self._refresh()

    def _ask(self) -> None:
        raise NotImplementedError

    def _choices(self) -> list[Any]:
        return []

    def _refusal(self) -> str:
        """Say why it cannot be asked for at present, if so."""
        return ""

    def _found(self) -> list[Found]:
        """Give the reports that are whole, oldest first."""
        return list(self._errand.found)

    def _title(self, found: Found) -> str:
        """Say what stands above a report that is whole (HTML)."""
        return ""

    def _bar(self) -> list[Any]:
        self._start = pmui.Button(label="Start", icon="play_arrow", size="small", color="primary")
        self._cancel = pmui.Button(
            label="Cancel", icon="stop", size="small", variant="outlined", visible=False
        )
        self._start.on_click(lambda event: self._on_start())
        self._cancel.on_click(lambda event: self._on_cancel())
        choices = self._choices()
        row = self._row(self._start, self._cancel, *choices, self._past, align_items="center")
        return [row, self._progress]

    def _on_start(self) -> None:
        self._ask()
        self._refresh()

    def _on_cancel(self) -> None:
        self._errand.cancel()
        self._refresh()

    def _refresh(self) -> None:
        errand, refusal = self._errand, self._refusal()
        self._start.disabled = errand.is_busy or bool(refusal)
        self._cancel.visible = errand.is_busy
        waiting = f"<b>{escape(refusal)}</b>" if refusal and not errand.is_busy else ""
        self._progress.object = waiting or progress(errand)
        found = self._found()
        options = {f"{number}: {one.title}": one for number, one in enumerate(found, start=1)}
        if found and options != self._past.options:
            self._past.param.update(options=options, value=found[-1], visible=len(found) > 1)
        newest = errand.growing if errand.is_busy or not found else found[-1]
        if newest is not self._newest and newest.html:
            self._newest = newest
            self._put(newest)

    def _put(self, found: Found) -> None:
        """Show one report, with its files if it is whole."""
        is_whole = found in self._found()
        if (found, is_whole) == self._shown:
            return
        self._shown = found, is_whole
        self._heading.object = self._title(found) if is_whole else ""
        self._sheet.object = found.html
        self._files[:] = downloads(found.files) if is_whole else []
        self._card.visible = True

    def _column(self, *parts: Any, role: str = "paper", **options: Any) -> pn.Column:
        """Put parts one below the other, as high as they are."""
        return pn.Column(
            *parts,
            css_classes=role.split(),
            stylesheets=[self._style],
            sizing_mode="stretch_width",
            **{"margin": 0, **options},
        )

    def _row(self, *parts: Any, **options: Any) -> pn.FlexBox:
        options = {"margin": (0, 6), **options}
        return pn.FlexBox(*parts, flex_wrap="wrap", sizing_mode="stretch_width", **options)

    def _text(self, html: str, role: str = "report") -> pn.pane.HTML:
        return pn.pane.HTML(
            html,
            css_classes=[role],
            stylesheets=[self._style],
            sizing_mode="stretch_width",
            margin=(6, 14),
        )


def downloads(files: Mapping[str, bytes]) -> list[Any]:
    """Give a button for each file."""
    return [
        pmui.FileDownload(
            label=name,
            callback=lambda data=data: BytesIO(data),
            filename=name,
            size="small",
        )
        for name, data in files.items()
    ]


def progress(errand: Errand) -> str:
    """Say how far a report is, or why it came to nothing (HTML)."""
    if errand.is_busy:
        share = f"{100.0 * errand.share:.0f}"
        bar = (
            f'<span class="bar" role="progressbar" aria-valuenow="{share}">'
            f'<i style="width: {share}%"></i></span>'
        )
        return f"{bar} {escape(errand.doing)} <small>({escape(errand.title)})</small>"
    return f"<b>{escape(errand.notice)}</b>" if errand.notice else ""
