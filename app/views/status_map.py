"""Stick, slip and opening over space and time."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.models import ColumnDataSource, LinearColorMapper
from bokeh.plotting import figure

from app.frame import Bytes, Floats, Frame, Interface, Run, Selection
from app.views.colors import CUT, ERROR, EXACT, STATUS
from app.views.view import Axis, Key, View, extent, hover, mark, plot, put, source
from solver.settings import Settings

ENTRIES = {"slip −": -1, "stick": 0, "slip +": 1, "open": 2}


class StatusMap(View):
    """The status of the selected interface; a tap selects the instant and the place."""

    name = "Stick and slip"

    @staticmethod
    def applies(settings: Settings) -> bool:
        """Whether there are several instants."""
        return settings.instants > 1

    def make(self) -> figure:
        """A new figure."""
        made = plot("", "")
        made.grid.visible = False
        self._x, self._y = Axis(made, "x", "x", "m"), Axis(made, "y", "t", "s")
        self.status = ColumnDataSource({"image": [], "x": [], "y": [], "dw": [], "dh": []})
        self.now, self.place, self.cuts = source("t"), source("x"), source("x")
        self.front, self.ghost = source("x", "y"), source("x0", "y0", "x1", "y1")
        colors = LinearColorMapper(palette=list(STATUS.values()), low=-1.5, high=2.5)
        image = made.image(
            "image", x="x", y="y", dw="dw", dh="dh", source=self.status, color_mapper=colors
        )
        made.vspan("x", source=self.cuts, color=CUT, alpha=0.6, line_width=1)
        front = made.line("x", "y", source=self.front, color=EXACT, width=3)
        ghost = made.segment("x0", "y0", "x1", "y1", source=self.ghost, color="#000000", width=1)
        made.hspan("t", source=self.now, color=ERROR, line_width=2)
        made.vspan("x", source=self.place, color=ERROR, alpha=0.7, line_width=1)
        squares = {title: [mark(made, STATUS[status])] for title, status in ENTRIES.items()}
        self._key = Key(made, {**squares, "closed form": [front], "ghost": [ghost]})
        hover(made, [image], {"x": "$x{0.000}", "t": "$y{0.000}"})
        made.on_event(Tap, self._select)
        self._ghost_of: object = None
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the status of every point at every instant."""
        run, name = frame.run, selection.interface_of(frame.run)
        fields, interface = frame.contact.get(name), run.interfaces[name]
        if fields is None:
            return
        x, t = _edges(interface.positions), _edges(run.instants)
        key = (run.number, name)
        self._x.hold(key, *extent([interface.positions]))
        self._y.hold(key, *extent([run.instants]))
        (left, right), (low, high) = self._x(x[[0, -1]]), self._y(t[[0, -1]])
        put(
            self.status,
            image=[fields.status.T],
            x=[left],
            y=[low],
            dw=[right - left],
            dh=[high - low],
        )
        put(self.now, t=self._y(run.instants[[run.column(selection.phase)]]))
        put(self.place, x=self._x([] if selection.place is None else [selection.place]))
        put(self.cuts, x=self._x(interface.cuts))
        front = run.known("front")
        if front:
            put(self.front, x=self._x(front[0].across), y=self._y(front[0].up))
        else:
            put(self.front, x=[], y=[])
        self._show_ghost(ghost, selection, key)
        self._key.show(
            {
                "open": interface.coefficient is not None,
                "closed form": bool(front),
                "ghost": self.ghost_name if len(self.ghost.data["x0"]) else "",
            }
        )

    def _show_ghost(self, ghost: Frame | None, selection: Selection, key: object) -> None:
        """Show the lines between points and instants of different status."""
        name = selection.interface_of(ghost.run) if ghost is not None else ""
        fields = ghost.contact.get(name) if ghost is not None else None
        if (fields, key) == self._ghost_of:
            return
        self._ghost_of = fields, key
        if ghost is None or fields is None:
            put(self.ghost, x0=[], y0=[], x1=[], y1=[])
            return
        x0, y0, x1, y1 = _boundary(ghost.run, ghost.run.interfaces[name], fields.status)
        put(self.ghost, x0=self._x(x0), y0=self._y(y0), x1=self._x(x1), y1=self._y(y1))

    def _select(self, event: Any) -> None:
        frame = self.state.frame
        if frame is None:
            return
        end = float(frame.run.instants[-1])
        phase = min(max(self._y.si(event.y) / end, 0.0), 1.0)
        self.state.select(phase=phase, place=self._x.si(event.x))


def _boundary(run: Run, interface: Interface, status: Bytes) -> list[Floats]:
    """Ends x0, y0, x1, y1 of the lines between different status, each (n_lines,), m and s."""
    x, t = _edges(interface.positions), _edges(run.instants)
    i, j = np.nonzero(status[1:] != status[:-1])
    upright = np.stack([x[i + 1], t[j], x[i + 1], t[j + 1]])
    i, j = np.nonzero(status[:, 1:] != status[:, :-1])
    level = np.stack([x[i], t[j + 1], x[i + 1], t[j + 1]])
    return list(np.concatenate([upright, level], axis=1))


def _edges(middles: Floats) -> Floats:
    """Ends of cells of equal size about points."""
    size = float(np.ptp(middles)) / max(len(middles) - 1, 1) or 1.0
    return np.append(middles - 0.5 * size, middles[-1] + 0.5 * size)
