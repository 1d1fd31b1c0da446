"""Force against displacement at the loaded end."""

from __future__ import annotations

import numpy as np
from bokeh.models import Range1d

from app.recording import Recording
from app.views.drawing import (
    BLUE,
    ORANGE,
    SKY,
    VERMILION,
    Key,
    Picture,
    decimal_scale,
    empty,
    make_figure,
    set_range,
)
from solver.settings import Settings


class Loop:
    """The hysteresis loop: what is inside it is dissipated."""

    name = "Loop at the end"
    watches = ""
    keys = (
        Key(BLUE, "line", "LATIN"),
        Key(ORANGE, "line", "reference"),
        Key(SKY, "line", "run before"),
    )

    def __init__(self) -> None:
        self.figure = make_figure(
            "End displacement (mm)", "Force (N)", x_range=Range1d(-1, 1), y_range=Range1d(-1, 1)
        )
        self._line = empty("x", "y")
        self._reference = empty("x", "y")
        self._ghost = empty("x", "y")
        self._point = empty("x", "y")
        self._drawn: tuple[object, ...] = ()
        self._scales = (1.0, 1.0)
        made = self.figure
        made.line(
            "x",
            "y",
            source=self._ghost,
            line_color=SKY,
            line_width=2,
        )
        made.line(
            "x",
            "y",
            source=self._reference,
            line_color=ORANGE,
            line_width=4,
            line_alpha=0.8,
        )
        made.line("x", "y", source=self._line, line_color=BLUE, line_width=2.5)
        made.scatter("x", "y", source=self._point, size=11, color=VERMILION)

    def applies(self, settings: Settings) -> bool:
        """Tell whether there is more than one instant to make a loop of."""
        return int(settings.values()["instants"]) > 1

    def draw(self, picture: Picture) -> None:
        """Draw the loop of the shown iterate."""
        run, frame = picture.run, picture.frame
        if run.begun is None or frame is None or frame.ticket != run.ticket:
            return
        known = (run.ticket, run.reference is None)
        if known != self._drawn:
            self._drawn = known
            self._draw_base(picture)
        across, up = self._scales
        x, y = frame.end_displacement / across, run.begun.load / up
        self._line.data = {"x": x, "y": y}
        time = run.begun.instants[picture.instant]
        all_instants = run.begun.all_instants
        self._point.data = {
            "x": [float(np.interp(time, all_instants, x))],
            "y": [float(np.interp(time, all_instants, y))],
        }

    def _draw_base(self, picture: Picture) -> None:
        run = picture.run
        assert run.begun is not None
        assert picture.frame is not None
        ends = _end(run)
        ends = picture.frame.end_displacement if ends is None else ends
        width, height = float(np.abs(ends).max()), float(np.abs(run.begun.load).max())
        (across, unit_x), (up, unit_y) = decimal_scale(width, "m"), decimal_scale(height, "N")
        self._scales = across, up
        self.figure.xaxis[0].axis_label = f"End displacement ({unit_x})"
        self.figure.yaxis[0].axis_label = f"Force ({unit_y})"
        set_range(self.figure.x_range, *_around(ends / across))
        set_range(self.figure.y_range, *_around(run.begun.load / up))
        self._reference.data = self._curve(run) if run.reference else {"x": [], "y": []}
        self._ghost.data = self._curve(picture.before) if picture.before else {"x": [], "y": []}

    def _curve(self, run: Recording) -> dict[str, object]:
        end = _end(run)
        if end is None or run.begun is None:
            return {"x": [], "y": []}
        return {"x": end / self._scales[0], "y": run.begun.load / self._scales[1]}


def _end(run: Recording) -> np.ndarray | None:
    if run.reference is not None:
        return run.reference.end_displacement
    return run.begun.closed_form_end if run.begun else None


def _around(values: np.ndarray) -> tuple[float, float]:
    low, high = min(float(values.min()), 0.0), max(float(values.max()), 0.0)
    margin = 0.12 * (high - low) or 1.0
    return low - margin, high + margin
