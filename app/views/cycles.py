"""Cycles of a load: their loops, what each takes, and where the last one wears the interface."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from bokeh.models import Range1d
from bokeh.plotting import figure

from app.frame import Frame, Selection
from app.units import unit_for
from app.views.colors import CUT, ERROR, LATIN, SCALE, scaled
from app.views.view import Axis, Key, View, extent, hover, key_of, mark, plot, put, source, whole
from solver.scenes import kind_of
from solver.settings import Settings
from solver.study.quantities.cycles import cycles_in

MOST_LOOPS = 12
"""Loops that are drawn at most; more cannot be told apart."""


@lru_cache(maxsize=64)
def has_cycles(settings: Settings) -> bool:
    """Whether there are cycles to compare."""
    return cycles_in(settings) > 1


def _key(made: figure) -> Key:
    """Legend of the first and the last cycle, and of what becomes of slip."""
    first, last = (mark(made, SCALE[n]) for n in (0, -1))
    text = mark(made, CUT, alpha=0.0)
    return Key(made, {"cycle 1": [first], "last": [last], "text": [text]})


class Cycles(View):
    """Force over displacement from the first cycle to the last, and what becomes of slip."""

    name = "Cycles"
    needs = frozenset({"cycles"})
    applies = staticmethod(has_cycles)

    def make(self) -> figure:
        """A new figure."""
        made = plot("", "")
        self._x, self._y = Axis(made, "x", ""), Axis(made, "y", "")
        self.loops, self.now = source("xs", "ys", "color"), source("x", "y")
        made.multi_line("xs", "ys", color="color", source=self.loops, width=2)
        made.scatter("x", "y", source=self.now, color=ERROR, size=10)
        self._key = _key(made)
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the loop of each cycle."""
        cycles, run, loop = frame.extras.get("cycles"), frame.run, frame.loop
        if cycles is None:
            return
        self._x.rename(*run.across)
        self._y.rename(*run.up)
        for axis, values in ((self._x, loop[0]), (self._y, loop[1])):
            axis.hold(key_of(run), *extent([values]), 0.08)
        x, y = self._x(loop[0]), self._y(loop[1])
        colors, columns = scaled(len(cycles["energy"])), cycles["columns"]
        count = len(colors)
        shown = np.unique(np.linspace(0, count - 1, min(count, MOST_LOOPS)).round().astype(int))
        parts = [slice(columns[n], columns[n + 1] + 1) for n in shown]
        put(
            self.loops,
            xs=[x[part] for part in parts],
            ys=[y[part] for part in parts],
            color=[colors[n] for n in shown],
        )
        now = [run.column(selection.phase)]
        put(self.now, x=x[now], y=y[now])
        self._key.show({"last": f"cycle {count}", "text": cycles["text"]})


class CycleEnergy(View):
    """Energy that friction takes in every cycle."""

    name = "Energy a cycle"
    needs = frozenset({"cycles"})
    applies = staticmethod(has_cycles)

    def make(self) -> figure:
        """A new figure."""
        made = plot("cycle", "")
        whole(made.xaxis[0])
        self._x, self._y = Axis(made, "x", "cycle"), Axis(made, "y", "energy", "J")
        self.bars = source("x", "top", "color")
        bars = made.vbar("x", 0.7, "top", source=self.bars, color="color")
        self._key = _key(made)
        hover(made, [bars], {"cycle": "@x", "energy": "@top{0.000}"})
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show a bar for each cycle."""
        cycles = frame.extras.get("cycles")
        if cycles is None:
            return
        energy = cycles["energy"]
        count = len(energy)
        self._x.span(0.5, count + 0.5)
        low, high = extent([energy])
        self._y.hold(key_of(frame.run), min(low, 0.0), max(1.1 * high, 0.0))
        x = np.arange(1, count + 1)
        put(self.bars, x=x, top=self._y(energy), color=scaled(count))
        self._key.show({"last": f"cycle {count}", "text": cycles["text"]})


class Fretting(View):
    """Slip and friction work of the last cycle along the interface."""

    name = "Fretting"
    needs = frozenset({"cycles"})
    applies = staticmethod(has_cycles)

    def make(self) -> figure:
        """A new figure."""
        made = plot("", "share of peak", y_range=Range1d(0.0, 1.1))
        self._x = Axis(made, "x", "x", "m")
        self.values = source("x", "slip", "work")
        work = made.line("x", "work", source=self.values, color=ERROR, width=4, alpha=0.7)
        slip = made.line("x", "slip", source=self.values, color=LATIN, width=2)
        self._key = Key(made, {"work": [work], "slip": [slip]})
        hover(made, [slip], {"x": "@x{0.000}", "slip": "@slip{0.000}", "work": "@work{0.000}"})
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show both, each over its largest value, which the legend has."""
        cycles, run = frame.extras.get("cycles"), frame.run
        if cycles is None:
            return
        name = selection.interface_of(run)
        x = run.interfaces[name].positions
        if len(x) != len(cycles["slip"]):
            return
        self._x.hold((run.number, name), *extent([x]))
        peaks = {name: float(cycles[name].max(initial=0.0)) for name in ("slip", "work")}
        shares = {name: cycles[name] / (peak or 1.0) for name, peak in peaks.items()}
        put(self.values, x=self._x(x), **shares)
        work = "J/m²" if kind_of(run.settings) == "plane" else "J/m"
        self._key.show(
            {
                "work": f"friction work, at most {peaks['work']:.3g} {work}",
                "slip": f"slip, at most {unit_for(peaks['slip'], 'm')(peaks['slip'])}",
            }
        )
