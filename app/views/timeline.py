"""The load path as the time line: one drags along it to choose the instant."""

from __future__ import annotations

from typing import Any

from bokeh.events import Pan, Tap
from bokeh.models import PanTool
from bokeh.plotting import figure

from app.frame import Frame, Selection
from app.views.colors import FORCE
from app.views.view import View, source


class Timeline(View):
    """The load over time, and the selected instant."""

    name = "Load path"

    def make(self) -> figure:
        """A new figure."""
        made = figure(sizing_mode="stretch_both", min_height=40, tools="", toolbar_location=None)
        made.min_border, made.outline_line_color = 2, None
        made.yaxis.visible = made.grid.visible = False
        made.xaxis.major_label_text_font_size = "11px"
        self.path, self.now = source("t", "load"), source("t", "load")
        made.varea("t", 0, "load", source=self.path, color=FORCE, alpha=0.18)
        made.line("t", "load", source=self.path, color=FORCE, width=2)
        made.scatter("t", "load", source=self.now, color=FORCE, size=13)
        made.add_tools(PanTool(dimensions="width"))
        for event in (Pan, Tap):
            made.on_event(event, self._select)
        self._run = 0
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the load path of a run, and the instant."""
        run, column = frame.run, frame.run.column(selection.phase)
        load = frame.loop[1] if run.load is None else run.load
        if run.number != self._run or run.load is None:
            self._run = run.number
            self.path.data = {"t": run.instants, "load": load}
            self.figure.x_range.start, self.figure.x_range.end = 0.0, float(run.instants[-1])
        self.now.data = {"t": run.instants[[column]], "load": load[[column]]}

    def _select(self, event: Any) -> None:
        frame = self.state.frame
        if frame is not None:
            end = float(frame.run.instants[-1])
            self.state.select(phase=min(max(event.x / end, 0.0), 1.0))
