"""Stick, slip and opening over space and time."""

from __future__ import annotations

from typing import Any

from bokeh.events import Tap
from bokeh.models import ColumnDataSource, LinearColorMapper
from bokeh.plotting import figure

from app.frame import Frame, Selection
from app.views.colors import ERROR, STATUS
from app.views.view import View, plot, source


class StatusMap(View):
    """The status of the selected interface; a tap selects the instant."""

    name = "Stick and slip"

    def make(self) -> figure:
        """A new figure."""
        made = plot("x, m", "t, s")
        self.status = ColumnDataSource({"image": [], "x": [], "y": [], "dw": [], "dh": []})
        colors = LinearColorMapper(palette=list(STATUS.values()), low=-1.5, high=2.5)
        made.image("image", x="x", y="y", dw="dw", dh="dh", source=self.status, color_mapper=colors)
        self.now = source("x", "y")
        made.line("x", "y", source=self.now, color=ERROR, width=3)
        made.x_range.range_padding = made.y_range.range_padding = 0
        made.on_event(Tap, self._select)
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the status of every point at every instant."""
        run, name = frame.run, selection.interface_of(frame.run)
        fields = frame.contact.get(name)
        if fields is None:
            return
        x, t = run.interfaces[name].positions, run.instants
        self.status.data = {
            "image": [fields.status.T],
            "x": [x[0]],
            "y": [t[0]],
            "dw": [x[-1] - x[0]],
            "dh": [t[-1] - t[0]],
        }
        self.now.data = {"x": x[[0, -1]], "y": t[[run.column(selection.phase)] * 2]}

    def _select(self, event: Any) -> None:
        if self.state.frame is not None:
            self.state.select(phase=event.y / float(self.state.frame.run.instants[-1]))
