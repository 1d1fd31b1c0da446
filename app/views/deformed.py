"""The deformed bodies, coloured by a stress, at the chosen instant."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from bokeh.models import CustomJS, FixedTicker, LinearColorMapper, Range1d
from bokeh.palettes import Cividis256

from app.views.drawing import (
    GREY,
    Limits,
    Picture,
    color_bar,
    decimal_scale,
    empty,
    held,
    make_figure,
    round_up,
)
from app.views.legend import Key
from app.worker.shown import Mesh, MeshField
from solver.scenes.plane import PlaneSettings
from solver.settings import Settings

SHOWN = 0.06
"""Share of the bodies' size that the largest displacement takes by default."""

SPREAD = """
const at = nodes.data.at, value = stress.data.value, corners = mesh.data.corners
if (!at || !at.length || !corners.length) { return }
const flat = new Float32Array(at.buffer, at.byteOffset, at.length)
const n = corners.length / 4, half = at.length / 2
const xs = new Array(n), ys = new Array(n)
for (let i = 0; i < n; i++) {
  const x = new Float32Array(4), y = new Float32Array(4)
  for (let j = 0; j < 4; j++) {
    const c = corners[4 * i + j]
    x[j] = flat[c]
    y[j] = flat[half + c]
  }
  xs[i] = x
  ys[i] = y
}
quads.data.xs = xs
quads.data.ys = ys
quads.data.value = value
quads.change.emit()
"""
"""Puts corners together in the browser: one array a frame is sent, not one for every corner list.
What is changed in place is not sent back."""

FIT = """
const [left, right, low, high] = box.data.edge
const wide = figure.inner_width, tall = figure.inner_height
if (!(wide > 1 && tall > 1 && right > left)) { return }
const scale = Math.max((right - left) / wide, (high - low) / tall)
const x = 0.5 * (left + right), y = 0.5 * (low + high)
figure.x_range.setv({start: x - 0.5 * scale * wide, end: x + 0.5 * scale * wide})
figure.y_range.setv({start: y - 0.5 * scale * tall, end: y + 0.5 * scale * tall})
"""
"""Makes both axes of one scale, however large the plot is."""


class Deformed:
    """The mesh moved by its magnified displacement.

    Parameters
    ----------
    magnification
        Gives the factor on the displacement; None takes one at which it can be seen.
    """

    name = "Deformed bodies"
    watches = "mesh"
    keys: Sequence[Key] = ()

    def __init__(self, magnification: Callable[[], float | None]) -> None:
        self._magnification = magnification
        self.figure = make_figure("x (m)", "y (m)", x_range=Range1d(0, 1), y_range=Range1d(0, 1))
        self._mesh = empty("corners")
        self._nodes = empty("at")
        self._stress = empty("value")
        self._quads = empty("xs", "ys", "value")
        self._box = empty("edge")
        self._mapper = LinearColorMapper(palette=Cividis256, low=0, high=1)
        self._marks = FixedTicker(ticks=[0, 1])
        self._drawn: Mesh | None = None
        self._limits: Limits | None = None
        self._unit = 1.0
        self._fitting = 1.0
        made = self.figure
        made.patches(
            "xs",
            "ys",
            source=self._quads,
            fill_color={"field": "value", "transform": self._mapper},
            line_color={"field": "value", "transform": self._mapper},
            line_width=0.5,
        )
        color_bar(made, self._mapper, self._marks, "MPa")
        spread = CustomJS(
            args={
                "nodes": self._nodes,
                "stress": self._stress,
                "mesh": self._mesh,
                "quads": self._quads,
            },
            code=SPREAD,
        )
        fit = CustomJS(args={"figure": made, "box": self._box}, code=FIT)
        self._nodes.js_on_change("data", spread)
        self._box.js_on_change("data", fit)
        # A plot that gets its size draws what came with the page; this also makes the sources,
        # which no glyph knows, a part of the page.
        for size in ("inner_width", "inner_height"):
            made.js_on_change(size, fit, spread)

    def applies(self, settings: Settings) -> bool:
        """Tell whether there are plane bodies to draw."""
        return isinstance(settings, PlaneSettings)

    def draw(self, picture: Picture) -> None:
        """Draw the bodies of the shown iterate."""
        begun, frame = picture.run.begun, picture.frame
        if begun is None or begun.mesh is None or frame is None or frame.mesh is None:
            return
        mesh, field = begun.mesh, frame.mesh
        if len(field.displacement) != len(mesh.nodes):
            return
        factor = self._magnification()
        if factor is None:
            factor = self._fitting = fitting(mesh, field.largest, self._fitting)
        moved = mesh.nodes + np.float32(factor) * field.displacement
        self._draw_scale(mesh, field, factor)
        self._fit(mesh, round_up(factor * field.largest) if field.largest > 0.0 else 0.0)
        if self._drawn is not mesh:
            self._drawn = mesh
            self._mesh.data = {"corners": mesh.quads.ravel()}
        self._stress.data = {"value": field.stress / np.float32(self._unit)}
        # Last, because it is what has the browser put all of it together.
        self._nodes.data = {"at": np.ascontiguousarray(moved.T).ravel()}

    def _draw_scale(self, mesh: Mesh, field: MeshField, factor: float) -> None:
        """Let colours span the values at this instant."""
        limits = held(self._limits, float(field.stress.min()), float(field.stress.max()))
        if limits != self._limits:
            self._limits = limits
            self._unit, unit = decimal_scale(max(-limits[0], limits[1]), "Pa")
            low, high = (limit / self._unit for limit in limits)
            self._mapper.update(low=low, high=high)
            self._marks.ticks = [low, 0.5 * (low + high), high]
            if self.figure.right[0].title != unit:
                self.figure.right[0].title = unit
        self.keys = (
            Key(GREY, "bare", field.component),
            Key(GREY, "bare", f"displacement × {factor:g}"),
        )

    def _fit(self, mesh: Mesh, reach: float) -> None:
        """Ask for room for the bodies, and for where they may move to: seldom."""
        (left, low), (right, high) = mesh.nodes.min(axis=0), mesh.nodes.max(axis=0)
        margin = 0.02 * float(right - left) + reach
        edge = [left - margin, right + margin, low - margin, high + margin]
        wanted = [float(value) for value in edge]
        if list(self._box.data["edge"]) != wanted:
            self._box.data = {"edge": wanted}


def fitting(mesh: Mesh, largest: float, present: float = 1.0) -> float:
    """Give a magnification of 1, 2 or 5 times a power of ten at which a displacement shows.

    The present one is kept as long as it does.
    """
    size = float(np.ptp(mesh.nodes, axis=0).max())
    if not (np.isfinite(largest) and largest > 0.0):
        return present
    wanted = SHOWN * size / largest
    if 0.25 * wanted <= present <= 1.5 * wanted:
        return present
    decade = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step * decade for step in (1.0, 2.0, 5.0) if step * decade <= wanted))
