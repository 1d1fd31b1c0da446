"""Error of the contact force against run time, beside the incremental solver's."""

from __future__ import annotations

import numpy as np
from bokeh.plotting import figure

from app.frame import Frame, Selection
from app.views.colors import ERROR, GHOST, REFERENCE
from app.views.view import (
    Axis,
    Key,
    View,
    curve,
    extent,
    few_ticks,
    hover,
    key_of,
    plot,
    put,
    source,
)
from app.worker.references import has_reference
from solver.settings import Settings

LEAST, MOST, FLOOR = 1e-2, 2.0, 1e-15


class ErrorTime(View):
    """Error over the time of the method, set-up included, by which settings are compared."""

    name = "Error over run time"

    @staticmethod
    def applies(settings: Settings) -> bool:
        """Whether there is a reference."""
        return has_reference(settings)

    def make(self) -> figure:
        """A new figure."""
        made = plot(
            "run time, s",
            "force error",
            x_axis_type="log",
            y_axis_type="log",
            x_range=(1e-3, 1.0),
            y_range=(LEAST, MOST),
        )
        few_ticks(made.xaxis[0])
        self._x, self._y = Axis(made, "x", "run time, s"), Axis(made, "y", "force error")
        self.now, self.ghost = source("x", "y"), source("x", "y")
        self.newest, self.reference = source("x", "y"), source("x")
        reference = made.vspan(
            "x", source=self.reference, color=REFERENCE, line_width=2, line_dash="dashed"
        )
        ghost = made.line("x", "y", source=self.ghost, color=GHOST, width=2, dash="dotted")
        now = made.line("x", "y", source=self.now, color=ERROR, width=3)
        made.scatter("x", "y", source=self.newest, color=ERROR, size=8)
        self._key = Key(made, {"this run": [now], "ghost": [ghost], "incremental": [reference]})
        hover(made, [now, ghost], {"s": "@x{0.000}", "error": "@y{0.00e+0}"})
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the errors of the search so far."""
        newest = self.state.newest
        if newest is None or newest.run.number != frame.run.number:
            newest = frame
        run = newest.run
        curve(self.now, newest.history["seconds"], newest.history["error_force"])
        past = ghost.history if ghost is not None else {"seconds": [], "error_force": []}
        curve(self.ghost, past["seconds"], past["error_force"])
        put(self.newest, x=self.now.data["x"][-1:], y=self.now.data["y"][-1:])
        seconds = [run.reference_seconds] if np.isfinite(run.reference_seconds) else []
        put(self.reference, x=seconds)
        both = self.now.data, self.ghost.data
        errors = [np.asarray(data["y"]) for data in both if len(data["y"])]
        times = [np.asarray(data["x"]) for data in both if len(data["x"])]
        if times:
            self._x.decades(key_of(run), *extent([*times, seconds]))
            low, high = extent(errors)
            self._y.decades(run.number, min(max(low, FLOOR), LEAST), max(high, MOST))
        past_name = self.ghost_name if len(self.ghost.data["x"]) else ""
        self._key.show({"ghost": past_name, "incremental": bool(seconds)})
