"""Singular values of the friction force in every substructure."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColorBar, FixedTicker, LinearColorMapper, Range1d
from bokeh.palettes import Viridis256

from app.views.drawing import (
    Picture,
    decades,
    empty,
    make_figure,
    mark_decades,
    round_up,
    set_range,
)
from solver.settings import Settings

FLOOR = 1e-8


class Spectra:
    """How fast the singular values fall, substructures numbered from the clamp."""

    name = "Singular values"
    watches = "spectra"
    keys = ()

    def __init__(self) -> None:
        self.figure = make_figure(
            "Mode n",
            "Singular value / largest",
            x_range=Range1d(0.5, 10.5),
            y_range=Range1d(1e-6, 2),
            y_axis_type="log",
            tools="hover",
            tooltips=[("substructure", "@number")],
        )
        self._lines = empty("xs", "ys", "number")
        self._mapper = LinearColorMapper(palette=Viridis256[55:235], low=1, high=2)
        self.figure.multi_line(
            "xs",
            "ys",
            source=self._lines,
            line_width=2.5,
            line_color={"field": "number", "transform": self._mapper},
        )
        self._marks = FixedTicker(ticks=[1, 2])
        bar = ColorBar(
            ticker=self._marks,
            color_mapper=self._mapper,
            title="sub.",
            width=10,
            padding=4,
            title_text_font_size="12px",
            major_label_text_font_size="12px",
        )
        self.figure.add_layout(bar, "right")

    def applies(self, settings: Settings) -> bool:
        """One instant has one singular value."""
        return int(settings.values()["instants"]) > 1

    def draw(self, picture: Picture) -> None:
        """Draw the spectra of the shown iterate, each over the largest of all."""
        frame = picture.frame
        if frame is None or frame.spectra is None:
            return
        spectra = frame.spectra
        count, width = spectra.shape
        numbers = np.arange(1, count + 1)
        total = int(picture.run.settings.values()["substructures"])
        if count < total:
            numbers = np.linspace(1, total, count).round().astype(int)
        if self._mapper.high != max(total, 2):
            self._mapper.high = max(total, 2)
            marks = sorted({int(mark) for mark in np.linspace(1, total, min(total, 5)).round()})
            self._marks.ticks = marks
        largest = float(np.nanmax(spectra)) or 1.0
        scaled = np.maximum(spectra / largest, 1e-30)
        low, _ = decades(scaled[np.isfinite(scaled)].tolist(), FLOOR)
        set_range(self.figure.y_range, low, 2.0)
        mark_decades(self.figure.yaxis[0], self.figure.y_range)
        set_range(self.figure.x_range, 0.5, round_up(width) + 0.5)
        modes = np.arange(1, width + 1)
        self._lines.data = {
            "xs": [modes] * count,
            "ys": list(scaled),
            "number": numbers,
        }
