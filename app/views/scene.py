"""The scene itself: bodies, what holds them, what acts on them, and where they slip."""

from __future__ import annotations

import numpy as np
from bokeh.models import Range1d
from bokeh.plotting import figure

from app.frame import Frame, Selection
from app.views.colors import BODY, EDGE, STATUS
from app.views.view import View, source


class Scene(View):
    """The deformed bodies at the selected instant, and the status of their contacts."""

    name = "Scene"

    def make(self) -> figure:
        """A new figure."""
        made = figure(
            sizing_mode="stretch_both",
            min_height=100,
            tools="",
            toolbar_location=None,
            x_range=Range1d(0, 1),
            y_range=Range1d(0, 1),
        )
        made.axis.visible = made.grid.visible = False
        made.min_border, made.outline_line_color = 2, None
        self.quads = source("xs", "ys")
        self.contacts = source("x", "y", "color")
        made.patches("xs", "ys", source=self.quads, color=BODY, line_color=EDGE, line_alpha=0.4)
        made.scatter("x", "y", source=self.contacts, color="color", size=5)
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the bodies at the selected instant."""
        geometry, column = frame.run.geometry, frame.run.column(selection.phase)
        moved = frame.deformed.nodes[:, :, column]
        size = float(np.ptp(geometry.nodes, axis=0).max())
        factor = 0.05 * size / (float(np.abs(frame.deformed.nodes).max()) or 1.0)
        nodes = geometry.nodes + factor * moved
        corners = nodes[geometry.quads]
        self.quads.data = {"xs": list(corners[:, :, 0]), "ys": list(corners[:, :, 1])}
        x, y = (geometry.points + factor * frame.deformed.points[:, :, column]).T
        colors = [STATUS[int(status)] for status in frame.deformed.status[:, column]]
        self.contacts.data = {"x": x, "y": y, "color": colors}
        for axis, values in zip(
            (self.figure.x_range, self.figure.y_range), geometry.nodes.T, strict=True
        ):
            margin = 0.08 * size
            axis.start, axis.end = float(values.min()) - margin, float(values.max()) + margin
