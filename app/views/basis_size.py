"""How many modes every substructure's separated basis holds, over the iterations."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from bokeh.events import Pan, Tap
from bokeh.models import FixedTicker, LinearColorMapper, Range1d, Span
from bokeh.palettes import Viridis256

from app.views.drawing import VERMILION, Picture, color_bar, empty, make_figure, round_up, set_range
from app.views.legend import Key
from solver.settings import Settings

MOST_COLUMNS = 240
"""Iterations that are drawn at most; a small plot has no more pixels."""


class BasisSize:
    """The numbers of modes as a map; a tap or a drag chooses the substructure.

    Parameters
    ----------
    choose
        Called with the number of the substructure, counted from 0.
    """

    name = "PGD basis size"
    watches = ""
    keys = (Key(VERMILION, "line", "chosen"),)

    def __init__(self, choose: Callable[[int], None]) -> None:
        self.figure = make_figure(
            "Iteration", "Substructure", x_range=Range1d(0, 20), y_range=Range1d(0.5, 1.5)
        )
        self._image = empty("image", "x", "y", "dw", "dh")
        self._mapper = LinearColorMapper(palette=Viridis256, low=0, high=2)
        self._marks = FixedTicker(ticks=[0, 1, 2])
        made = self.figure
        made.grid.visible = False
        made.yaxis[0].ticker.min_interval = 1
        made.image(
            "image",
            x="x",
            y="y",
            dw="dw",
            dh="dh",
            source=self._image,
            color_mapper=self._mapper,
        )
        self._chosen = Span(location=0, dimension="width", line_color=VERMILION, line_width=2)
        self._shown = Span(location=0, dimension="height", line_color=VERMILION, line_width=1)
        made.add_layout(self._chosen)
        made.add_layout(self._shown)
        color_bar(made, self._mapper, self._marks, "modes")
        made.on_event(Tap, lambda event: choose(round(event.y) - 1))
        made.on_event(Pan, lambda event: choose(round(event.y) - 1))

    def applies(self, settings: Settings) -> bool:
        """Only separated bases have modes."""
        return settings.is_reduced

    def draw(self, picture: Picture) -> None:
        """Draw the map of all iterations done."""
        run, frame = picture.run, picture.frame
        if not run.sizes or frame is None or frame.bases is None or frame.ticket != run.ticket:
            return
        done, total = len(run.sizes), run.settings.n_substructures
        columns = np.linspace(0, done - 1, min(done, MOST_COLUMNS)).round().astype(int)
        sizes = np.stack([run.sizes[column] for column in columns], axis=1)
        most = max(int(sizes.max()), 2)
        if self._mapper.high != most:
            self._mapper.high = most
            self._marks.ticks = sorted({int(mark) for mark in np.linspace(0, most, 5).round()})
        set_range(self.figure.x_range, 0, round_up(max(done, 20)))
        set_range(self.figure.y_range, 0.5, total + 0.5)
        self._image.data = {
            "image": [sizes.astype(np.float32)],
            "x": [0.5],
            "y": [0.5],
            "dw": [done],
            "dh": [total],
        }
        chosen = frame.bases.substructure + 1
        for line, at in ((self._chosen, chosen), (self._shown, frame.iteration)):
            if line.location != at:
                line.location = at
