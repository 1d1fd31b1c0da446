"""Separated bases: the largest modes of one substructure, and how many each has."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.models import BasicTicker, ColorBar, ColumnDataSource, LinearColorMapper, Range1d
from bokeh.palettes import Viridis256
from bokeh.plotting import figure

from app.frame import Floats, Frame, Selection
from app.units import unit_for
from app.views.colors import ERROR, RANKS
from app.views.view import Axis, Key, View, extent, plot, put, source, whole
from app.worker.extras import MOST_MODES
from solver.scenes import kind_of
from solver.settings import Settings


class Modes(View):
    """Curves of the largest modes, one colour a rank."""

    needs = frozenset({"modes"})

    def _make(self, x: str, unit: str) -> figure:
        made = plot("", "value / largest", y_range=Range1d(-1.12, 1.12))
        self._x = Axis(made, "x", x, unit)
        self.now, self.modes = source("x"), [source("x", "y") for _ in range(MOST_MODES)]
        made.vspan("x", source=self.now, color=ERROR, line_width=2)
        lines = [
            made.line("x", "y", source=each, color=color, width=2)
            for each, color in list(zip(self.modes, RANKS, strict=False))[::-1]
        ][::-1]
        entries = {str(n): [line] for n, line in enumerate(lines)}
        self._key = Key(made, entries)
        return made

    def _draw(self, x: Floats, values: Floats, names: list[str]) -> None:
        for number, target in enumerate(self.modes):
            if number < len(values):
                put(target, x=x, y=values[number])
            else:
                put(target, x=[], y=[])
        names += [""] * (MOST_MODES - len(names))
        self._key.show({str(n): name for n, name in enumerate(names)})


class SpaceModes(Modes):
    """Displacement modes along the selected substructure."""

    name = "Space modes"

    @staticmethod
    def applies(settings: Settings) -> bool:
        """Whether there are bases, of rods: those of plane bodies are no curves."""
        return settings.applies("pgd_modes") and kind_of(settings) != "plane"

    def make(self) -> figure:
        """A new figure."""
        return self._make("x", "m")

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the modes over the places of the substructure."""
        modes = frame.extras.get("modes")
        if modes is None:
            return
        x, values = modes["x"], modes["space"]
        self._x.rename(f"x ({modes['text']})", "m")
        self._x.hold((frame.run.number, modes["substructure"]), *extent([x]))
        names = [f"mode {n + 1}" if n == 0 else str(n + 1) for n in range(len(values))]
        self._draw(self._x(x), values, names)


class TimeFunctions(Modes):
    """Time functions of the same modes, each over its largest value, which the legend has."""

    name = "Time functions"

    @staticmethod
    def applies(settings: Settings) -> bool:
        """Whether there are bases, and several instants."""
        return settings.applies("pgd_modes") and settings.instants > 1

    def make(self) -> figure:
        """A new figure."""
        return self._make("t", "s")

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the time functions."""
        modes, run = frame.extras.get("modes"), frame.run
        if modes is None:
            return
        self._x.rename(f"t (substructure {modes['substructure'] + 1})", "s")
        self._x.hold(run.number, *extent([run.instants]))
        sizes = np.abs(modes["time"]).max(axis=1, initial=0.0)
        values = modes["time"] / np.where(sizes > 0.0, sizes, 1.0)[:, None]
        names = [unit_for(float(size), "m")(float(size), 2) for size in sizes]
        put(self.now, x=self._x(run.instants[[run.column(selection.phase)]]))
        self._draw(self._x(run.instants), values, names)


class BasisSizes(View):
    """How many modes every substructure has, over the iterations; a tap selects one."""

    name = "Basis size"
    needs = frozenset({"modes"})

    @staticmethod
    def applies(settings: Settings) -> bool:
        """Whether there are bases."""
        return settings.applies("pgd_modes")

    def make(self) -> figure:
        """A new figure."""
        made = plot("iteration", "substructure")
        made.grid.visible = False
        self._x, self._y = Axis(made, "x", "iteration"), Axis(made, "y", "substructure")
        for axis in made.axis:
            whole(axis)
        self.sizes = ColumnDataSource({"image": [], "x": [], "y": [], "dw": [], "dh": []})
        self.chosen = source("y")
        self._colors = LinearColorMapper(palette=Viridis256, low=0, high=2)
        made.image(
            "image", x="x", y="y", dw="dw", dh="dh", source=self.sizes, color_mapper=self._colors
        )
        made.hspan("y", source=self.chosen, color=ERROR, line_width=2)
        ticker = BasicTicker(desired_num_ticks=4, min_interval=1, num_minor_ticks=0)
        bar = ColorBar(color_mapper=self._colors, ticker=ticker, width=6, padding=4, title="modes")
        made.add_layout(bar, "right")
        made.on_event(Tap, self._select)
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the numbers of modes of all iterations so far."""
        sizes, total = frame.history.get("modes"), frame.run.settings.n_substructures
        if sizes is None:
            return
        last = float(frame.history["iteration"][-1])
        put(self.sizes, image=[sizes.T], x=[0.5], y=[0.5], dw=[last], dh=[total])
        self._colors.high = max(2.0, float(sizes.max()))
        self._x.hold(frame.run.number, 0.5, max(last, 20.0) + 0.5)
        self._y.span(0.5, total + 0.5)
        chosen = selection.substructure
        put(self.chosen, y=[total if chosen is None else min(chosen + 1, total)])

    def _select(self, event: Any) -> None:
        total = self.state.settings.n_substructures
        self.state.select(substructure=min(max(round(event.y) - 1, 0), total - 1))
