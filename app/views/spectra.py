"""Singular values of the friction force in every substructure."""

from __future__ import annotations

import numpy as np
from bokeh.models import Range1d
from bokeh.palettes import Viridis256
from bokeh.plotting import figure

from app.frame import Frame, Selection
from app.views.view import View, plot, source

LEAST = 1e-4


class Spectra(View):
    """One curve a substructure: how fast it falls says how many modes it needs."""

    name = "Singular values"
    needs = frozenset({"spectra"})

    def make(self) -> figure:
        """A new figure."""
        made = plot("mode", "size / largest", y_axis_type="log", y_range=Range1d(LEAST, 2))
        self.values = source("xs", "ys", "color")
        made.multi_line("xs", "ys", color="color", source=self.values, width=1.5)
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the singular values, as far as the frame has them."""
        spectra = frame.extras.get("spectra", [])
        step = 255 // max(len(spectra) - 1, 1)
        self.values.data = {
            "xs": [np.arange(1, len(values) + 1) for values in spectra],
            "ys": [np.maximum(values, 0.1 * LEAST) for values in spectra],
            "color": [Viridis256[place * step] for place in range(len(spectra))],
        }
