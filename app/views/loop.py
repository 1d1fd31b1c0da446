"""Force against displacement at the loaded end."""

from __future__ import annotations

from collections.abc import Sequence

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
    round_up,
    set_range,
)
from app.worker.protocol import Frame, Reference
from app.worker.rivals import has_reference
from solver.settings import Settings

Curve = tuple[np.ndarray, np.ndarray]
ROUND = 20.0
"""Steps of an axis, for one decade at most, on which limits stand that follow the iterates."""


KEYS = (
    Key(BLUE, "line", "LATIN"),
    Key(ORANGE, "line", "reference"),
    Key(SKY, "line", "run before"),
)


class Loop:
    """The hysteresis loop: what is inside it is dissipated."""

    name = "Hysteresis loop"
    watches = ""
    keys: Sequence[Key] = KEYS

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
        x, y = _curve(run, frame)
        settled = _settled(run)
        limits = (_around(x, ROUND), _around(y, ROUND)) if settled is None else ()
        known = (run.ticket, run.reference is None, limits)
        if known != self._drawn:
            self._drawn = known
            self._draw_base(picture, settled or (x, y))
            if settled is None:
                for axis, ends, scale in zip(
                    (self.figure.x_range, self.figure.y_range), limits, self._scales, strict=True
                ):
                    set_range(axis, ends[0] / scale, ends[1] / scale)
        across, up = self._scales
        x, y = x / across, y / up
        self._line.data = {"x": x, "y": y}
        time = run.begun.instants[picture.instant]
        all_instants = run.begun.all_instants
        self._point.data = {
            "x": [float(np.interp(time, all_instants, x))],
            "y": [float(np.interp(time, all_instants, y))],
        }

    def _draw_base(self, picture: Picture, shown: Curve) -> None:
        run = picture.run
        assert run.begun is not None
        labels = []
        for values, (title, unit) in zip(
            shown, (run.begun.loop.across, run.begun.loop.up), strict=True
        ):
            size = float(np.abs(values).max())
            factor, shown_unit = decimal_scale(size, unit) if unit else _of_angle(size)
            labels.append((factor, f"{title} ({shown_unit})"))
        (across, across_label), (up, up_label) = labels
        self._scales = across, up
        self.figure.xaxis[0].axis_label = across_label
        self.figure.yaxis[0].axis_label = up_label
        set_range(self.figure.x_range, *_around(shown[0] / across))
        set_range(self.figure.y_range, *_around(shown[1] / up))
        self._reference.data = self._scaled(_settled(run) if run.reference else None)
        self._ghost.data = self._scaled(_last(picture.before) if picture.before else None)

        self.keys = KEYS if has_reference(run.settings) else (KEYS[0], KEYS[2])

    def _scaled(self, curve: Curve | None) -> dict[str, object]:
        if curve is None:
            return {"x": [], "y": []}
        return {"x": curve[0] / self._scales[0], "y": curve[1] / self._scales[1]}


def _curve(run: Recording, fields: Frame | Reference) -> Curve:
    """Give displacement and force of an iterate or a reference."""
    assert run.begun is not None
    load = run.begun.load if fields.load is None else fields.load
    assert load is not None
    return fields.end_displacement, load


def _settled(run: Recording) -> Curve | None:
    """Give the loop that the run should come to, where it is known."""
    if run.reference is not None:
        return _curve(run, run.reference)
    if run.begun is None or run.begun.closed_form_end is None or run.begun.load is None:
        return None
    return run.begun.closed_form_end, run.begun.load


def _last(run: Recording) -> Curve | None:
    """Give the loop that a run should have come to, or else the one it came to."""
    settled = _settled(run)
    if settled is not None or run.newest is None or run.begun is None:
        return settled
    return _curve(run, run.newest)


def _of_angle(size: float) -> tuple[float, str]:
    return (1e-3, "mrad") if size < 0.5 else (1.0, "rad")


def _around(values: np.ndarray, steps: float = 0.0) -> tuple[float, float]:
    """Give the ends of an axis with room around values; to whole steps, if any."""
    low, high = min(float(values.min()), 0.0), max(float(values.max()), 0.0)
    margin = 0.12 * (high - low) or 1.0
    if not steps:
        return low - margin, high + margin
    step = round_up(high - low or 1.0) / steps
    return (
        float(np.floor((low - 0.3 * margin) / step) * step),
        float(np.ceil((high + 0.3 * margin) / step) * step),
    )
