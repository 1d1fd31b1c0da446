"""Axial force in the wires of a strand at the selected instant."""

from __future__ import annotations

from app.frame import Frame, Selection
from app.views.colors import ERROR, EXACT, RANKS, REFERENCE
from app.views.view import View, extent, hover, joined, key_of
from app.worker.extras import MOST_WIRES
from solver.scenes import kind_of
from solver.settings import Settings

COLORS = [color for color in RANKS if color != ERROR]
"""Of wires; the broken one has a colour of its own."""
WIRES = [str(number) for number in range(MOST_WIRES + 1)]


class AxialForce(View):
    """Force along each wire; a broken one regains it from its break on."""

    name = "Force in the wires"
    needs = frozenset({"axial force"})

    @staticmethod
    def applies(settings: Settings) -> bool:
        """Whether there are wires."""
        return kind_of(settings) in ("wires", "helices")

    def make(self) -> None:
        """Make the figure."""
        made = self.begin(("x", "m"), ("force", "N"))
        self.add("exact", color=EXACT, width=8, alpha=0.35)
        self.add("stuck", color=REFERENCE, dash="dashed", width=1.5)
        self._lines = [self.add(wire, width=2) for wire in WIRES]
        self.legend(**{wire: wire for wire in WIRES}, stuck="all stick", exact="closed form")
        hover(made, self._lines, {"x": "@x{0.000}", "force": "@y{0.000}"})

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the force in each wire, the broken one in its own colour."""
        axial, run = frame.extras.get("axial force"), frame.run
        if axial is None:
            return
        column, known = run.column(selection.phase), run.known("axial force")
        x, names, stuck = axial["x"], axial["names"], axial["stuck"]
        key = (*key_of(run), *names)
        along = run.interfaces[selection.interface_of(run)].positions
        self.x.hold(key, *extent([x] if stuck is not None else [x, along]))
        bent = [] if stuck is None else [stuck]
        low, high = extent([axial["force"], *(curve.up for curve in known), *bent])
        self.y.hold(key, min(low, 0.0), max(high, 0.0), 0.05)
        self.draw("exact", *joined([(curve.across, curve.up[:, column]) for curve in known]))
        self.draw("stuck", *joined([(x, force[:, column]) for force in bent]))
        colors = iter(COLORS * 2)
        for number, wire in enumerate(WIRES):
            if number >= len(names):
                self.draw(wire, [], [])
                continue
            is_broken = "broken" in names[number]
            look = {"line_color": ERROR if is_broken else next(colors)}
            self._lines[number].glyph.update(**look, line_width=3.5 if is_broken else 2)
            title = names[number] if bent or number else f"wire {names[number]}"
            self.draw(wire, x, axial["force"][number, :, column], title)
