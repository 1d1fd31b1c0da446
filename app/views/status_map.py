"""Stick, slip and opening over space and time."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.models import LinearColorMapper

from app.frame import Floats, Frame, FrictionInterface, InterfaceFields, Run, Selection
from app.views.axis import edges, even_cells
from app.views.colors import CUT, ERROR, EXACT, GHOST, KEYS, STATUS
from app.views.flags import FLAGS, add_flag, show_flag
from app.views.parts import hover, joined
from app.views.view import View


class StatusMap(View):
    """The status of the selected interface; a tap selects an instant and a point."""

    name = "Stick and slip"

    applies = staticmethod(lambda settings: settings.instants > 1)

    def make(self) -> None:
        """Draw the image of the status, with marks of the selection."""
        plot = self.begin(("x", "m"), ("t", "s"))
        plot.center = []
        self.mark(KEYS)
        # A colour for each status from -1 to 2.
        colors = LinearColorMapper(palette=list(STATUS.values()), low=-1.5, high=2.5)
        image = self.add("status", "Image", "image x y dw dh", color_mapper=colors)
        self.add("cuts", "VSpan", "x", color=CUT, alpha=0.6, line_width=1)
        self.add("front", color=EXACT, width=3)
        self.add("ghost", "Segment", "x0 y0 x1 y1", color=GHOST, width=1.5)
        self.add("now", "HSpan", "y", color=ERROR, line_width=2)
        self.add("position", "VSpan", "x", color=ERROR, alpha=0.7, line_width=1)
        add_flag(self)
        self.legend(*KEYS, "ghost", *FLAGS, front="closed form")
        hover(plot, [image], {"x": "$x{0.000}", "t": "$y{0.000}"})
        plot.on_event(Tap, self._select)

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the status of every point at every instant."""
        run = frame.run
        name = run.interface(selection.interface)
        fields = frame.contact.get(name)
        if fields is None:
            return
        interface = run.interfaces[name]
        self.x.rename(run.x_title(name), "m")
        self.x.hold((run.number, name), interface.positions)
        self.y.hold((run.number, name), run.instants)
        self._show_image(run, interface, fields)
        self.show("open", interface.coefficient is not None)
        self.fill("now", y=self.y(run.instants[[run.column(selection.phase)]]))
        self.fill("position", x=self.x(selection.marked))
        self.fill("cuts", x=self.x(interface.cuts))
        fronts = [(curve.across, curve.up) for curve in run.known("front")[:1]]
        self.draw("front", *joined(fronts))
        # Of another run only the boundaries are drawn: two images would hide each
        # other.
        lines = np.zeros((4, 0))
        if ghost is not None:
            lines = _boundary(ghost, selection)
        x0, x1 = self.x(lines[::2])
        y0, y1 = self.y(lines[1::2])
        self.fill("ghost", self.ghost_name, x0=x0, y0=y0, x1=x1, y1=y1)
        show_flag(self, frame)

    def _show_image(
        self, run: Run, interface: FrictionInterface, fields: InterfaceFields
    ) -> None:
        """Show the status as an image with cells around points and instants."""
        # The first and the last cell stand out by half a cell.
        across, points = even_cells(interface.positions)
        up, instants = even_cells(run.instants)
        left, right = self.x(across[[0, -1]])
        low, high = self.y(up[[0, -1]])
        self.fill(
            "status",
            image=[fields.status[np.ix_(points, instants)].T],
            x=[left],
            y=[low],
            dw=[right - left],
            dh=[high - low],
        )

    def _select(self, event: Any) -> None:
        frame = self.state.frame
        if frame is None:
            return
        end = float(frame.run.instants[-1])
        phase = min(max(self.y.si(event.y) / end, 0.0), 1.0)
        self.state.select(phase=phase, position=self.x.si(event.x))


def _boundary(frame: Frame, selection: Selection) -> Floats:
    """Lines between different status: ends x0, y0, x1, y1, m and s, (4, n_lines)."""
    name = frame.run.interface(selection.interface)
    if name not in frame.contact:
        return np.zeros((4, 0))
    status = frame.contact[name].status
    x = edges(frame.run.interfaces[name].positions)
    t = edges(frame.run.instants)
    i, j = np.nonzero(status[1:] != status[:-1])
    upright = np.stack([x[i + 1], t[j], x[i + 1], t[j + 1]])
    i, j = np.nonzero(status[:, 1:] != status[:, :-1])
    level = np.stack([x[i], t[j + 1], x[i + 1], t[j + 1]])
    return np.concatenate([upright, level], axis=1)
