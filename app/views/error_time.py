"""Friction force error against run time, for the last runs together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.models import Range1d, Span

from app.recording import columns
from app.views.drawing import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    Picture,
    decades,
    empty,
    make_figure,
    mark_decades,
    set_range,
)
from app.views.legend import Key
from app.worker.shown import has_reference
from solver.latin import Record
from solver.settings import Settings

NOW = Key(BLUE, "line", "now")
PAST_COLORS = (GREEN, VERMILION, PURPLE, SKY, ORANGE, GREY)
FLOOR = 1e-14


class ErrorTime:
    """Error over the method's own time, set-up included: what settings are compared by.

    A run on separated bases has the full linear stage beside it, on a clock of its own.
    """

    name = "Error against run time"
    watches = ""
    keys: Sequence[Key] = (NOW,)

    def __init__(self) -> None:
        self.figure = make_figure(
            "Run time of the method (s)",
            "Friction force error",
            x_range=Range1d(1e-3, 1),
            y_range=Range1d(1e-4, 2),
            x_axis_type="log",
            y_axis_type="log",
        )
        self._now = empty("seconds", "error_force")
        self._full = empty("seconds", "error_force")
        self._past = empty("xs", "ys", "color")
        self._drawn: tuple[object, ...] = ()
        self._colors: dict[int, str] = {}
        made = self.figure
        made.multi_line("xs", "ys", source=self._past, line_color="color", line_width=2)
        made.line(
            "seconds",
            "error_force",
            source=self._full,
            line_color=BLUE,
            line_dash="dashed",
            line_width=2.5,
        )
        made.line("seconds", "error_force", source=self._now, line_color=BLUE, line_width=3)
        self._incremental = Span(
            dimension="height", line_color=GREY, line_dash="dotted", line_width=2, visible=False
        )
        made.add_layout(self._incremental)

    def applies(self, settings: Settings) -> bool:
        """Every run takes time, but there are errors only beside a reference."""
        return has_reference(settings)

    def draw(self, picture: Picture) -> None:
        """Draw the run at work, and the past ones when one was added."""
        reference = picture.run.reference
        known = (picture.run.ticket, len(picture.past), reference is None)
        if known != self._drawn:
            self._drawn = known
            self._draw_past(picture)
            self._full.data = {"seconds": [], "error_force": []}
            self._incremental.visible = reference is not None
            if reference is not None:
                self._incremental.location = reference.seconds
        now = picture.run.history()
        self._now.data = {name: now[name] for name in self._now.data}
        if picture.run.beside:
            seconds, errors = _thinned(picture.run.beside)
            self._full.data = {"seconds": seconds, "error_force": errors}
        self._fit(picture)

    def _draw_past(self, picture: Picture) -> None:
        runs = [run for run in picture.past if run.records]
        colors = self._colors = _colors(self._colors, [run.ticket for run in runs])
        thin = [_thinned(run.records) for run in runs]
        self._past.data = {
            "xs": [xs for xs, _ in thin],
            "ys": [ys for _, ys in thin],
            "color": [colors[run.ticket] for run in runs],
        }
        reduced, reference = picture.run.settings.is_reduced, picture.run.reference
        self.keys = (
            NOW,
            *((Key(BLUE, "dashed", "full stage"),) if reduced else ()),
            *(Key(colors[run.ticket], "line", run.title) for run in reversed(runs)),
            *((Key(GREY, "dotted", "incremental"),) if reference else ()),
        )

    def _fit(self, picture: Picture) -> None:
        every = [run.records for run in [*picture.past, picture.run]] + [picture.run.beside]
        runs = [records for records in every if records]
        if not runs:
            return
        times = [records[place].seconds for records in runs for place in (0, -1)]
        errors = [records[-1].error_force for records in runs] + [0.1]
        if picture.run.reference is not None:
            times.append(picture.run.reference.seconds)
        set_range(self.figure.x_range, *decades(times, 1e-6))
        mark_decades(self.figure.xaxis[0], self.figure.x_range)
        low, _ = decades(errors, FLOOR)
        set_range(self.figure.y_range, low, 2.0)
        mark_decades(self.figure.yaxis[0], self.figure.y_range)


def _colors(given: dict[int, str], tickets: list[int]) -> dict[int, str]:
    """Give every run a color of its own, which it keeps as long as it is drawn."""
    found = {ticket: given[ticket] for ticket in tickets if ticket in given}
    free = [color for color in PAST_COLORS if color not in found.values()]
    new = [ticket for ticket in tickets if ticket not in found]
    return found | dict(zip(new, free, strict=False))


def _thinned(records: list[Record]) -> tuple[np.ndarray, np.ndarray]:
    keep = np.unique(np.linspace(0, len(records) - 1, 200).astype(int))
    history = columns([records[place] for place in keep])
    return history["seconds"], history["error_force"]
