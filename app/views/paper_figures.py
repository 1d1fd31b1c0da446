"""The paper's figures, computed by the engine and drawn once: a tab of the page."""

from __future__ import annotations

import threading
from concurrent.futures import Future
from functools import partial
from html import escape
from typing import Any

import panel as pn

from app.views.panels import plot
from app.worker.job import Broke, Done, Job, Said, Work
from app.worker.studies import figures_of_the_paper
from solver.study.figure_data import PaperFigure

WORK: Work = figures_of_the_paper
_lock = threading.Lock()
_computed: Future[list[PaperFigure]] | None = None


class PaperFigures:
    """The figures with their claims; they are computed when first looked at, once per server.

    Parameters
    ----------
    style
        Style sheet.

    Attributes
    ----------
    view
        What stands on the page.
    """

    def __init__(self, style: str) -> None:
        self._style = style
        self._document: Any = None
        self.view = pn.Column(sizing_mode="stretch_width", margin=(4, 10), visible=False)

    def open(self) -> None:
        """Show the figures; compute them first if nobody has."""
        if self.view.objects:
            return
        self.view[:] = [self._text("Computing the paper's figures: a few seconds, once.")]
        self._document = pn.state.curdoc
        compute().add_done_callback(self._arrived)

    def _arrived(self, found: Future[list[PaperFigure]]) -> None:
        """Go back to the page's own event loop: this is called on another thread."""
        if self._document is None:
            self._show(found)
        elif self._document.session_context is not None:
            self._document.add_next_tick_callback(partial(self._show, found))

    def _show(self, found: Future[list[PaperFigure]]) -> None:
        failure = found.exception()
        if failure is not None:
            self.view[:] = []
            self.view.append(self._text(f"The figures could not be computed: {failure}"))
            return
        self.view[:] = [self._card(figure) for figure in found.result()]

    def _card(self, figure: PaperFigure) -> pn.Column:
        findings = "".join(
            f"<li>{'✓' if part.holds else '✗'} {escape(part.text)}</li>" for part in figure.findings
        )
        words = (
            f"<h2>Fig. {figure.number}: {escape(figure.title)}</h2>"
            f"<p><b>The paper's claim:</b> {escape(figure.claim)} "
            f"<b>Here it {escape(figure.verdict)}.</b></p><ul>{findings}</ul>"
            f"<p class='caption'>{escape(figure.caption)}</p>"
        )
        panels = pn.FlexBox(*(plot(panel) for panel in figure.panels), sizing_mode="stretch_width")
        return pn.Column(
            self._text(words),
            panels,
            css_classes=["card", "paper"],
            stylesheets=[self._style],
            sizing_mode="stretch_width",
            margin=(0, 0, 12, 0),
        )

    def _text(self, html: str) -> pn.pane.HTML:
        return pn.pane.HTML(
            html,
            css_classes=["paper-text"],
            stylesheets=[self._style],
            sizing_mode="stretch_width",
            margin=(6, 14),
        )


def compute() -> Future[list[PaperFigure]]:
    """Start to compute the figures, unless that was done already.

    In a process of its own, so that no page stands still meanwhile. A failure is not kept: the
    next page that asks tries again.
    """
    global _computed
    with _lock:
        if _computed is None or (_computed.done() and _computed.exception() is not None):
            _computed = Future()
            Job(WORK, partial(_fill, _computed)).begin()
        return _computed


def _fill(future: Future[list[PaperFigure]], said: Said) -> None:
    if isinstance(said, Done):
        future.set_result(said.result)
    elif isinstance(said, Broke):
        future.set_exception(RuntimeError(said.reason))
