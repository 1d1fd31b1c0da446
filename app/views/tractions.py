"""Pressure and friction along an interface at the chosen instant."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.models import Range1d

from app.recording import Recording
from app.views.drawing import (
    BLUE,
    GREY,
    ORANGE,
    PURPLE,
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
from app.worker.shown import instant_of
from solver.scenes.plane import PlaneSettings
from solver.settings import Settings

KEYS = (
    Key(PURPLE, "line", "pressure p"),
    Key(BLUE, "line", "friction"),
    Key(GREY, "dashed", "±μp"),
)


class Tractions:
    """Both tractions on the body above, with the bound that the pressure gives to friction."""

    name = "Contact tractions"
    watches = ""
    keys: Sequence[Key] = KEYS

    def __init__(self) -> None:
        self.figure = make_figure(
            "Position x (m)", "Traction (Pa)", x_range=Range1d(0, 1), y_range=Range1d(-1, 1)
        )
        self._now = empty("x", "pressure", "friction", "upper", "lower")
        self._reference = empty("x", "pressure", "friction")
        self._ghost = empty("x", "pressure", "friction")
        self._cuts = empty("x")
        self._drawn: tuple[object, ...] = ()
        self._factor = 1.0
        self._limits: Limits | None = None
        made = self.figure
        made.vspan("x", source=self._cuts, line_color=GREY, line_alpha=0.35, line_width=1)
        colors = (("pressure", PURPLE), ("friction", BLUE))
        for name, color in colors:
            made.line("x", name, source=self._ghost, line_color=color, line_width=2, line_alpha=0.4)
        for name, _ in colors:
            made.line(
                "x", name, source=self._reference, line_color=ORANGE, line_width=4, line_alpha=0.8
            )
        for name in ("upper", "lower"):
            made.line(
                "x", name, source=self._now, line_color=GREY, line_dash="dashed", line_width=1.5
            )
        for name, color in colors:
            made.line("x", name, source=self._now, line_color=color, line_width=2.5)

    def applies(self, settings: Settings) -> bool:
        """Plane bodies press on each other as they deform."""
        return isinstance(settings, PlaneSettings)

    def draw(self, picture: Picture) -> None:
        """Draw the profiles of the chosen instant, to the scale of all instants."""
        run, frame = picture.run, picture.frame
        if run.begun is None or frame is None or frame.pressure is None:
            return
        begun = run.begun
        if begun.coefficient is None:
            return
        largest_bound = float((begun.coefficient[:, None] * frame.pressure).max())
        self._scale(frame.pressure, frame.friction, largest_bound)
        known = (run.ticket, begun.interface, run.reference is None, picture.instant, self._factor)
        if known != self._drawn:
            self._drawn = known
            self._draw_base(picture)
        pressure = frame.pressure[:, picture.instant] / self._factor
        bound = begun.coefficient * np.maximum(pressure, 0.0)
        self._now.data = {
            "x": begun.positions,
            "pressure": pressure,
            "friction": frame.friction[:, picture.instant] / self._factor,
            "upper": bound,
            "lower": -bound,
        }

    def _scale(self, pressure: np.ndarray, friction: np.ndarray, bound: float) -> None:
        """Hold all instants."""
        low = float(min(pressure.min(), friction.min(), -bound))
        high = float(max(pressure.max(), friction.max(), bound))
        self._limits = held(self._limits, low, high)
        self._factor, unit = decimal_scale(max(-self._limits[0], self._limits[1]), "Pa")
        if self.figure.yaxis[0].axis_label != f"Traction ({unit})":
            self.figure.yaxis[0].axis_label = f"Traction ({unit})"
        set_range(self.figure.y_range, *(limit / self._factor for limit in self._limits))

    def _draw_base(self, picture: Picture) -> None:
        begun, run = picture.run.begun, picture.run
        assert begun is not None
        set_range(self.figure.x_range, 0.0, length_of(run.settings))
        self._cuts.data = {"x": begun.cuts}
        nothing: dict[str, object] = {"x": [], "pressure": [], "friction": []}
        found = run.reference
        self._reference.data = nothing
        if found is not None and found.pressure is not None:
            self._reference.data = {
                "x": begun.positions,
                "pressure": found.pressure[:, picture.instant] / self._factor,
                "friction": found.friction[:, picture.instant] / self._factor,
            }
        before = self._profiles_before(picture.before, picture)
        self._ghost.data = before or nothing
        self.keys = (
            *KEYS,
            *((Key(ORANGE, "line", "reference"),) if found else ()),
            *((Key(BLUE, "pale", "run before"),) if before else ()),
        )

    def _profiles_before(
        self, before: Recording | None, picture: Picture
    ) -> dict[str, np.ndarray] | None:
        begun = picture.run.begun
        assert begun is not None
        if before is None or before.newest is None or before.begun is None:
            return None
        frame = before.newest
        if frame.interface != begun.interface or frame.pressure is None:
            return None
        phase = picture.instant / max(len(begun.instants) - 1, 1)
        instant = instant_of(phase, frame.pressure.shape[1])
        return {
            "x": before.begun.positions,
            "pressure": frame.pressure[:, instant] / self._factor,
            "friction": frame.friction[:, instant] / self._factor,
        }
