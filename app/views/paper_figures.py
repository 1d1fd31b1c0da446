"""The paper's figures, computed by the engine and drawn once: the page's second tab."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import threading
from concurrent.futures import Future
from functools import partial
from html import escape
from pathlib import Path
from typing import Any

import holoviews as hv
import numpy as np
import panel as pn

from app.views.drawing import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from app.worker.member import ONE_THREAD
from solver.study.figure_data import Curve, Panel, PaperFigure

HUES = (GREY, BLUE, ORANGE, GREEN, PURPLE, VERMILION, SKY)
DASHES = {"solid": "solid", "dashed": "dashed", "dotted": "dotted", "points": "solid"}
MOST_LABELS = 7

ROOT = Path(__file__).resolve().parents[2]
PATIENCE = 120.0
PROGRAM = """
import pickle, sys
from solver.study.paper_figures import paper_figures
pickle.dump(paper_figures(), sys.stdout.buffer)
"""

hv.extension("bokeh")
# Where there is no graphics card, canvas is faster, and its lines are clean.
hv.renderer("bokeh").webgl = False

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
        panels = pn.FlexBox(
            *(self._plot(panel) for panel in figure.panels), sizing_mode="stretch_width"
        )
        return pn.Column(
            self._text(words),
            panels,
            css_classes=["card", "paper"],
            stylesheets=[self._style],
            sizing_mode="stretch_width",
            margin=(0, 0, 12, 0),
        )

    def _plot(self, panel: Panel) -> pn.pane.HoloViews:
        return pn.pane.HoloViews(
            overlay(panel),
            margin=6,
            linked_axes=False,
            sizing_mode="stretch_width",
            styles={"flex": "1 1 340px"},
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

    A failure is not kept: the next page that asks tries again.
    """
    global _computed
    with _lock:
        if _computed is None or (_computed.done() and _computed.exception() is not None):
            _computed = Future()
            threading.Thread(target=_fill, args=(_computed,), daemon=True).start()
        return _computed


def _fill(future: Future[list[PaperFigure]]) -> None:
    """Compute in a process of its own, which ends by itself: no page stands still meanwhile."""
    try:
        answer = subprocess.run(
            [sys.executable, "-c", PROGRAM],
            cwd=ROOT,
            env={**os.environ, **ONE_THREAD},
            capture_output=True,
            timeout=PATIENCE,
            check=True,
        )
        future.set_result(pickle.loads(answer.stdout))
    except Exception as failure:
        future.set_exception(failure)


def overlay(panel: Panel) -> hv.Overlay:
    """Draw one pair of axes."""
    parts: list[Any] = []
    for curve in panel.curves:
        parts += _drawn(panel, curve)
    made = hv.Overlay(parts).opts(
        responsive=True,
        height=360,
        min_width=280,
        title=panel.title,
        logx=panel.x.logarithmic,
        logy=panel.y.logarithmic,
        xlim=panel.x.limits or (None, None),
        ylim=panel.y.limits or (None, None),
        xlabel=panel.x.label,
        ylabel=panel.y.label,
        legend_position="bottom",
        legend_cols=2,
        toolbar=None,
        show_grid=True,
        fontsize={"title": 11, "labels": 10, "legend": 9, "xticks": 9, "yticks": 9},
    )
    if panel.x.whole:
        last = max(float(curve.x.max()) for curve in panel.curves)
        if last <= MOST_LABELS:
            made = made.opts(xticks=list(range(1, int(last) + 1)))
    return made


def _drawn(panel: Panel, curve: Curve) -> list[Any]:
    dimensions = {"kdims": [panel.x.quantity], "vdims": [panel.y.quantity]}
    color = HUES[curve.hue % len(HUES)]
    values = np.where(curve.y > 0.0, curve.y, np.nan) if panel.y.logarithmic else curve.y
    line = hv.Curve((curve.x, values), label=curve.label, **dimensions).opts(
        color=color,
        line_dash=DASHES[curve.line],
        line_width=1.0 if curve.line == "points" else 2.2,
    )
    if curve.line != "points":
        return [line]
    points = hv.Scatter((curve.x, values), label=curve.label, **dimensions)
    return [line, points.opts(color=color, size=6)]
