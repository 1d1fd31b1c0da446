"""Friction force along the bar at the chosen instant."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.models import Range1d, Span

from app.views.drawing import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    SKY,
    Picture,
    decimal_scale,
    empty,
    length_of,
    make_figure,
    set_range,
)
from app.views.legend import Key
from solver.scenes.plane import PlaneSettings
from solver.settings import Settings

LATIN = Key(BLUE, "line", "LATIN")
BOUND = Key(GREY, "dashed", "±μp")


class FrictionForce:
    """The force per length, with its bounds, the reference, the closed form and the ghost."""

    name = "Friction force"
    watches = ""
    keys: Sequence[Key] = (LATIN, BOUND)

    def __init__(self) -> None:
        self.figure = make_figure(
            "Position x (m)", "Friction force (N/m)", x_range=Range1d(0, 1), y_range=Range1d(-1, 1)
        )
        self._base = empty("x", "upper", "lower", "reference", "closed")
        self._line = empty("x", "y")
        self._ghost = empty("x", "y")
        self._cuts = empty("x")
        self._drawn: tuple[object, ...] = ()
        self._factor = 1.0
        made = self.figure
        made.vspan("x", source=self._cuts, line_color=GREY, line_alpha=0.35, line_width=1)
        for name in ("upper", "lower"):
            made.line(
                "x", name, source=self._base, line_color=GREY, line_dash="dashed", line_width=1.5
            )
        made.line("x", "closed", source=self._base, line_color=GREEN, line_width=6, line_alpha=0.35)
        made.line("x", "y", source=self._ghost, line_color=SKY, line_width=2)
        made.line(
            "x", "reference", source=self._base, line_color=ORANGE, line_width=4, line_alpha=0.8
        )
        made.line("x", "y", source=self._line, line_color=BLUE, line_width=2.5)
        self._zero = Span(location=0, dimension="width", line_color=GREY, line_alpha=0.4)
        made.add_layout(self._zero)

    def applies(self, settings: Settings) -> bool:
        """Plane bodies have no bound that is known beforehand, and tractions instead."""
        return not isinstance(settings, PlaneSettings)

    def draw(self, picture: Picture) -> None:
        """Draw the profiles of the chosen instant."""
        run, frame = picture.run, picture.frame
        if run.begun is None or frame is None or frame.ticket != run.ticket:
            return
        begun = run.begun
        if begun.bound is None:
            return
        found = (run.reference is None, begun.closed_form is None)
        known = (run.ticket, begun.interface, *found, picture.instant)
        if known != self._drawn:
            self._drawn = known
            self._draw_base(picture)
        self._line.data = {
            "x": begun.positions,
            "y": frame.friction[:, picture.instant] / self._factor,
        }

    def _draw_base(self, picture: Picture) -> None:
        begun, run = picture.run.begun, picture.run
        assert begun is not None
        assert begun.bound is not None
        nothing = np.full(len(begun.positions), np.nan, dtype=np.float32)
        top = float(begun.bound.max()) or 1.0
        self._factor, unit = decimal_scale(top, "N/m")
        if self.figure.yaxis[0].axis_label != f"Friction force ({unit})":
            self.figure.yaxis[0].axis_label = f"Friction force ({unit})"
        set_range(self.figure.y_range, -1.25 * top / self._factor, 1.25 * top / self._factor)
        set_range(self.figure.x_range, 0.0, length_of(run.settings))
        self._base.data = {
            "x": begun.positions,
            "upper": begun.bound / self._factor,
            "lower": -begun.bound / self._factor,
            "reference": run.reference.friction[:, picture.instant] / self._factor
            if run.reference
            else nothing,
            "closed": begun.closed_form[:, picture.instant] / self._factor
            if begun.closed_form is not None
            else nothing,
        }
        self._cuts.data = {"x": begun.cuts}
        ghost = self._profile_before(picture)
        self._ghost.data = ghost or {"x": [], "y": []}
        self.keys = (
            LATIN,
            *((Key(ORANGE, "line", "reference"),) if run.reference else ()),
            *((Key(GREEN, "band", "closed form"),) if begun.closed_form is not None else ()),
            *((Key(SKY, "line", "run before"),) if ghost else ()),
            BOUND,
        )

    def _profile_before(self, picture: Picture) -> dict[str, np.ndarray] | None:
        before = picture.before
        assert picture.run.begun is not None
        other = before is None or before.newest is None or before.begun is None
        if other or before.newest.interface != picture.run.begun.interface:
            return None
        count = before.newest.friction.shape[1]
        phase = picture.instant / max(len(picture.run.begun.instants) - 1, 1)
        instant = round(phase * (count - 1))
        return {
            "x": before.begun.positions,
            "y": before.newest.friction[:, instant] / self._factor,
        }
