"""Views of the wires of a strand: cut, unrolled, how far their stress swings, and their force."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.models import ColorBar, LinearColorMapper, Range1d
from bokeh.palettes import Cividis256
from bokeh.plotting import figure

from app.frame import Frame, Selection
from app.units import unit_for
from app.views.colors import BACKWARD, ERROR, FORWARD, STATUS, STICK
from app.views.scene.scene import put
from app.views.view import View, hover, legend, plot, source
from solver.scenes import kind_of
from solver.settings import Settings

LAYERS = ("#0072B2", "#E69F00", "#CC79A7", "#56B4E9", "#009E73", "#7A7A7A")
SHARED = 1.5
"""Times the load: the most that a wire between two others takes over, about."""
STATUSES = {"stick": STICK, "slip +": FORWARD, "slip −": BACKWARD}


class _OfRope(View):
    """A view of a strand that is bent."""

    extra: str

    @staticmethod
    def applies(settings: Settings) -> bool:
        """Whether there is a strand of helical wires."""
        return kind_of(settings) == "helices"

    def _select(self, number: int) -> None:
        frame = self.state.frame
        if frame is not None and 0 <= number < len(frame.run.interfaces):
            self.state.select(interface=list(frame.run.interfaces)[number])


class CrossSection(_OfRope):
    """All wires where the strand is cut, coloured by stress and ringed where they slip."""

    name = "Cross-section"
    needs = frozenset({"section"})

    def make(self) -> figure:
        """A new figure."""
        made = plot("mm", "mm", match_aspect=True, x_range=Range1d(-1, 1), y_range=Range1d(-1, 1))
        made.axis.visible = made.grid.visible = False
        self.colors = LinearColorMapper(palette=Cividis256, low=0.0, high=1.0)
        self.wires = source("x", "y", "radius", "stress", "ring", "width")
        made.circle(
            "x", "y", radius="radius", source=self.wires, line_color="ring", line_width="width",
            fill_color={"field": "stress", "transform": self.colors},
        )  # fmt: skip
        self.bar = ColorBar(
            color_mapper=self.colors, width=9, padding=2, title_text_font_size="11px",
            title_text_font_style="normal", background_fill_alpha=0.0,
        )  # fmt: skip
        made.add_layout(self.bar, "right")
        keys = {
            name: [made.scatter([np.nan], [np.nan], fill_alpha=0, line_color=color, line_width=3)]
            for name, color in (("slip +", FORWARD), ("slip −", BACKWARD), ("selected", ERROR))
        }
        legend(made, keys)
        self._size = {"inner_width": 300.0, "inner_height": 200.0}
        for size in self._size:
            made.on_change(size, self._resize)
        made.on_event(Tap, self._tap)
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the section at the selected instant."""
        cut, column = frame.extras.get("section"), frame.run.column(selection.phase)
        if cut is None:
            return
        largest = float(np.abs(cut.stress).max())
        unit = unit_for(largest, "Pa")
        low, high = (float(end) / unit.factor for end in (cut.stress.min(), cut.stress.max()))
        self.colors.update(low=low, high=max(high, low + 1e-9))
        self.bar.title = f"{unit.name} at x = {unit_for(1.0, 'm')(cut.place)}"
        self._reach = 1050.0 * float((np.hypot(*cut.centres.T) + cut.radii).max())
        self._fit()
        number = list(frame.run.interfaces).index(selection.interface_of(frame.run))
        slips, chosen = cut.slips[:, column], cut.wires == number
        rings = [
            STATUS[int(slip)] if slip else ERROR if own else "#546E7A"
            for slip, own in zip(slips, chosen, strict=True)
        ]
        put(
            self.wires,
            {
                "x": 1000.0 * cut.centres[:, 0],
                "y": 1000.0 * cut.centres[:, 1],
                "radius": 960.0 * cut.radii,
                "stress": cut.stress[:, column] / unit.factor,
                "ring": rings,
                "width": np.where(slips != 0, 3.0, np.where(chosen, 2.5, 1.0)),
            },
        )

    _reach = 1.0

    def _resize(self, name: str, old: float, new: float) -> None:
        self._size[name] = max(float(new), 20.0)
        self._fit()

    def _fit(self) -> None:
        """Have circles round: as many pixels a millimetre across as up."""
        width, height = self._size.values()
        across, up = (self._reach * size / min(width, height) for size in (width, height))
        self.figure.x_range.update(start=-across, end=across)
        self.figure.y_range.update(start=-up, end=up)

    def _tap(self, event: Any) -> None:
        cut = self.state.frame and self.state.frame.extras.get("section")
        if cut is None:
            return
        away = np.hypot(*(1000.0 * cut.centres - [event.x, event.y]).T)
        if away.min() <= 1000.0 * cut.radii[away.argmin()]:
            self._select(int(cut.wires[away.argmin()]))


