"""Errors of a search: over iterations, beside indicators, and over run time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from bokeh.core.properties import value
from bokeh.events import Tap
from bokeh.models import FixedTicker, PrintfTickFormatter

from app.frame import LOCAL, Floats, Frame, Selection
from app.units import percent
from app.views.axis import extent, rounded_up, whole
from app.views.colors import BESIDE, DISPLACEMENT, ERROR, GHOST, PRESSURE, REFERENCE
from app.views.parts import hover
from app.views.view import View
from app.worker.references import has_reference

SEEN = (1e-3, 10.0)
"""Errors that are in sight in any case. Indicators widen the axis downwards alone:
they are numbers of other sizes."""
HEIGHT = 160.0
"""Height of a plot until the browser reports its own, px."""
LEAST = 1e-14
"""Value at which smaller ones, which are rounding, and zero are drawn."""
FOOT = 8.0
"""Height at which the answer stands above the lower edge, px: a ring has room there."""
NAMED = 1.25
"""Length of the axis of iterations over that of the curves, at whose ends their names
stand."""
UNNAMED = 0.65
"""Largest length of curves over that of the axis for which the right end is free of
these names."""
APART = 1.05
"""Least distance of two of these names over their type size."""
SEEN_IN_TIME = (1e-2, 2.0)
"""Errors over run time that are in sight in any case."""
SHORTEST = 20
SHORTEST_AT_END = 8
"""Least numbers of iterations for which the axis has room, during a run and once it has
ended: an answer of two would be a line at the left edge."""
CURVES = {
    "error_force": ("force", ERROR, 3.5, "solid"),
    "error_displacement": ("displ.", DISPLACEMENT, 2.0, "solid"),
    "estimated_error": ("estimate", BESIDE, 1.5, "dashed"),
    "behaviour": ("k-free", PRESSURE, 1.2, "solid"),
    "indicator": ("η", REFERENCE, 1.2, "solid"),
}
"""Title, colour, width and dash of the scalars of a history; the first lies on top."""


class ErrorPlot(View):
    """A plot of the run so far, also while an earlier iterate is shown."""

    def _newest(self, frame: Frame) -> Frame:
        """The newest frame of the run of a frame."""
        newest = self.state.newest
        if newest is None or newest.run.number != frame.run.number:
            return frame
        return newest

    def _plot(
        self,
        name: str,
        history: Mapping[str, Floats],
        across: str,
        up: str,
        title: str = "",
    ) -> None:
        """Draw a column of a history over another where it is finite."""
        nothing = np.zeros(0)
        x = history.get(across, nothing)
        y = history.get(up, nothing)
        shown = np.isfinite(y) & np.isfinite(x)
        # A logarithmic axis has no room for zero.
        self.draw(name, x[shown], np.maximum(y[shown], LEAST), title)


class Convergence(ErrorPlot):
    """Errors and indicators over iterations; the error of the force is bold.

    The answer stands at the foot, as its error is that of rounding. A tap goes back to
    an iteration.
    """

    name = "Convergence"

    def make(self) -> None:
        """Draw a curve for each error and indicator of the history."""
        plot = self.begin(("iteration",), ("error",), y_axis_type="log", y_range=SEEN)
        whole(plot.xaxis[0])
        self.add("shown", "VSpan", "x", color=REFERENCE, line_width=1.5)
        self.add("goal", "HSpan", "y", color=ERROR, line_dash="dashed", line_alpha=0.6)
        self.add(
            "goal name",
            "Text",
            "x y text text_align",
            text_color=ERROR,
            text_baseline="bottom",
            text_font_size=self.words,
        )
        self.add("ghost", color=GHOST, width=2, dash="dotted")
        lines = []
        for column, (_, color, width, dash) in reversed(CURVES.items()):
            lines.append(self.add(column, color=color, width=width, dash=dash))
        self.add("newest", "Scatter", color=ERROR, size=8)
        ring = {"line_color": ERROR, "line_width": 2.5, "fill_alpha": 0}
        self.add("answer", "Scatter", size=11, **ring)
        self.add(
            "names",
            "Text",
            "x y text text_color",
            x_offset=6,
            text_baseline="middle",
            text_font=value("Roboto, sans-serif"),
            text_font_size=self.words,
        )
        self.mark({"stage": REFERENCE}, marker="dash", angle=0.5 * np.pi)
        titles = {column: title for column, (title, *_) in CURVES.items()}
        self.legend(**titles, stage="local stage", ghost="ghost")
        hover(plot, lines, {"iteration": "@x", "value": "@y{0.00e+0}"})
        plot.on_event(Tap, self._go_back)
        self._inner_height = HEIGHT
        plot.on_change("inner_height", self._resize)

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show errors and indicators of all iterations so far."""
        newest = self._newest(frame)
        history = _searched(newest)
        for column in CURVES:
            self._plot(column, history, "iteration", column)
        errors = self.sources["error_force"].data
        self.draw("newest", errors["x"][-1:], errors["y"][-1:])
        self._show_ghost(ghost, has_errors=len(errors["x"]) > 0)
        self._scale(newest)
        is_local = selection.stage == LOCAL
        is_back = frame is not newest and not frame.is_answer
        # The local stage lies between two whole iterates.
        at = frame.iteration - 0.5 * is_local
        self.fill("shown", x=[at] if is_back or is_local else [])
        self.show("stage", is_local)
        # The answer, whose error is nearly zero, stands at the foot.
        answers = []
        if newest.is_answer:
            answers = [newest.iteration]
        foot = self._at(np.full(len(answers), FOOT / self._inner_height))
        self.draw("answer", answers, foot)
        goal = newest.run.settings.accuracy
        self.fill("goal", y=[goal])
        # At an end of its line: the right one, unless the names of curves are there.
        end = float(self.figure.x_range.reset_end)
        is_left = newest.iteration > UNNAMED * end
        self.fill(
            "goal name",
            x=[0.0 if is_left else end],
            y=[goal],
            text=[f" goal {percent(goal)} "],
            text_align=["left" if is_left else "right"],
        )
        self._show_names(newest)

    def _scale(self, newest: Frame) -> None:
        """Have all that is drawn in sight; indicators only from their largest error."""
        number = newest.run.number
        curves = [self.sources[column].data["y"] for column in CURVES]
        low, _ = extent([SEEN, *curves])
        # Below the least value there is room for ends of curves, and for their names.
        if low < 2.0 * LEAST:
            low = 0.1 * LEAST
        errors = self.sources["error_force"].data["y"]
        self.y.hold(number, SEEN, [low], errors)
        ghosts = self.sources["ghost"].data["x"]
        ends = [float(newest.iteration), *map(float, ghosts[-1:])]
        has_ended = newest.status is not None
        shortest = SHORTEST
        if has_ended:
            shortest = SHORTEST_AT_END
        end = rounded_up(NAMED * max(*ends, shortest))
        self.x.hold((number, has_ended), [0.0, end])

    def _show_names(self, newest: Frame) -> None:
        """Write the names of curves at their ends, one above the other."""
        low, high = self._ends
        names = []
        for column, (title, color, *_) in CURVES.items():
            data = self.sources[column].data
            if len(data["x"]):
                height = (np.log10(data["y"][-1]) - low) / (high - low)
                names.append((height, float(data["x"][-1]), title, color))
        for iteration in self.sources["answer"].data["x"]:
            foot = FOOT / self._inner_height
            names.append((foot, float(iteration), "exact", ERROR))
        names.sort()
        apart = APART * self.type_size / self._inner_height
        heights = spread([height for height, *_ in names], apart)
        self.fill(
            "names",
            x=[x for _, x, *_ in names],
            y=self._at(heights).tolist(),
            text=[title for *_, title, _ in names],
            text_color=[color for *_, color in names],
        )

    @property
    def _ends(self) -> Floats:
        """Logarithms of the ends of the axis up, shape (2,)."""
        axis = self.figure.y_range
        return np.log10([axis.reset_start, axis.reset_end])

    def _at(self, heights: Floats) -> Floats:
        """Values at heights over that of the axis, shape (n,) each."""
        low, high = self._ends
        return np.asarray(10.0 ** (low + (high - low) * heights))

    @property
    def words(self) -> str:
        """Type size of the names of curves, as CSS has it: that of the axes."""
        return f"{self.type_size:g}px"

    def _resize(self, name: str, old: float, new: float) -> None:
        # A figure that is out of sight reports a size of zero.
        self._inner_height = max(float(new), 60.0)

    def _go_back(self, event: Any) -> None:
        """Show the iterate nearest to a tap."""
        self.state.seek(max(round(event.x), 1))

    def _show_ghost(self, ghost: Frame | None, *, has_errors: bool) -> None:
        """Show the errors of another run; its estimates if this run has no errors."""
        past = {}
        if ghost is not None:
            past = _searched(ghost)
        column = "estimated_error"
        if has_errors:
            column = "error_force"
        self._plot("ghost", past, "iteration", column, self.ghost_name)


