"""What the tabs of long reports share: ask, watch, cancel, read, and take away."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from io import BytesIO
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.errand import Errand


class Report:
    """A tab on which a report is asked for, watched while it is made, and read.

    A subclass says what is asked (`_ask`), what can be chosen (`_choices`), and shows what came
    of it (`_show`).

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
        self._heading = f"<h2>{escape(title)}</h2><p>{escape(words)}</p>"
        self._results = self._column()
        self._progress = self._text("", role="progress")
        self.view = self._column(margin=(4, 10), visible=False)

    def open(self) -> None:
        """Show the report; nothing is computed before somebody asks."""
        if not self.view.objects:
            self.view[:] = [self._card(self._text(self._heading), *self._bar()), self._results]
        self._refresh()

    def refresh(self) -> None:
        """Follow the errand, as soon as somebody looks."""
        if self.view.visible:
            self._refresh()

    def _ask(self) -> None:
        raise NotImplementedError

    def _choices(self) -> list[Any]:
        raise NotImplementedError

    def _show(self) -> None:
        raise NotImplementedError

    def _refusal(self) -> str:
        """Say why it cannot be asked for at present, if so."""
        return ""

    def _bar(self) -> list[Any]:
        self._start = pmui.Button(label="Start", icon="play_arrow", size="small", color="primary")
        self._cancel = pmui.Button(
            label="Cancel", icon="stop", size="small", variant="outlined", visible=False
        )
        self._start.on_click(lambda event: self._on_start())
        self._cancel.on_click(lambda event: self._on_cancel())
        row = pn.FlexBox(
            self._start,
            self._cancel,
            *self._choices(),
            align_items="center",
            flex_wrap="wrap",
            sizing_mode="stretch_width",
            margin=(0, 6),
        )
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
        self._show()

    def _column(self, *parts: Any, role: str = "paper", **options: Any) -> pn.Column:
        """Put parts one below the other, as high as they are."""
        return pn.Column(
            *parts,
            css_classes=role.split(),
            stylesheets=[self._style],
            sizing_mode="stretch_width",
            **{"margin": 0, **options},
        )

    def _card(self, *parts: Any) -> pn.Column:
        return self._column(*parts, role="card paper", margin=(0, 0, 12, 0))

    def _text(self, html: str, role: str = "report") -> pn.pane.HTML:
        return pn.pane.HTML(
            html,
            css_classes=[role],
            stylesheets=[self._style],
            sizing_mode="stretch_width",
            margin=(6, 14),
        )

    def _downloads(self, files: Mapping[str, bytes]) -> pn.FlexBox:
        """Give a button for each file."""
        return pn.FlexBox(
            *(
                pmui.FileDownload(
                    label=name,
                    callback=lambda data=data: BytesIO(data),
                    filename=name,
                    size="small",
                    variant="outlined",
                )
                for name, data in files.items()
            ),
            flex_wrap="wrap",
            sizing_mode="stretch_width",
            margin=(0, 6, 8, 6),
        )


def progress(errand: Errand) -> str:
    """Say how far a job is, or why it brought nothing (HTML)."""
    if errand.is_busy:
        share = f"{100.0 * errand.share:.0f}"
        bar = (
            f'<span class="bar" role="progressbar" aria-valuenow="{share}">'
            f'<i style="width: {share}%"></i></span>'
        )
        return f"{bar} {escape(errand.doing)} <small>({escape(errand.title)})</small>"
    return f"<b>{escape(errand.notice)}</b>" if errand.notice else ""


def bullets(lines: Sequence[str]) -> str:
    """Write sentences as a list (HTML)."""
    return "<ul>" + "".join(f"<li>{escape(line)}</li>" for line in lines) + "</ul>"


def table(rows: Sequence[Sequence[str]]) -> str:
    """Write a table whose first row is its head (HTML)."""
    head, *rest = rows
    heads = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    body = "".join(
        f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rest
    )
    return (
        f'<div class="scroll"><table><thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>'
        "</div>"
    )
