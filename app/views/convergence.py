"""True errors and indicators over the iterations."""

from __future__ import annotations

import math

from bokeh.plotting import figure

from app.frame import Frame, Selection
from app.views.colors import BESIDE, DISPLACEMENT, ERROR, GHOST, PRESSURE, REFERENCE
from app.views.view import Axis, Key, View, curve, extent, hover, plot, put, source, whole

LEAST, MOST, FLOOR = 1e-4, 10.0, 1e-15
"""What is seen at least, which indicators do not widen, and the smallest error that is seen."""
SHORTEST = 20
CURVES = {
    "η": ("indicator", REFERENCE, 1.2, "solid"),
    "k-free": ("behaviour", PRESSURE, 1.2, "solid"),
    "estimate": ("estimated_error", BESIDE, 1.5, "dashed"),
    "displ.": ("error_displacement", DISPLACEMENT, 2.0, "solid"),
    "force": ("error_force", ERROR, 3.5, "solid"),
}
"""Column, colour, width and dash of each; the last is drawn on top."""


class Convergence(View):
    """Error of the force bold, and indicators on an axis that does not flatten it."""

    name = "Convergence"

    def make(self) -> figure:
        """A new figure."""
        made = plot("iteration", "error", y_axis_type="log", y_range=(LEAST, MOST))
        whole(made.xaxis[0])
        self._x, self._y = Axis(made, "x", "iteration"), Axis(made, "y", "error")
        self.ghost, self.newest = source("x", "y"), source("x", "y")
        self.answer, self.shown = source("x", "y"), source("x")
        self.curves = {title: source("x", "y") for title in CURVES}
        made.vspan("x", source=self.shown, color=REFERENCE, line_width=1.5)
        ghost = made.line("x", "y", source=self.ghost, color=GHOST, width=2, dash="dotted")
        lines = {
            title: [
                made.line("x", "y", source=self.curves[title], color=color, width=width, dash=dash)
            ]
            for title, (_, color, width, dash) in CURVES.items()
        }
        made.scatter("x", "y", source=self.newest, color=ERROR, size=8)
        answer = made.scatter(
            "x", "y", source=self.answer, size=11, line_color=ERROR, line_width=2.5, fill_alpha=0
        )
        order = dict(reversed(lines.items()))
        self._key = Key(made, {**order, "answer": [answer], "ghost": [ghost]})
        tips = {"iteration": "@x", "value": "@y{0.00e+0}"}
        hover(made, [line for each in lines.values() for line in each], tips)
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show what the run has come to so far, also where an earlier iterate is gone back to."""
        newest = self.state.newest
        if newest is None or newest.run.number != frame.run.number:
            newest = frame
        run, searched = newest.run, _searched(newest)
        x = newest.history["iteration"][:searched]
        for title, (column, *_) in CURVES.items():
            curve(self.curves[title], x, newest.history[column][:searched])
        error = self.curves["force"].data
        put(self.newest, x=error["x"][-1:], y=error["y"][-1:])
        column = "error_force" if len(error["x"]) else "estimated_error"
        if ghost is None:
            curve(self.ghost, [], [])
        else:
            n = _searched(ghost)
            curve(self.ghost, ghost.history["iteration"][:n], ghost.history[column][:n])
        low, high = extent([[LEAST, MOST], error["y"], self.ghost.data["y"]])
        self._y.decades(run.number, max(low, FLOOR), high)
        end = max(float(newest.iteration), *map(float, self.ghost.data["x"][-1:]), SHORTEST)
        self._x.hold(run.number, 0.0, _round_up(end))
        back = [frame.iteration] if frame is not newest and not frame.is_answer else []
        put(self.shown, x=back)
        foot = self.figure.y_range.reset_start
        is_answer = [newest.iteration] if newest.is_answer else []
        put(self.answer, x=is_answer, y=[1.6 * foot for _ in is_answer])
        entries: dict[str, bool | str] = {
            title: len(source.data["x"]) > 1 for title, source in self.curves.items()
        }
        past = self.ghost_name if len(self.ghost.data["x"]) else ""
        self._key.show({**entries, "answer": newest.is_answer, "ghost": past})


def _searched(frame: Frame) -> int:
    """Number of the history's entries without that of the answer, which is no iteration."""
    return len(frame.history["iteration"]) - (1 if frame.is_answer else 0)


def _round_up(count: float) -> float:
    """The next of 20, 50, 100, 200, ..."""
    decade = 10.0 ** math.floor(math.log10(count))
    return next(step * decade for step in (1.0, 2.0, 5.0, 10.0) if step * decade >= count)