class Unrolled(_OfRope):
    """Stick and slip of every wire at the selected instant, layer upon layer."""

    name = "All wires"
    needs = frozenset({"all_wires"})

    def make(self) -> figure:
        """A new figure."""
        made = plot("x, m", "wire", x_range=Range1d(0, 1), y_range=Range1d(0.5, 1.5))
        self.status = source("image", "x", "y", "dw", "dh")
        colors = LinearColorMapper(palette=[BACKWARD, STICK, FORWARD], low=-1.5, high=1.5)
        made.image("image", x="x", y="y", dw="dw", dh="dh", source=self.status, color_mapper=colors)
        self.lines, self.chosen = source("xs", "ys"), source("x", "y", "width", "height")
        made.multi_line("xs", "ys", source=self.lines, color="#546E7A", width=1.5)
        made.rect(
            "x", "y", "width", "height", source=self.chosen, fill_alpha=0, line_color=ERROR,
            line_width=2,
        )  # fmt: skip
        keys = {
            name: [made.scatter([np.nan], [np.nan], marker="square", size=10, color=color)]
            for name, color in STATUSES.items()
        }
        legend(made, keys)
        made.on_event(Tap, lambda event: self._select(round(event.y) - 1))
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the status of all wires."""
        wires, column = frame.extras.get("all_wires"), frame.run.column(selection.phase)
        if wires is None:
            return
        made, count, places = self.figure, len(wires.layers), wires.places
        made.below[-1].text = "x, m" if wires.is_clamped else "polar angle, °"
        made.yaxis.axis_label = "wire" if wires.is_clamped else "layer"
        step = float(places[1] - places[0]) if len(places) > 1 else float(places[0])
        low, high = float(places[0]) - 0.5 * step, float(places[-1]) + 0.5 * step
        made.x_range.update(start=low, end=high)
        made.y_range.update(start=0.5, end=count + 0.5)
        image = np.ascontiguousarray(wires.status[:, :, column])
        self.status.data = {
            "image": [image], "x": [low], "y": [0.5], "dw": [high - low], "dh": [count],
        }  # fmt: skip
        between = np.flatnonzero(np.diff(wires.layers)) + 1.5
        put(self.lines, {"xs": [[low, high]] * len(between), "ys": [[y, y] for y in between]})
        number = list(frame.run.interfaces).index(selection.interface_of(frame.run))
        middle, width = [0.5 * (low + high)], [high - low]
        put(self.chosen, {"x": middle, "y": [number + 1.0], "width": width, "height": [1.0]})


class StressRanges(_OfRope):
    """How far the stress of every wire swings where it swings most, in the last cycle."""

    name = "Stress range"
    needs = frozenset({"wire_ranges"})

    def make(self) -> figure:
        """A new figure."""
        made = plot("wire", "stress range", x_range=Range1d(0.5, 1.5), y_range=Range1d(0, 1))
        self.bars = source("x", "top", "color", "layer")
        bars = made.vbar("x", 0.8, "top", source=self.bars, color="color")
        hover(made, [bars], {"wire": "@x", "layer": "@layer", "range": "@top"})
        made.on_event(Tap, lambda event: self._select(round(event.x) - 1))
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the ranges, coloured by layer."""
        found = frame.extras.get("wire_ranges")
        if found is None:
            return
        largest = float(found.ranges.max())
        unit = unit_for(largest, "Pa")
        self.figure.yaxis.axis_label = unit.titled("range")
        self.figure.x_range.end = len(found.layers) + 0.5
        self.figure.y_range.end = 1.08 * largest / unit.factor or 1.0
        put(
            self.bars,
            {
                "x": np.arange(len(found.layers)) + 1.0,
                "top": found.ranges / unit.factor,
                "color": [LAYERS[layer % len(LAYERS)] for layer in found.layers],
                "layer": found.layers + 1,
            },
        )