def spread(heights: Sequence[float], apart: float) -> Floats:
    """Ascending heights between 0 and 1, moved until they are `apart`, shape (n,).

    Half of that is free below the lowest one.
    """
    steps = apart * np.arange(len(heights))
    raised = np.maximum(heights, 0.5 * apart)
    moved = np.maximum.accumulate(raised - steps)
    # What was pushed beyond the upper end goes down, and others before it.
    highest = 1.0 - apart * len(heights)
    return np.asarray(np.minimum(moved, highest) + steps)


def _searched(frame: Frame) -> dict[str, Floats]:
    """The history without the answer, shape (n_iterations,) each."""
    count = len(frame.history["iteration"])
    if frame.is_answer:
        count -= 1
    return {name: values[:count] for name, values in frame.history.items()}


class ErrorTime(ErrorPlot):
    """Error over the run time of the method, set-up included, to compare settings."""

    name = "Error over run time"

    applies = staticmethod(has_reference)

    def make(self) -> None:
        """Draw curves of this run and of the ghost, and the reference's run time."""
        plot = self.begin(
            ("run time, s",), ("force error",), x_axis_type="log", y_axis_type="log",
            x_range=(1e-3, 1.0), y_range=SEEN_IN_TIME,
        )  # fmt: skip
        # Few decades have room for 1, 2, 5, 10, ...
        ticks = np.outer(10.0 ** np.arange(-4, 6), (1.0, 2.0, 5.0))
        plot.xaxis.ticker = FixedTicker(ticks=ticks.ravel().tolist())
        plot.xaxis.formatter = PrintfTickFormatter(format="%g")
        self.add(
            "reference", "VSpan", "x", color=REFERENCE, line_width=2, line_dash="dashed"
        )
        ghost = self.add("ghost", color=GHOST, width=2, dash="dotted")
        now = self.add("now", color=ERROR, width=3)
        self.add("newest", "Scatter", color=ERROR, size=8)
        self.legend(now="this run", ghost="ghost", reference="incremental")
        hover(plot, [now, ghost], {"s": "@x{0.000}", "error": "@y{0.00e+0}"})

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the errors of the search so far."""
        newest = self._newest(frame)
        run = newest.run
        past: Mapping[str, Floats] = {}
        if ghost is not None:
            past = ghost.history
        self._plot("now", newest.history, "seconds", "error_force")
        self._plot("ghost", past, "seconds", "error_force", self.ghost_name)
        now = self.sources["now"].data
        ghosts = self.sources["ghost"].data
        self.draw("newest", now["x"][-1:], now["y"][-1:])
        seconds = []
        if np.isfinite(run.reference_seconds):
            seconds = [run.reference_seconds]
        self.fill("reference", x=seconds)
        # Without an error the axes keep the limits with which the figure was made.
        if len(now["x"]) or len(ghosts["x"]):
            self.x.hold(newest.stage, now["x"], ghosts["x"], seconds)
            self.y.hold(run.number, now["y"], ghosts["y"], SEEN_IN_TIME)
