"""Axial force in the wires of a strand at the selected instant."""

from __future__ import annotations

from typing import Any

from bokeh.plotting import figure

from app.frame import Frame, Selection
from app.views.colors import ERROR, EXACT, RANKS, REFERENCE
from app.views.view import Axis, Key, View, extent, hover, key_of, plot, put, source
from app.worker.extras import MOST_WIRES
from solver.scenes import kind_of
from solver.settings import Settings

COLORS = [color for color in RANKS if color != ERROR]
"""Of wires; the broken one has a colour of its own."""


class AxialForce(View):
    """Force along each wire; a broken one regains it from its break on."""

    name = "Force in the wires"
    needs = frozenset({"axial force"})

    @staticmethod
    def applies(settings: Settings) -> bool:
        """Whether there are wires."""
        return kind_of(settings) in ("wires", "helices")

    def make(self) -> figure:
        """A new figure."""
        made = plot("", "")
        self._x, self._y = Axis(made, "x", "x", "m"), Axis(made, "y", "force", "N")
        self.exact, self.stuck = source("xs", "ys"), source("x", "y")
        exact = made.multi_line("xs", "ys", source=self.exact, color=EXACT, width=8, alpha=0.35)
        stuck = made.line("x", "y", source=self.stuck, color=REFERENCE, dash="dashed", width=1.5)
        self.wires = [source("x", "y") for _ in range(MOST_WIRES + 1)]
        self._lines = [made.line("x", "y", source=each, width=2) for each in self.wires]
        entries = {str(n): [line] for n, line in enumerate(self._lines)}
        self._key = Key(made, {**entries, "all stick": [stuck], "closed form": [exact]})
        hover(made, self._lines, {"x": "@x{0.000}", "force": "@y{0.000}"})
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the force in each wire."""
        axial, run = frame.extras.get("axial force"), frame.run
        if axial is None:
            return
        column, known, stuck = run.column(selection.phase), run.known("axial force"), axial["stuck"]
        key = (*key_of(run), *axial["names"])
        along = run.interfaces[selection.interface_of(run)].positions
        self._x.hold(key, *extent([axial["x"]] if stuck is not None else [axial["x"], along]))
        values = [axial["force"], *(curve.up for curve in known)]
        low, high = extent(values if stuck is None else [*values, stuck])
        self._y.hold(key, min(low, 0.0), max(high, 0.0), 0.05)
        x = self._x(axial["x"])
        put(
            self.exact,
            xs=[self._x(curve.across) for curve in known],
            ys=[self._y(curve.up[:, column]) for curve in known],
        )
        if stuck is None:
            put(self.stuck, x=[], y=[])
        else:
            put(self.stuck, x=x, y=self._y(stuck[:, column]))
        for number, target in enumerate(self.wires):
            if number < len(axial["names"]):
                put(target, x=x, y=self._y(axial["force"][number, :, column]))
            else:
                put(target, x=[], y=[])
        self._name(axial["names"], is_exact=bool(known), is_bent=stuck is not None)

    def _name(self, names: list[str], *, is_exact: bool, is_bent: bool) -> None:
        """Colour the wires, the broken one apart, and name them in the legend."""
        colors = iter(COLORS * 2)
        entries: dict[str, Any] = {str(n): False for n in range(len(self.wires))}
        for number, name in enumerate(names):
            is_broken = "broken" in name
            look = {"line_color": ERROR if is_broken else next(colors)}
            self._lines[number].glyph.update(**look, line_width=3.5 if is_broken else 2)
            entries[str(number)] = name if is_bent else f"wire {name}" if number == 0 else name
        self._key.show({**entries, "all stick": is_bent, "closed form": is_exact})
