"""Indicators beside true errors, over iterations."""

from __future__ import annotations

import numpy as np
from bokeh.models import Range1d, Span

from app.recording import columns
from app.views.drawing import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    VERMILION,
    Picture,
    decades,
    empty,
    make_figure,
    mark_decades,
    round_up,
    set_range,
)
from app.views.legend import Key
from app.worker.shown import has_reference
from solver.latin import Record
from solver.settings import Settings

CURVES = (
    ("indicator", GREY, "η", "dashed"),
    ("behaviour", PURPLE, "k-free indicator", "dashed"),
    ("estimated_error", ORANGE, "estimated force error", "dashed"),
    ("error_displacement", GREEN, "displacement error", "solid"),
    ("error_force", BLUE, "force error", "solid"),
)
FLOOR = 1e-18
LEAST_SPAN = (1e-2, 10.0)
"""What is shown at least; a curve beyond it widens it by whole decades."""
ERRORS = 3
"""First of them that is an error, and needs a reference."""


KEYS = tuple(
    Key(color, "line" if dash == "solid" else "dashed", text) for _, color, text, dash in CURVES
)


class Convergence:
    """What the method knows of itself (dashed), and how far it really is (solid).

    The ghost is the run before, or with separated bases, the full linear stage beside them.
    """

    name = "Convergence"
    watches = ""
    keys = KEYS

    def __init__(self) -> None:
        self.figure = make_figure(
            "Iteration",
            "Indicator, error",
            x_range=Range1d(0, 20),
            y_range=Range1d(1e-4, 10),
            y_axis_type="log",
        )
        names = [name for name, *_ in CURVES]
        self._now = empty("iteration", *names)
        self._ghost = empty("iteration", *names)
        self._ticket = -1
        self._count = 0
        self._count_beside = 0
        self._lowest, self._highest = LEAST_SPAN
        made = self.figure
        for name, color, _, dash in CURVES:
            if dash == "solid":
                made.line(
                    "iteration",
                    name,
                    source=self._ghost,
                    line_color=color,
                    line_alpha=0.35,
                    line_width=2,
                )
            made.line(
                "iteration",
                name,
                source=self._now,
                line_color=color,
                line_dash=dash,
                line_width=2.5,
            )
        self._shown = Span(location=0, dimension="height", line_color=VERMILION, line_width=2)
        made.add_layout(self._shown)

    def applies(self, settings: Settings) -> bool:
        """Every run converges, or not."""
        return True

    def draw(self, picture: Picture) -> None:
        """Add the new records."""
        run = picture.run
        if run.ticket != self._ticket or len(run.records) < self._count:
            self._begin(picture)
        else:
            if len(run.records) > self._count:
                new = run.history(self._count)
                self._now.stream({name: new[name] for name in self._now.data})
                self._fit(new)
            if len(run.beside) > self._count_beside:
                new = columns(run.beside[self._count_beside :])
                self._ghost.stream({name: new[name] for name in self._ghost.data})
        self._count, self._count_beside = len(run.records), len(run.beside)
        before = picture.before.iteration if picture.before and not _is_reduced(picture) else 0
        widest = max(run.iteration, before, 20)
        set_range(self.figure.x_range, 0, round_up(widest))
        at = picture.frame.iteration if picture.frame else 0
        if self._shown.location != at:
            self._shown.location = at

    def _begin(self, picture: Picture) -> None:
        """Put all records at once: rows streamed behind new data would be sent twice."""
        self._ticket = picture.run.ticket
        self._lowest, self._highest = LEAST_SPAN
        now = picture.run.history()
        self._now.data = {name: now[name] for name in self._now.data}
        self._fit(now)
        past: list[Record] = picture.before.records if picture.before else []
        self.keys = KEYS if has_reference(picture.run.settings) else KEYS[:ERRORS]
        if _is_reduced(picture):
            past = picture.run.beside
            self.keys = (*self.keys, Key(BLUE, "pale", "full stage"))
        ghost = columns(past)
        self._ghost.data = {name: ghost[name] for name in self._ghost.data}

    def _fit(self, new: dict[str, np.ndarray]) -> None:
        values = [value for name, *_ in CURVES for value in new[name]]
        self._lowest, self._highest = decades([self._lowest, self._highest, *values], FLOOR)
        set_range(self.figure.y_range, self._lowest, self._highest)
        mark_decades(self.figure.yaxis[0], self.figure.y_range)


def _is_reduced(picture: Picture) -> bool:
    return picture.run.settings.is_reduced
