"""Singular values of the friction force in every substructure."""

from __future__ import annotations

import numpy as np
from bokeh.models import BasicTicker, ColorBar, LinearColorMapper
from bokeh.plotting import figure

from app.frame import Frame, Selection
from app.views.colors import scaled
from app.views.view import Axis, View, hover, plot, put, source, whole
from solver.settings import Settings

LEAST = 1e-4
FEWEST = 8


class Spectra(View):
    """One curve a substructure: how fast it falls says how many modes it needs."""

    name = "Singular values"
    needs = frozenset({"spectra"})

    @staticmethod
    def applies(settings: Settings) -> bool:
        """Whether there are several instants: one has one singular value."""
        return settings.instants > 1

    def make(self) -> figure:
        """A new figure."""
        made = plot("mode", "size / largest", y_axis_type="log", y_range=(LEAST, 2.0))
        whole(made.xaxis[0])
        self._x = Axis(made, "x", "mode")
        self.values = source("xs", "ys", "color")
        lines = made.multi_line("xs", "ys", color="color", source=self.values, width=1.8)
        hover(made, [lines], {"mode": "$x{0}", "size": "$y{0.00e+0}"})
        self._colors = LinearColorMapper(palette=scaled(64), low=1, high=2)
        ticker = BasicTicker(desired_num_ticks=4, min_interval=1, num_minor_ticks=0)
        self._bar = ColorBar(
            color_mapper=self._colors, ticker=ticker, width=8, padding=6, major_tick_line_color=None
        )
        made.add_layout(self._bar, "right")
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the singular values, as far as the frame has them."""
        spectra = frame.extras.get("spectra")
        if spectra is None:
            return
        count = frame.run.settings.n_substructures
        shown = [values[values > 0.1 * LEAST] for values in spectra]
        put(
            self.values,
            xs=[np.arange(1, len(values) + 1) for values in shown],
            ys=shown,
            color=scaled(len(shown)),
        )
        self._x.rename("mode; the colour is the substructure" if count > 1 else "mode", "")
        self._x.hold(frame.run.number, 1.0, float(max([FEWEST, *map(len, shown)])))
        self._bar.visible = count > 1
        self._colors.high = max(count, 2)
