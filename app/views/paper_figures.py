"""The paper's figures, computed by the engine and drawn once: a tab of the page."""

from __future__ import annotations

from collections import deque
from html import escape
from typing import Any

import panel as pn

from app.errand import Errand
from app.views.panels import plot
from app.views.report import Report
from app.worker.studies import figures_of_the_paper
from solver.study.figure_data import Panel, PaperFigure

TITLE = "The paper's figures"
WORDS = (
    "Figs. 3 to 8 again, each with the paper's claim and the numbers that bear it out or do not. "
    "They take a few seconds, once for all pages."
)
COMPUTED: list[PaperFigure] = []
"""Of this server, once a page has had them computed: they depend on no setting."""


class PaperFigures(Report):
    """The figures with their claims; they are asked for when they are first looked at.

    Parameters
    ----------
    errand, style
        As for `Report`.
    """

    def __init__(self, errand: Errand, style: str) -> None:
        super().__init__(errand, style, TITLE, WORDS)
        self._owed: deque[tuple[pn.FlexBox, Panel]] = deque()

    def open(self) -> None:
        """Show the figures; have them computed if nobody has."""
        is_first = not self.view.objects
        super().open()
        if is_first and not COMPUTED:
            self._on_start()

    def _choices(self) -> list[Any]:
        self._start.label = "Try again"
        return []

    def _ask(self) -> None:
        self._errand.ask("once for all pages", figures_of_the_paper)

    def _refresh(self) -> None:
        if COMPUTED:
            # What waits on the bench was asked for before another page had them.
            self._errand.cancel()
        elif self._errand.last is not None:
            COMPUTED[:] = self._errand.last.result
        super()._refresh()
        self._start.visible = not (COMPUTED or self._errand.is_busy)
        self._progress.visible = not COMPUTED

    def _show(self) -> None:
        """Add what is new: computed again, the first figures are the same."""
        figures = COMPUTED or self._errand.parts
        idle = not self._owed
        for figure in figures[len(self._results) :]:
            row = pn.FlexBox(sizing_mode="stretch_width")
            self._results.append(self._card(self._text(_words(figure)), row))
            self._owed += [(row, panel) for panel in figure.panels]
        if idle:
            self._draw()

    def _draw(self) -> None:
        """Draw one pair of axes, and the others later: all at once, every page would stand still.

        One costs the server some 0.2 s.
        """
        if not self._owed:
            return
        row, panel = self._owed.popleft()
        row.append(plot(panel))
        if pn.state.curdoc is None:
            self._draw()
        else:
            pn.state.curdoc.add_next_tick_callback(self._draw)


def _words(figure: PaperFigure) -> str:
    """Say what a figure shows, and what is found in it (HTML)."""
    findings = "".join(
        f"<li>{'✓' if part.holds else '✗'} {escape(part.text)}</li>" for part in figure.findings
    )
    return (
        f"<h2>Fig. {figure.number}: {escape(figure.title)}</h2>"
        f"<p><b>The paper's claim:</b> {escape(figure.claim)} "
        f"<b>Here it {escape(figure.verdict)}.</b></p><ul>{findings}</ul>"
        f"<p class='caption'>{escape(figure.caption)}</p>"
    )
