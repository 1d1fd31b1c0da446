"""What acts on the structure over time, and the chosen instant."""

from __future__ import annotations

import numpy as np

from app.picture.units import measured
from app.views.drawing.colors import BLUE, FORCE, GREEN, GREY, PURPLE, VERMILION
from app.views.drawing.drawing import TIME, Axis, Curve, Drawing, Marks, Plot, View, has_instants
from app.views.drawing.legend import Key
from app.views.drawing.scales import ROOM, across, over_time, upright
from app.views.scene import Scene
from solver.arrays import Array
from solver.phrases import Phrase

COLORS = (FORCE, BLUE, GREEN, PURPLE, GREY)


def draw(scene: Scene, _kept: None) -> Drawing | None:
    """Draw every load that changes, or that of a constant one; of several units, shares of each."""
    instants = scene.run.stand.portrait.described.instants
    paths = _paths(scene)
    if not paths:
        return None
    units = {unit for _, unit, _ in paths}
    peaks = [float(np.abs(values).max()) or 1.0 for _, _, values in paths]
    alike = units.pop() if len(units) == 1 else ""
    time = float(scene.run.stand.instants[scene.instant])
    x = over_time(float(instants[0]), float(instants[-1]))
    shown = [
        values / (1.0 if alike else peak) for (_, _, values), peak in zip(paths, peaks, strict=True)
    ]
    low, high = min(float(one.min()) for one in shown), max(float(one.max()) for one in shown)
    room = (ROOM - 1.0) * (max(high, 0.0) - min(low, 0.0) or 1.0)
    y = Axis(
        min(low, 0.0) - room,
        max(high, 0.0) + room,
        label="Load" if alike else Phrase("{} ({})", "Load", "of peak"),
        unit=alike,
    )
    curves = [across([0.0], x, color=GREY, alpha=0.4, width=1)]
    keys = []
    for (name, own, _), values, peak, color in zip(paths, shown, peaks, COLORS, strict=False):
        curves.append(Curve(instants, values, color))
        keys.append(
            Key(color, "line", Phrase("{}, {}", name, measured(peak, own, scene.look.units)))
        )
    curves.append(upright([time], y, color=VERMILION, width=2))
    now = [np.interp(time, instants, one) for one in shown[: len(COLORS)]]
    return Drawing(x, y, curves, [Marks([time] * len(now), now, VERMILION)], keys=keys)


def _paths(scene: Scene) -> list[tuple[str, str, Array]]:
    """Give the loads that change, with name and unit; or all, if none does.

    Those of one symbol say where they act, too.
    """
    described = scene.run.stand.portrait.described
    found = [
        (act.symbol, act.where, act.unit, np.atleast_2d(act.values)[-1]) for act in described.acts
    ]
    if described.tilt is not None:
        found.insert(0, ("θ", "", "°", np.degrees(described.tilt)))
    shown = [path for path in found if np.ptp(path[-1]) > 0.0] or found
    symbols = [symbol for symbol, *_ in shown]
    return [
        (symbol if symbols.count(symbol) == 1 else _placed(symbol, where), unit, values)
        for symbol, where, unit, values in shown
    ]


def _placed(symbol: str, where: str) -> str:
    side, _, axis = where.partition(" ")
    return Phrase("{} ({}, {})", symbol, side, axis) if axis else Phrase("{} ({})", symbol, side)


VIEW = View(
    "Load path",
    Plot(TIME, "Load", marks=(Marks((), (), VERMILION),), chooses="time"),
    draw,
    has_instants,
)
