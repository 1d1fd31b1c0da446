"""Friction force error against run time, for the last runs together."""

from __future__ import annotations

import numpy as np
from bokeh.models import Range1d, Span

from app.recording import Recording
from app.views.drawing import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    Key,
    Picture,
    decades,
    empty,
    make_figure,
    mark_decades,
    set_range,
)
from solver.settings import Settings

PAST_COLORS = (GREEN, VERMILION, PURPLE, SKY, ORANGE, GREY)
FLOOR = 1e-14


class ErrorTime:
    """Error over the method's own time, set-up included: what settings are compared by."""

    name = "Error against run time"
    watches = ""
    keys = (Key(BLUE, "line", "now"), Key(GREY, "dotted", "incremental"))

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
        self._past = empty("xs", "ys", "color")
        self._drawn: tuple[object, ...] = ()
        made = self.figure
        made.multi_line("xs", "ys", source=self._past, line_color="color", line_width=2)
        made.line("seconds", "error_force", source=self._now, line_color=BLUE, line_width=3)
        self._incremental = Span(
            dimension="height", line_color=GREY, line_dash="dotted", line_width=2, visible=False
        )
        made.add_layout(self._incremental)

    def applies(self, settings: Settings) -> bool:
        """Every run takes time."""
        return True

    def draw(self, picture: Picture) -> None:
        """Draw the run at work, and the past ones when one was added."""
        known = (picture.run.ticket, len(picture.past))
        if known != self._drawn:
            self._drawn = known
            self._draw_past(picture)
        now = picture.run.history()
        self._now.data = {name: now[name] for name in self._now.data}
        self._fit(picture)

    def _draw_past(self, picture: Picture) -> None:
        runs = [run for run in picture.past if run.records]
        thin = [_thinned(run) for run in runs]
        self._past.data = {
            "xs": [xs for xs, _ in thin],
            "ys": [ys for _, ys in thin],
            "color": [_color(run) for run in runs],
        }
        self.keys = (
            Key(BLUE, "line", "now"),
            *(Key(_color(run), "line", run.label or "before") for run in reversed(runs)),
            Key(GREY, "dotted", "incremental"),
        )

    def _fit(self, picture: Picture) -> None:
        runs = [run for run in [*picture.past, picture.run] if run.records]
        if not runs:
            return
        times = [run.records[0].seconds for run in runs] + [run.records[-1].seconds for run in runs]
        errors = [run.records[-1].error_force for run in runs] + [0.1]
        reference = picture.run.reference
        if reference is not None:
            self._incremental.update(location=reference.seconds, visible=True)
            times.append(reference.seconds)
        set_range(self.figure.x_range, *decades(times, 1e-6))
        mark_decades(self.figure.xaxis[0], self.figure.x_range)
        low, _ = decades(errors, FLOOR)
        set_range(self.figure.y_range, low, 2.0)
        mark_decades(self.figure.yaxis[0], self.figure.y_range)


def _color(run: Recording) -> str:
    return PAST_COLORS[run.ticket % len(PAST_COLORS)]


def _thinned(run: Recording) -> tuple[np.ndarray, np.ndarray]:
    history = run.history()
    keep = np.unique(np.linspace(0, len(run.records) - 1, 200).astype(int))
    return history["seconds"][keep], history["error_force"][keep]
