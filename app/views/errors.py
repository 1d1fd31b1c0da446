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
from app.views.type_size import LETTER, ROW
from app.views.view import HEIGHT, WIDTH, View
from app.worker.references import has_reference

SEEN = (1e-3, 10.0)
"""Errors that are in sight in any case. Indicators widen the axis downwards alone:
they are numbers of other sizes."""
NAME = 10.0
"""Distance of the name of a curve from its end, where there may be a ring, px."""
RING = 11
LINE = 2.5
"""Diameter of that ring, and width of its line, px."""
STEPS = 9
"""Number of places along the line of the goal that its name may have."""
LEAST = 1e-14
"""Value at which smaller ones, which are rounding, and zero are drawn."""
FOOT = 8.0
"""Height at which the answer stands above the lower edge, px: a ring has room there."""
NAMED = 1.25
"""Least length of the axis of iterations over that of the curves, at whose ends their
names stand."""
APART = 1.15
OFF = 0.6
"""Least distance of two of these names over their type size, and of a name from the
line of the goal over that."""
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
    """A plot over all iterations so far, also while an earlier iterate is shown."""

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
            text_baseline="middle",
            text_font_size=self.words,
        )
        self.add("ghost", color=GHOST, width=2, dash="dotted")
        lines = []
        for column, (_, color, width, dash) in reversed(CURVES.items()):
            lines.append(self.add(column, color=color, width=width, dash=dash))
        self.add("newest", "Scatter", color=ERROR, size=8)
        ring = {"line_color": ERROR, "line_width": LINE, "fill_alpha": 0}
        self.add("answer", "Scatter", size=RING, **ring)
        self.add(
            "names",
            "Text",
            "x y text text_color",
            x_offset=NAME,
            text_baseline="middle",
            text_font_size=self.words,
        )
        self.mark({"stage": REFERENCE}, marker="dash", angle=0.5 * np.pi)
        titles = {column: title for column, (title, *_) in CURVES.items()}
        self.legend(**titles, stage="local stage", ghost="ghost")
        self.show("stage", False, may_come_back=False)
        hover(plot, lines, {"iteration": "@x", "value": "@y{0.00e+0}"})
        plot.on_event(Tap, self._go_back)
        # Names stand at distances in px.
        self.follow_size(WIDTH, HEIGHT, self._show_again)

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show errors and indicators of all iterations so far."""
        self._shown = frame, selection, ghost
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
        foot = self._at(np.full(len(answers), FOOT / self.room[1]))
        self.draw("answer", answers, foot)
        self._show_names(newest)
        self._show_goal(newest.run.settings.accuracy)

    def _scale(self, newest: Frame) -> None:
        """Set the limits to all errors; indicators only below the largest error."""
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
        end = rounded_up(self._named * max(*ends, shortest))
        self.x.hold((number, has_ended, self._named), [0.0, end])

    def _show_names(self, newest: Frame) -> None:
        """Place the names of curves at their ends, without overlap."""
        names = []
        for column, (title, color, *_) in CURVES.items():
            data = self.sources[column].data
            if len(data["x"]):
                (height,) = self._heights(data["y"][-1:])
                names.append((height, float(data["x"][-1]), title, color))
        for iteration in self.sources["answer"].data["x"]:
            foot = FOOT / self.room[1]
            names.append((foot, float(iteration), "exact", ERROR))
        names.sort()
        apart = APART * self.type_size / self.room[1]
        (goal,) = self._heights([newest.run.settings.accuracy])
        heights = off(float(goal), [height for height, *_ in names], apart)
        self.fill(
            "names",
            x=[x for _, x, *_ in names],
            y=self._at(heights).tolist(),
            text=[title for *_, title, _ in names],
            text_color=[color for *_, color in names],
        )

    def _show_goal(self, goal: float) -> None:
        """Draw the line of the goal, with the name in a free place.

        Of free places it takes the one at the right end, above the line.
        """
        self.fill("goal", y=[goal])
        text = f"goal {percent(goal)}"
        size = self._size_of(text)
        (level,) = self._heights([goal])
        taken = self._taken()
        # Few of the points are near enough.
        taken = taken[np.abs(taken[:, 1] - level) < size[1]]
        places = []
        for left in np.linspace(1.0 - size[0], 0.0, STEPS):
            for foot in (level, level - size[1]):
                low = np.array([left, foot])
                is_inside = (taken > low) & (taken < low + size)
                places.append((np.all(is_inside, axis=1).sum(), left, foot))
        _, left, foot = min(places, key=lambda place: place[0])
        # By its nearer end: in a page that is saved the plot may become narrower.
        is_right = left + 0.5 * size[0] > 0.5
        self.fill(
            "goal name",
            x=[(left + size[0] * is_right) * self._last],
            y=self._at(np.array([foot + 0.5 * size[1]])).tolist(),
            text=[text],
            text_align=["right" if is_right else "left"],
        )

    def _taken(self) -> Floats:
        """Points on all curves, and on their names, over the size of the plot, (n, 2).

        They are as close to each other as the letters of words.
        """
        fine = np.linspace(0.0, 1.0, round(self.room[0]))
        points = [np.zeros((0, 2))]
        for name in (*CURVES, "ghost"):
            data = self.sources[name].data
            if len(data["x"]):
                x = np.asarray(data["x"]) / self._last
                # Upright pieces have points on the way, too.
                number = np.arange(len(x))
                along = np.interp(fine * number[-1], number, x)
                up = np.interp(fine * number[-1], number, self._heights(data["y"]))
                points.append(np.stack([along, up], axis=1))
        names = self.sources["names"].data
        for x, y, text in zip(names["x"], names["y"], names["text"], strict=True):
            width, height = self._size_of(text)
            begin = x / self._last + NAME / self.room[0]
            along = np.linspace(begin, begin + width, len(text) + 1)
            middle = self._heights([y])
            for up in (middle - 0.3 * height, middle, middle + 0.3 * height):
                points.append(np.stack([along, np.full_like(along, up)], axis=1))
        return np.concatenate(points)

    def _size_of(self, text: str) -> Floats:
        """Width and height of a text over the size of the plot, about, shape (2,)."""
        letters = np.array([LETTER * len(text), ROW]) * self.type_size
        return np.asarray(letters / self.room)

    @property
    def _named(self) -> float:
        """Length of the axis of iterations over that of the curves."""
        longest = max([title for title, *_ in CURVES.values()], key=len)
        width = float(self._size_of(longest)[0]) + NAME / self.room[0]
        # In a plot that is too narrow for any name half of it is for the curves.
        return max(NAMED, 1.0 / max(1.0 - width, 0.5))

    @property
    def _last(self) -> float:
        """The upper limit of the axis of iterations."""
        return float(self.figure.x_range.reset_end)

    @property
    def _ends(self) -> Floats:
        """Logarithms of the limits of the y axis, shape (2,)."""
        axis = self.figure.y_range
        return np.log10([axis.reset_start, axis.reset_end])

    def _heights(self, values: Floats) -> Floats:
        """Heights of values, relative to the axis, shape (n,) each."""
        low, high = self._ends
        return np.asarray((np.log10(values) - low) / (high - low))

    def _at(self, heights: Floats) -> Floats:
        """Values at heights, relative to the axis, shape (n,) each."""
        low, high = self._ends
        return np.asarray(10.0 ** (low + (high - low) * heights))

    @property
    def words(self) -> str:
        """Type size of the names of curves, as CSS has it: that of the axes."""
        return self._type

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


def off(line: float, heights: Sequence[float], apart: float) -> Floats:
    """Ascending heights, moved until they are `apart` and off a line, shape (n,).

    A height stays on its side of the line as long as there is room.
    """
    count = len(heights)
    below = int(np.searchsorted(heights, line))
    room_below = int(max(line / apart + 0.5 - OFF, 0.0))
    room_above = int(max((1.0 - line) / apart - OFF, 0.0))
    below = min(max(below, count - room_above), room_below, count)
    lower = spread(heights[:below], apart, 0.0, min(line + (1.0 - OFF) * apart, 1.0))
    upper = spread(heights[below:], apart, max(line + (OFF - 0.5) * apart, 0.0), 1.0)
    return np.concatenate([lower, upper])


def spread(heights: Sequence[float], apart: float, low: float, high: float) -> Floats:
    """Ascending heights in a range, moved to distances of `apart`, shape (n,).

    Half of that is free below the lowest one.
    """
    steps = apart * np.arange(len(heights))
    raised = np.maximum(heights, low + 0.5 * apart)
    moved = np.maximum.accumulate(raised - steps)
    # What was pushed beyond the upper end goes down, and others before it.
    highest = high - apart * len(heights)
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
