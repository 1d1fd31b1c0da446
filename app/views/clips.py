"""How many numbers the friction force takes: as a table, in products, and as clips with memory."""

from __future__ import annotations

import numpy as np
from bokeh.plotting import figure

from app.frame import Floats, Frame, Selection
from app.units import percent
from app.views.colors import DISPLACEMENT, ERROR, LATIN, REFERENCE
from app.views.view import Axis, Key, View, hover, plot, put, source
from solver.settings import Settings
from solver.study.quantities.clip_measures import can_be_clipped

MOST_VALUES = 1_000_000
"""Values of a field up to which all curves take no longer than a second, in which the worker obeys
no order (measured: 0.9 s for 1001 x 999)."""
FLOOR, EXACT = 1e-6, 1e-9
"""Smallest error that is shown, and error up to which clips are exact but for rounding."""


class Clips(View):
    """Error of this iterate's friction over the numbers that are kept of it."""

    name = "Clips"
    needs = frozenset({"clips"})

    @staticmethod
    def applies(settings: Settings) -> bool:
        """Whether there are rods, whose friction bound is known, and not too many values."""
        if not can_be_clipped(settings) or settings.instants < 2:
            return False
        values = settings.values()
        interfaces = values.get("wires", 2) - 1
        return bool(interfaces * (values["elements"] + 1) * settings.instants <= MOST_VALUES)

    def make(self) -> figure:
        """A new figure."""
        made = plot(
            "numbers kept",
            "error",
            x_axis_type="log",
            y_axis_type="log",
            x_range=(10.0, 1e5),
            y_range=(FLOOR, 1.0),
        )
        self._x, self._y = Axis(made, "x", "numbers kept"), Axis(made, "y", "error")
        self.curves = {name: source("x", "y") for name in ("SVD", "PGD", "clips")}
        self.alone, self.table = source("x", "y"), source("x")
        colors = {"SVD": LATIN, "PGD": DISPLACEMENT, "clips": ERROR}
        lines = {
            name: [made.line("x", "y", source=self.curves[name], color=color, width=2.5)]
            for name, color in colors.items()
        }
        lines["clips"].append(
            made.scatter(
                "x", "y", source=self.alone, size=11, line_color=ERROR, line_width=2.5, fill_alpha=0
            )
        )
        table = made.vspan(
            "x", source=self.table, color=REFERENCE, line_dash="dashed", line_width=1.5
        )
        self._key = Key(made, {**lines, "whole table": [table]})
        hover(
            made,
            [line for each in lines.values() for line in each],
            {"numbers": "@x", "error": "@y"},
        )
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show how the error falls with each way to keep the friction."""
        clips = frame.extras.get("clips")
        if clips is None:
            return
        ways = {name: clips[name] for name in self.curves}
        largest = max(float(way[0].max()) for way in ways.values() if way is not None)
        smallest = min(
            float(way[0][way[0] > 0].min(initial=clips["table"]))
            for way in ways.values()
            if way is not None
        )
        self._x.decades(frame.run.number, max(smallest, 1.0), min(largest, 10.0 * clips["table"]))
        for name, way in ways.items():
            x, y = (np.zeros(0), np.zeros(0)) if way is None else _shown(way)
            put(self.curves[name], x=x, y=y)
        numbers, missed = (float(part) for part in clips["clips"][:, 0])
        put(self.alone, x=[max(numbers, 1.0)], y=[max(missed, 1.6 * FLOOR)])
        put(self.table, x=[float(clips["table"])])
        said = "exact" if missed <= EXACT else percent(missed)
        self._key.show(
            {
                "PGD": "" if clips["PGD"] is None else "PGD",
                "clips": f"clips, {clips['branches']} × 2 vectors: {said}",
            }
        )


def _shown(way: Floats) -> Floats:
    """Errors from the first number on, down to the first that is as good as none, (2, n)."""
    some = way[:, way[0] > 0]
    below = np.flatnonzero(some[1] <= FLOOR)
    some = some[:, : int(below[0]) + 1 if len(below) else None]
    return np.maximum(some, np.array([[0.0], [FLOOR]], dtype=np.float32))
