"""Errors of a search: over iterations, with indicators, and over run time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
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
LEAST = 1e-14
"""Value at which smaller ones, which are rounding, and zero are drawn."""
FOOT = 0.05
"""Height at which the answer stands over that of the axis: a ring has room there."""
NAMED = 1.25
"""Least length of the axis of iterations over that of the curves, at whose ends their
names stand."""
APART = 0.085
"""Least distance of two of these names over the height of the axis."""
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


class Convergence(View):
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
            x_offset=10,
            text_baseline="middle",
            text_font_size=self.words,
        )
        self.mark({"stage": REFERENCE}, marker="dash", angle=0.5 * np.pi)
        titles = {column: title for column, (title, *_) in CURVES.items()}
        more = {"goal": "goal", "stage": "local stage"}
        self.legend(**titles, **more, ghost="ghost")
        self.show("stage", False, may_come_back=False)
        hover(plot, lines, {"iteration": "@x", "value": "@y{0.00e+0}"})
        plot.on_event(Tap, self._go_back)

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show errors and indicators of all iterations so far."""
        newest = self._newest(frame)
        # An answer without a search has errors once it is compared.
        if newest.is_followed and self.state.is_fleeting:
            self.clear()
            return
        history = _searched(newest)
        for column in CURVES:
            self.draw(column, *_curve(history, "iteration", column))
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
        self.draw("answer", answers, self._values([FOOT] * len(answers)))
        self._show_names()
        goal = newest.run.settings.accuracy
        self.fill("goal", f"goal {percent(goal)}", y=[goal])

    def _scale(self, newest: Frame) -> None:
        """Set the limits to all errors; indicators only below the largest error."""
        number = newest.run.number
        curves = [self.sources[column].data["y"] for column in CURVES]
        low, _ = extent([SEEN, *curves])
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

    def _show_names(self) -> None:
        """Place the names of curves at their ends, apart from each other."""
        titles = {
            column: (title, color) for column, (title, color, *_) in CURVES.items()
        }
        titles["answer"] = ("exact", ERROR)
        names = []
        for column, (title, color) in titles.items():
            ends = self.sources[column].data
            if len(ends["x"]):
                (height,) = self._heights(ends["y"][-1:])
                names.append((height, float(ends["x"][-1]), title, color))
        names.sort()
        heights = spread([height for height, *_ in names], APART)
        self.fill(
            "names",
            x=[x for _, x, *_ in names],
            y=self._values(heights),
            text=[title for *_, title, _ in names],
            text_color=[color for *_, color in names],
        )

    @property
    def words(self) -> str:
        """Type size of the names of curves, as CSS has it: that of the axes."""
        return self._type

    def _heights(self, values: Floats) -> Floats:
        """Heights of values over that of the axis, shape (n,) each."""
        low, high = self._limits
        return np.asarray((np.log10(values) - low) / (high - low))

    def _values(self, heights: Sequence[float]) -> Floats:
        """Values at heights over that of the axis, shape (n,) each."""
        low, high = self._limits
        return np.asarray(10.0 ** (low + (high - low) * np.asarray(heights)))

    @property
    def _limits(self) -> Floats:
        """Logarithms of the limits of the axis of errors, shape (2,)."""
        axis = self.figure.y_range
        return np.log10([axis.reset_start, axis.reset_end])

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
        self.draw("ghost", *_curve(past, "iteration", column), self.ghost_name)


def spread(heights: Sequence[float], apart: float) -> list[float]:
    """Ascending heights between 0 and 1, raised and lowered to distances of `apart`.

    Half of that is free below the lowest one.
    """
    steps = apart * np.arange(len(heights))
    inside = np.maximum(heights, 0.5 * apart)
    raised = np.maximum.accumulate(inside - steps)
    # What was pushed beyond the upper end goes down, and others before it.
    moved = np.minimum(raised, 1.0 - apart * len(heights)) + steps
    return [float(height) for height in moved]


def _curve(
    history: Mapping[str, Floats], across: str, up: str
) -> tuple[Floats, Floats]:
    """A column of a history over another where it is finite, shape (n,) each."""
    nothing = np.zeros(0)
    x = history.get(across, nothing)
    y = history.get(up, nothing)
    shown = np.isfinite(y) & np.isfinite(x)
    # A logarithmic axis has no room for zero.
    return x[shown], np.maximum(y[shown], LEAST)


def _searched(frame: Frame) -> dict[str, Floats]:
    """The history without the answer, shape (n_iterations,) each."""
    count = len(frame.history["iteration"])
    if frame.is_answer:
        count -= 1
    return {name: values[:count] for name, values in frame.history.items()}


class ErrorTime(View):
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
        self.draw("now", *_curve(newest.history, "seconds", "error_force"))
        curve = _curve(past, "seconds", "error_force")
        self.draw("ghost", *curve, self.ghost_name)
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
