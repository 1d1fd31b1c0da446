"""Axial force in the wires of a strand at the chosen instant."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.models import Range1d

from app.views.drawing import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    Limits,
    Picture,
    decimal_scale,
    empty,
    held,
    length_of,
    make_figure,
    set_range,
)
from app.views.legend import Key
from app.worker.shown import Wires
from solver.scenes.strand import StrandSettings
from solver.settings import Settings

SHARED = 1.5
"""Times the tension: what neighbours take over from a wire between two others."""
WIRE_COLORS = (BLUE, ORANGE, PURPLE, SKY, GREY)


class Axial:
    """The force along every wire; the broken one regains it from its break on."""

    name = "Force in the wires"
    watches = "axial"
    keys: Sequence[Key] = ()

    def __init__(self) -> None:
        self.figure = make_figure(
            "Position x (m)", "Axial force (N)", x_range=Range1d(0, 1), y_range=Range1d(-1, 1)
        )
        self._lines = empty("xs", "ys", "color", "width")
        self._exact = empty("xs", "ys")
        made = self.figure
        made.multi_line(
            "xs", "ys", source=self._exact, line_color=GREEN, line_width=6, line_alpha=0.35
        )
        made.multi_line("xs", "ys", source=self._lines, line_color="color", line_width="width")
        self._factor = 1.0
        self._limits: Limits | None = None

    def applies(self, settings: Settings) -> bool:
        """Tell whether there are wires."""
        return isinstance(settings, StrandSettings)

    def draw(self, picture: Picture) -> None:
        """Draw the forces of the shown iterate."""
        begun, frame = picture.run.begun, picture.frame
        if begun is None or begun.wires is None or frame is None or frame.axial is None:
            return
        wires, axial = begun.wires, frame.axial
        if axial.force.shape != (len(wires.numbers), len(wires.positions)):
            return
        self._scale(picture)
        exact = self._exact_forces(wires, axial.instant)
        self._exact.data = {"xs": [wires.exact_positions] * len(exact), "ys": exact}
        colors = [_color(number, wires) for number in wires.numbers]
        broken = [number == wires.broken for number in wires.numbers]
        order = np.argsort(broken, kind="stable")
        self._lines.data = {
            "xs": [wires.positions] * len(order),
            "ys": [axial.force[place] / self._factor for place in order],
            "color": [colors[place] for place in order],
            "width": [3.5 if broken[place] else 2.0 for place in order],
        }
        self.keys = _keys(wires, len(exact) > 0)

    def _exact_forces(self, wires: Wires, instant: int) -> list[np.ndarray]:
        if wires.exact is None or instant >= wires.exact.shape[2]:
            return []
        return list(wires.exact[:, :, instant] / self._factor)

    def _scale(self, picture: Picture) -> None:
        """Hold the scale over all instants: the largest tension, and what a break adds to it."""
        begun, frame = picture.run.begun, picture.frame
        assert begun is not None
        assert frame is not None
        load = begun.load if begun.load is not None else frame.load
        assert load is not None
        assert frame.axial is not None
        force = frame.axial.force
        top = max(SHARED * float(np.abs(load).max()), float(force.max()))
        self._limits = held(self._limits, min(-0.1 * top, float(force.min())), top)
        self._factor, unit = decimal_scale(self._limits[1], "N")
        if self.figure.yaxis[0].axis_label != f"Axial force ({unit})":
            self.figure.yaxis[0].axis_label = f"Axial force ({unit})"
        set_range(self.figure.y_range, *(limit / self._factor for limit in self._limits))
        set_range(self.figure.x_range, 0.0, length_of(picture.run.settings))


def _color(number: int, wires: Wires) -> str:
    if number == wires.broken:
        return VERMILION
    return WIRE_COLORS[(number - 1) % len(WIRE_COLORS)]


def _keys(wires: Wires, is_exact: bool) -> tuple[Key, ...]:
    shown = wires.numbers[:5]
    if wires.broken and wires.broken not in shown:
        shown = (*shown[:4], wires.broken)
    return (
        *(
            Key(
                _color(number, wires),
                "line",
                f"{number}{', broken' if number == wires.broken else ''}",
            )
            for number in shown
        ),
        *((Key(GREEN, "band", "closed form"),) if is_exact else ()),
    )
