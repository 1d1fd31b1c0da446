"""The flag of a case: the mark of its known number in a plot, named in the legend."""

from __future__ import annotations

import math

from app.frame import Frame
from app.views.colors import FLAG
from app.views.view import View
from solver.study.trade_case import PlotFlag

FLAGS = "flag", "level"
"""Names of the glyphs of a flag, one of which has data: a point, and a line."""


def add_flag(view: View) -> None:
    """Add the glyphs of a flag to the figure of a view."""
    look = {"marker": "inverted_triangle", "size": 12, "color": FLAG}
    view.add("flag", "Scatter", "x y", **look)
    view.add("level", "HSpan", "y", color=FLAG, line_dash="dashed", line_width=1.5)


def show_flag(view: View, frame: Frame) -> None:
    """Show the flag if the number is known for a frame, and stands in this plot."""
    marks = []
    levels = []
    text = ""
    flag = _known(view, frame)
    if flag is not None:
        text = flag.text
        x = float(view.x(flag.x))
        y = float(view.y(flag.y))
        # Any x: a line.
        if math.isnan(x):
            levels = [y]
        else:
            marks = [(x, y)]
    view.fill("flag", text, x=[x for x, _ in marks], y=[y for _, y in marks])
    view.fill("level", text, y=levels)


def _known(view: View, frame: Frame) -> PlotFlag | None:
    """The flag of the case in a plot, if the number is known for a frame."""
    case = view.state.trade_case
    if case is None or case.flag is None or not case.knows(frame.run.settings):
        return None
    if case.flag.plot != view.name:
        return None
    return case.flag
