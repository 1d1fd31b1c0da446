"""A figure for drawing an expected curve before the measured one is shown."""

from __future__ import annotations

import math

from bokeh.models import ColumnDataSource, FreehandDrawTool
from bokeh.plotting import figure

from app.views.colors import FORCE, LATIN
from app.views.legends import legend
from app.views.type_size import FONT, TEXT, magnify
from solver.settings.definitions import title_of
from solver.study.lessons import Lesson

LINES = 17.0
"""Height of the figure over its type size."""
HIGHEST = 0.6
"""Height of a value that is never reached, over the top of the axis."""


class DrawnCurve:
    """A figure over a setting for the expected curve, and then the measured one.

    `drawn` and `measured` are the sources of what was drawn by hand, and of what the
    checkpoints of the `lesson` measure.
    """

    def __init__(self, lesson: Lesson) -> None:
        self.lesson = lesson
        positions, values = zip(*lesson.curve, strict=True)
        finite = filter(math.isfinite, values)
        self._top = 10.0 ** math.ceil(math.log10(max(finite)))
        plot = figure(
            x_axis_type="log",
            y_axis_type="log",
            x_axis_label=title_of(lesson.settings.definitions()[lesson.draw]),
            y_axis_label=lesson.checkpoints[0].quantity.title.split(" to ")[0],
            x_range=(positions[0] / 2.0, positions[-1] * 2.0),
            y_range=(1.0, self._top),
            sizing_mode="stretch_width",
            toolbar_location=None,
            tools="",
        )
        plot.xaxis.ticker = list(positions)
        plot.xaxis.major_label_overrides = {x: f"{x:g}" for x in positions}
        plot.min_border = 4
        self.drawn = ColumnDataSource({"xs": [], "ys": []})
        self.measured = ColumnDataSource({"x": [], "y": [], "text": []})
        line = plot.multi_line("xs", "ys", source=self.drawn, color=FORCE, width=3)
        points = plot.scatter("x", "y", source=self.measured, color=LATIN, size=11)
        plot.text(
            "x",
            "y",
            "text",
            source=self.measured,
            y_offset=20,
            text_font=FONT,
            text_font_size="12px",
            text_align="center",
            text_color=LATIN,
        )
        legend(plot, [("drawn by hand", [line]), ("measured", [points])])
        tool = FreehandDrawTool(renderers=[line], num_objects=1)
        plot.add_tools(tool)
        plot.toolbar.active_drag = tool
        self.figure = plot
        self.magnify(TEXT)

    def magnify(self, size: str) -> None:
        """Set the type size of the figure, as CSS has it, and its height by it."""
        magnify(self.figure, size, size)
        self.figure.height = int(LINES * float(size.removesuffix("px")))

    def reveal(self) -> None:
        """Show the measured curve, and end the drawing."""
        self.figure.toolbar.active_drag = None
        # A value that is never reached stands near the top, with a word beside it.
        heights = []
        words = []
        for _, value in self.lesson.curve:
            heights.append(min(value, HIGHEST * self._top))
            words.append("" if math.isfinite(value) else "never")
        positions = [position for position, _ in self.lesson.curve]
        self.measured.data = {"x": positions, "y": heights, "text": words}
