"""Errors of a search: over its iterations beside indicators, and over run time."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from bokeh.models import FixedTicker, PrintfTickFormatter

from app.frame import Floats, Frame, Selection
from app.views.axis import rounded_up, whole
from app.views.colors import BESIDE, DISPLACEMENT, ERROR, GHOST, PRESSURE, REFERENCE
from app.views.view import View, hover
from app.worker.references import has_reference

LEAST = 1e-4
MOST = 10.0
"""What is seen at least, which indicators do not widen."""
LEAST_IN_TIME = 1e-2
MOST_IN_TIME = 2.0
"""What is seen at least over run time."""
SHORTEST = 20
CURVES = {
    "error_force": ("force", ERROR, 3.5, "solid"),
    "error_displacement": ("displ.", DISPLACEMENT, 2.0, "solid"),
    "estimated_error": ("estimate", BESIDE, 1.5, "dashed"),
    "behaviour": ("k-free", PRESSURE, 1.2, "solid"),
    "indicator": ("η", REFERENCE, 1.2, "solid"),
}
"""Title, colour, width and dash of each scalar of the history; the first is drawn on
top."""


class ErrorPlot(View):
    """A plot of the run so far, also while an earlier iterate is shown."""

    def _newest(self, frame: Frame) -> Frame:
        newest: Frame = self.state.newest or frame
        return newest if newest.run.number == frame.run.number else frame

    def _plot(
        self,
        name: str,
        history: Mapping[str, Floats],
        across: str,
        up: str,
        title: str = "",
    ) -> None:
        """Draw a column of a history over another where it is positive and finite."""
        x, y = (history.get(column, np.zeros(0)) for column in (across, up))
        shown = (y > 0.0) & np.isfinite(y) & np.isfinite(x)
        self.draw(name, x[shown], y[shown], title)


class Convergence(ErrorPlot):
    """Errors and indicators over iterations; the error of the force is bold."""

    name = "Convergence"

    def make(self) -> None:
        """Draw a curve for each error and indicator of the history."""
        made = self.begin(
            ("iteration",), ("error",), y_axis_type="log", y_range=(LEAST, MOST)
        )
        whole(made.xaxis[0])
        self.add("shown", "VSpan", "x", color=REFERENCE, line_width=1.5)
        self.add("ghost", color=GHOST, width=2, dash="dotted")
        lines = [
            self.add(column, color=color, width=width, dash=dash)
            for column, (_, color, width, dash) in reversed(CURVES.items())
        ]
        self.add("newest", "Scatter", color=ERROR, size=8)
        ring = {"line_color": ERROR, "line_width": 2.5, "fill_alpha": 0}
        self.add("answer", "Scatter", size=11, **ring)
        titles = {column: title for column, (title, *_) in CURVES.items()}
        self.legend(**titles, answer="answer", ghost="ghost")
        hover(made, lines, {"iteration": "@x", "value": "@y{0.00e+0}"})

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show errors and indicators of all iterations so far."""
        newest = self._newest(frame)
        run = newest.run
        history = _searched(newest)
        for column in CURVES:
            self._plot(column, history, "iteration", column)
        error = self.sources["error_force"].data
        self.draw("newest", error["x"][-1:], error["y"][-1:])
        if ghost is None:
            past = {}
        else:
            past = _searched(ghost)
        if len(error["x"]):
            column = "error_force"
        else:
            column = "estimated_error"
        self._plot("ghost", past, "iteration", column, self.ghost_name)
        ghosts = self.sources["ghost"].data
        self.y.hold(run.number, [LEAST, MOST], error["y"])
        end = max(float(newest.iteration), *map(float, ghosts["x"][-1:]), SHORTEST)
        self.x.hold(run.number, [0.0, rounded_up(end)])
        is_back = frame is not newest and not frame.is_answer
        self.fill("shown", x=[frame.iteration] if is_back else [])
        foot = self.figure.y_range.reset_start
        if newest.is_answer:
            answer = [newest.iteration]
        else:
            answer = []
        self.draw("answer", answer, [1.6 * foot for _ in answer])


def _searched(frame: Frame) -> dict[str, Floats]:
    """The history without the answer, shape (n_iterations,) each."""
    count = len(frame.history["iteration"]) - (1 if frame.is_answer else 0)
    return {name: values[:count] for name, values in frame.history.items()}


class ErrorTime(ErrorPlot):
    """Error over the run time of the method, set-up included, to compare settings."""

    name = "Error over run time"

    applies = staticmethod(has_reference)

    def make(self) -> None:
        """Draw curves of this run and of the ghost, and the reference's run time."""
        made = self.begin(
            ("run time, s",), ("force error",), x_axis_type="log", y_axis_type="log",
            x_range=(1e-3, 1.0), y_range=(LEAST_IN_TIME, MOST_IN_TIME),
        )  # fmt: skip
        # Few decades have room for 1, 2, 5, 10, ...
        ticks = [f * 10.0**e for e in range(-4, 6) for f in (1, 2, 5)]
        made.xaxis.ticker = FixedTicker(ticks=ticks)
        made.xaxis.formatter = PrintfTickFormatter(format="%g")
        self.add(
            "reference", "VSpan", "x", color=REFERENCE, line_width=2, line_dash="dashed"
        )
        ghost = self.add("ghost", color=GHOST, width=2, dash="dotted")
        now = self.add("now", color=ERROR, width=3)
        self.add("newest", "Scatter", color=ERROR, size=8)
        self.legend(now="this run", ghost="ghost", reference="incremental")
        hover(made, [now, ghost], {"s": "@x{0.000}", "error": "@y{0.00e+0}"})

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the errors of the search so far."""
        newest = self._newest(frame)
        run = newest.run
        if ghost is not None:
            past = ghost.history
        else:
            past = {}
        self._plot("now", newest.history, "seconds", "error_force")
        self._plot("ghost", past, "seconds", "error_force", self.ghost_name)
        now = self.sources["now"].data
        ghosts = self.sources["ghost"].data
        self.draw("newest", now["x"][-1:], now["y"][-1:])
        if np.isfinite(run.reference_seconds):
            seconds = [run.reference_seconds]
        else:
            seconds = []
        self.fill("reference", x=seconds)
        if len(now["x"]) or len(ghosts["x"]):
            self.x.hold(newest.stage, now["x"], ghosts["x"], seconds)
            self.y.hold(
                run.number, now["y"], ghosts["y"], [LEAST_IN_TIME, MOST_IN_TIME]
            )
