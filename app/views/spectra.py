"""Singular values of the friction force in every substructure, and those of a separated basis."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.models import FixedTicker, LinearColorMapper, Range1d
from bokeh.palettes import Viridis256

from app.views.drawing import (
    GREY,
    VERMILION,
    Picture,
    color_bar,
    decades,
    empty,
    make_figure,
    mark_decades,
    round_up,
    set_range,
)
from app.views.legend import Key
from app.worker.shown import Bases
from solver.settings import Settings

FLOOR = 1e-8


class Spectra:
    """How fast the singular values fall, substructure by substructure.

    Rings are the sizes of the chosen separated basis's modes; crosses are the singular values of
    the field that it has to hold.
    """

    name = "Singular values"
    watches = "spectra"
    keys: Sequence[Key] = ()

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
        self._basis = empty("x", "y")
        self._wanted = empty("x", "y")
        self._mapper = LinearColorMapper(palette=Viridis256[55:235], low=1, high=2)
        self.figure.multi_line(
            "xs",
            "ys",
            source=self._lines,
            line_width=2.5,
            line_color={"field": "number", "transform": self._mapper},
        )
        self.figure.scatter(
            "x", "y", source=self._wanted, marker="x", size=9, line_color=GREY, line_width=2
        )
        self.figure.scatter(
            "x",
            "y",
            source=self._basis,
            marker="circle",
            size=11,
            fill_color=None,
            line_color=VERMILION,
            line_width=2,
        )
        self._marks = FixedTicker(ticks=[1, 2])
        color_bar(self.figure, self._mapper, self._marks, "substructure")

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
        total = picture.run.settings.n_substructures
        if count < total:
            numbers = np.linspace(1, total, count).round().astype(int)
        if self._mapper.high != max(total, 2):
            self._mapper.high = max(total, 2)
            marks = sorted({int(mark) for mark in np.linspace(1, total, min(total, 5)).round()})
            self._marks.ticks = marks
        largest = float(np.nanmax(spectra, initial=0.0)) or 1.0
        scaled = np.maximum(spectra / largest, 1e-30)
        more = self._draw_basis(frame.bases)
        low, _ = decades([*scaled[np.isfinite(scaled)].tolist(), *more], FLOOR)
        set_range(self.figure.y_range, low, 2.0)
        mark_decades(self.figure.yaxis[0], self.figure.y_range)
        set_range(self.figure.x_range, 0.5, round_up(max(width, len(more))) + 0.5)
        modes = np.arange(1, width + 1)
        self._lines.data = {
            "xs": [modes] * count,
            "ys": list(scaled),
            "number": numbers,
        }

    def _draw_basis(self, bases: Bases | None) -> list[float]:
        """Draw the sizes of the chosen basis's modes, if there is one; give what it has to hold."""
        values = bases.values if bases else None
        if bases is None or values is None:
            if self.keys:
                self.keys = ()
                self._basis.data = self._wanted.data = {"x": [], "y": []}
            return []
        for source, sizes in ((self._basis, values.basis), (self._wanted, values.wanted)):
            source.data = {"x": np.arange(1, len(sizes) + 1), "y": np.maximum(sizes, 1e-30)}
        self.keys = (
            Key(VERMILION, "ring", f"PGD, sub. {bases.substructure + 1}"),
            Key(GREY, "cross", "its field"),
        )
        return [float(size) for size in values.wanted]
