"""Force against displacement at the loaded end."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from bokeh.models import Range1d

from app.recording import Recording
from app.views.drawing import (
    BLUE,
    ORANGE,
    SKY,
    VERMILION,
    Limits,
    Picture,
    decimal_scale,
    empty,
    held,
    make_figure,
    set_range,
)
from app.views.legend import Key
from app.worker.reports import Frame, Reference
from app.worker.shown import Axes
from solver.settings import Settings

Curve = tuple[np.ndarray, np.ndarray]


LATIN = Key(BLUE, "line", "LATIN")
STILL = 1e-6
"""Displacement that an axis reaches where nothing moves, m."""


class Loop:
    """The hysteresis loop: what is inside it is dissipated."""

    name = "Hysteresis loop"
    watches = ""
    keys: Sequence[Key] = (LATIN,)

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
        self._across: Limits | None = None
        self._up: Limits | None = None
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
        if settled is None:
            self._across, self._up = _held(self._across, x), _held(self._up, y)
        else:
            axes = run.begun.loop
            self._across, self._up = (
                _around(values, unit)
                for values, (_, unit) in zip(settled, (axes.across, axes.up), strict=True)
            )
        known = (run.ticket, run.reference is None, self._across, self._up)
        if known != self._drawn:
            self._drawn = known
            self._draw_base(picture)
        across, up = self._scales
        x, y = x / across, y / up
        self._line.data = {"x": x, "y": y}
        time = run.begun.instants[picture.instant]
        all_instants = run.begun.all_instants
        self._point.data = {
            "x": [float(np.interp(time, all_instants, x))],
            "y": [float(np.interp(time, all_instants, y))],
        }

    def _draw_base(self, picture: Picture) -> None:
        run, made = picture.run, self.figure
        assert run.begun is not None
        assert self._across is not None
        assert self._up is not None
        axes = run.begun.loop
        self._scales = (
            _label(made.xaxis[0], made.x_range, axes.across, self._across),
            _label(made.yaxis[0], made.y_range, axes.up, self._up),
        )
        reference = _curve(run, run.reference) if run.reference else None
        ghost = _newest(picture.before, axes) if picture.before else None
        self._reference.data = self._scaled(reference)
        self._ghost.data = self._scaled(ghost)
        self.keys = (
            LATIN,
            *((Key(ORANGE, "line", "reference"),) if reference else ()),
            *((Key(SKY, "line", "run before"),) if ghost else ()),
        )

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


def _newest(run: Recording, axes: Axes) -> Curve | None:
    """Give the loop that a run came to, where it is one of the same quantities."""
    if run.newest is None or run.begun is None or run.begun.loop != axes:
        return None
    return _curve(run, run.newest)


def _of_angle(size: float) -> tuple[float, str]:
    return (1e-3, "mrad") if size < 0.5 else (1.0, "rad")


def _label(axis: Any, scale: Range1d, quantity: tuple[str, str], limits: Limits) -> float:
    """Put limits and a unit that suits them on an axis; give the factor of the unit."""
    title, unit = quantity
    size = max(-limits[0], limits[1])
    factor, shown = decimal_scale(size, unit) if unit else _of_angle(size)
    if axis.axis_label != f"{title} ({shown})":
        axis.axis_label = f"{title} ({shown})"
    set_range(scale, limits[0] / factor, limits[1] / factor)
    return factor


def _held(old: Limits | None, values: np.ndarray) -> Limits:
    return held(old, float(values.min()), float(values.max()))


def _around(values: np.ndarray, unit: str) -> Limits:
    low, high = min(float(values.min()), 0.0), max(float(values.max()), 0.0)
    margin = 0.12 * (high - low) or (STILL if unit == "m" else 1.0)
    return low - margin, high + margin
