"""Views of wires: a section of a strand, and the axial force along rods and wires."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.models import LinearColorMapper
from bokeh.palettes import Cividis256

from app.frame import Frame, Selection
from app.views.axis import extent, rounded_up
from app.views.colors import EDGE, ERROR, EXACT, KEYS, RANKS, REFERENCE, STATUS
from app.views.flags import FLAGS, add_flag, show_flag
from app.views.parts import color_bar, hover, joined
from app.views.view import ExtraView
from app.worker.geometry import MOST_WIRES
from solver.files.amounts import unit_for

COLORS = [color for color in RANKS if color != ERROR]
"""Colours of wires; a broken wire has the colour of errors."""
WIRES = [str(number) for number in range(MOST_WIRES + 1)]
"""Names of the curves of wires, with one for a broken wire."""
WIDTH = 340.0
HEIGHT = 200.0
"""Size of a section until the browser has told it, px."""
SPARE = 1.1
"""Half of the smaller side of a section over the radius of the strand."""


class WireSection(ExtraView):
    """Section of a bent strand: wires are coloured by stress, and ringed if they slip.

    A tap selects a wire.
    """

    name = "Cross-section"
    needs = frozenset({"section"})

    applies = staticmethod(lambda settings: settings.kind == "helices")

    def make(self) -> None:
        """Draw the wires as circles, the colour bar of the stress, and the legend."""
        plot = self.begin()
        plot.axis.visible = False
        plot.center = []
        self.colors = LinearColorMapper(palette=Cividis256, low=0.0, high=1.0)
        self.add(
            "wires",
            "Circle",
            "x y radius line_color line_width",
            also="stress",
            fill_color={"field": "stress", "transform": self.colors},
        )
        self.bar = color_bar(plot, self.colors)
        rings = {key: KEYS[key] for key in ("slip →", "slip ←")} | {"selected": ERROR}
        self.mark(rings, fill_color="white", line_width=3, marker="circle")
        self.legend(*rings)
        plot.on_event(Tap, self._tap)
        self.follow_size(WIDTH, HEIGHT)

    def _show(self, cut: Any, frame: Frame, selection: Selection) -> None:
        run = frame.run
        column = run.column(selection.phase)
        unit = unit_for(float(np.abs(cut["stress"]).max()), "Pa")
        low, high = np.divide(extent([cut["stress"]]), unit.factor)
        # The ends of the scale are round, and so seldom change.
        step = rounded_up(0.05 * (high - low))
        first = math.floor(low / step)
        last = max(math.ceil(high / step), first + 1)
        self.colors.update(low=first * step, high=last * step)
        place = unit_for(1.0, "m")(cut["position"])
        self.bar.visible = True
        self.bar.title = f"stress, {unit.name}, at x = {place}"
        reach = np.linalg.norm(cut["centres"], axis=1) + cut["radii"]
        self._fit(float(reach.max()))
        slips = cut["slips"][:, column]
        selected = list(run.interfaces).index(run.interface(selection.interface))
        chosen = cut["wires"] == selected
        # Slip shows before the selection.
        rings = np.where(chosen, ERROR, EDGE)
        for status in (-1, 1):
            rings = np.where(slips == status, STATUS[status], rings)
        self.fill(
            "wires",
            x=cut["centres"][:, 0],
            y=cut["centres"][:, 1],
            radius=0.96 * cut["radii"],
            stress=cut["stress"][:, column] / unit.factor,
            line_color=rings.tolist(),
            line_width=np.where(slips != 0, 3.0, np.where(chosen, 2.5, 1.0)),
        )

    def _fit(self, radius: float) -> None:
        """Set the limits to a strand, by its radius in m: it is as wide as high.

        Ranges of Bokeh that follow data would keep the limits that they have as the
        figure comes to another card.
        """
        half = SPARE * radius * self.room / self.room.min()
        width, height = half.tolist()
        self.x.span(-width, width)
        self.y.span(-height, height)

    def _tap(self, event: Any) -> None:
        """Select the wire under the pointer; the core has no interface."""
        frame = self.state.frame
        if frame is None or "section" not in frame.extras:
            return
        cut = frame.extras["section"]
        distance = np.hypot(*(cut["centres"] - [event.x, event.y]).T)
        nearest = int(distance.argmin())
        wire = int(cut["wires"][nearest])
        if distance[nearest] <= cut["radii"][nearest] and wire >= 0:
            self.state.select(interface=list(frame.run.interfaces)[wire])


class AxialForces(ExtraView):
    """Force along a rod, a band or each wire."""

    name = "Axial force"
    needs = frozenset({"axial force"})

    applies = staticmethod(
        lambda settings: settings.kind != "plane" or settings.scene == "belt"
    )

    def make(self) -> None:
        """Draw a curve for each wire, and the closed form."""
        plot = self.begin(("x", "m"), ("force", "N"))
        self.add("exact", color=EXACT, width=8, alpha=0.35)
        self.add("stuck", color=REFERENCE, dash="dashed", width=1.5)
        self._lines = [self.add(wire, width=2) for wire in WIRES]
        add_flag(self)
        self.legend(*WIRES, *FLAGS, stuck="all stick", exact="closed form")
        hover(plot, self._lines, {"x": "@x{0.000}", "force": "@y{0.000}"})

    def _show(self, axial: Any, frame: Frame, selection: Selection) -> None:
        """Show the force in each wire, and in a broken one in another colour."""
        run = frame.run
        column = run.column(selection.phase)
        x = axial["x"]
        names = axial["names"]
        stuck = axial["stuck"]
        exact = run.known("axial force")
        # Of a strand one wire is shown: the axes are those of the wires that are shown.
        key = (*frame.stage, *names)
        name = run.interface(selection.interface)
        self.x.hold(key, x, run.interfaces[name].positions)
        ups = [curve.up for curve in exact]
        self.y.hold(key, axial["force"], *ups, stuck, [0.0], margin=0.05)
        curves = [(curve.across, curve.up[:, column]) for curve in exact]
        self.draw("exact", *joined(curves))
        self.draw("stuck", x[: len(stuck)], stuck[:, column])
        self._color(names)
        self.draw_each(WIRES, x, axial["force"][:, :, column], names)
        show_flag(self, frame)

    def _color(self, names: list[str]) -> None:
        """Set colours and widths of the curves of wires."""
        # More wires than colours: they begin again.
        colors = iter(COLORS * 2)
        for line, wire in zip(self._lines, names, strict=False):
            if "broken" in wire:
                line.glyph.update(line_color=ERROR, line_width=3.5)
            else:
                line.glyph.update(line_color=next(colors), line_width=2.0)
