"""Views of wires: a section of a strand, and the axial force along rods and wires."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.models import DataRange1d, LinearColorMapper
from bokeh.palettes import Cividis256

from app.frame import Frame, Selection
from app.units import unit_for
from app.views.axis import extent
from app.views.colors import EDGE, ERROR, EXACT, KEYS, RANKS, REFERENCE, STATUS
from app.views.view import ExtraView, color_bar, hover, joined
from app.worker.geometry import MOST_WIRES

COLORS = [color for color in RANKS if color != ERROR]
"""Of wires; the broken one has a colour of its own."""
WIRES = [str(number) for number in range(MOST_WIRES + 1)]


class WireSection(ExtraView):
    """Section of a bent strand: wires coloured by stress, ringed where they slip.

    A tap selects a wire.
    """

    name = "Cross-section"
    needs = frozenset({"section"})

    applies = staticmethod(lambda settings: settings.kind == "helices")

    def make(self) -> None:
        """Draw the wires as circles, the colour bar of the stress, and the legend."""
        made = self.begin(
            match_aspect=True, x_range=DataRange1d(), y_range=DataRange1d()
        )
        made.axis.visible = False
        made.center = []
        self.colors = LinearColorMapper(palette=Cividis256, low=0.0, high=1.0)
        self.add(
            "wires", "Circle", "x y radius line_color line_width", also="stress",
            fill_color={"field": "stress", "transform": self.colors},
        )  # fmt: skip
        # Without data BokehJS would complain of ranges that follow them.
        nothing = {
            column: [0.0] for column in ("x", "y", "radius", "line_width", "stress")
        }
        self.fill("wires", **nothing, line_color=["white"])
        self.bar = color_bar(made, self.colors)
        rings = {key: KEYS[key] for key in ("slip →", "slip ←")} | {"selected": ERROR}
        self.mark(rings, fill_color="white", line_width=3, marker="circle")
        self.legend(*rings)
        made.on_event(Tap, self._tap)

    def _show(self, cut: Any, frame: Frame, selection: Selection) -> None:
        column = frame.run.column(selection.phase)
        unit = unit_for(float(np.abs(cut["stress"]).max()), "Pa")
        low, high = (end / unit.factor for end in extent([cut["stress"]]))
        self.colors.update(low=low, high=max(high, low + 1e-9))
        self.bar.title = f"{unit.name} at x = {unit_for(1.0, 'm')(cut['place'])}"
        number = list(frame.run.interfaces).index(selection.interface_of(frame.run))
        slips = cut["slips"][:, column]
        chosen = cut["wires"] == number
        rings = [
            STATUS[int(slip)] if slip else ERROR if is_chosen else EDGE
            for slip, is_chosen in zip(slips, chosen, strict=True)
        ]
        self.fill(
            "wires",
            x=cut["centres"][:, 0],
            y=cut["centres"][:, 1],
            radius=0.96 * cut["radii"],
            stress=cut["stress"][:, column] / unit.factor,
            line_color=rings,
            line_width=np.where(slips != 0, 3.0, np.where(chosen, 2.5, 1.0)),
        )

    def _tap(self, event: Any) -> None:
        frame = self.state.frame
        cut = frame and frame.extras.get("section")
        if cut is None:
            return
        away = np.hypot(*(cut["centres"] - [event.x, event.y]).T)
        nearest = int(away.argmin())
        wire = int(cut["wires"][nearest])
        if away[nearest] <= cut["radii"][nearest] and wire >= 0:
            self.state.select(interface=list(frame.run.interfaces)[wire])


class AxialForces(ExtraView):
    """Force along a rod or each wire; a broken one regains it from its break on."""

    name = "Axial force"
    needs = frozenset({"axial force"})

    applies = staticmethod(lambda settings: settings.kind != "plane")

    def make(self) -> None:
        """Draw a curve for each wire, and the closed form."""
        made = self.begin(("x", "m"), ("force", "N"))
        self.add("exact", color=EXACT, width=8, alpha=0.35)
        self.add("stuck", color=REFERENCE, dash="dashed", width=1.5)
        self._lines = [self.add(wire, width=2) for wire in WIRES]
        self.legend(*WIRES, stuck="all stick", exact="closed form")
        hover(made, self._lines, {"x": "@x{0.000}", "force": "@y{0.000}"})

    def _show(self, axial: Any, frame: Frame, selection: Selection) -> None:
        """Show the force in each wire, the broken one in its own colour."""
        run = frame.run
        column = run.column(selection.phase)
        known = run.known("axial force")
        x = axial["x"]
        names = axial["names"]
        stuck = axial["stuck"]
        key = (*frame.stage, *names)
        along = run.interfaces[selection.interface_of(run)].positions
        self.x.hold(key, x, along)
        ups = [curve.up for curve in known]
        self.y.hold(key, axial["force"], *ups, stuck, [0.0], margin=0.05)
        self.draw(
            "exact", *joined([(curve.across, curve.up[:, column]) for curve in known])
        )
        self.draw("stuck", x[: len(stuck)], stuck[:, column])
        colors = iter(COLORS * 2)
        for line, wire in zip(self._lines, names, strict=False):
            if "broken" in wire:
                color = ERROR
                width = 3.5
            else:
                color = next(colors)
                width = 2.0
            line.glyph.update(line_color=color, line_width=width)
        self.draw_each(WIRES, x, axial["force"][:, :, column], names)
