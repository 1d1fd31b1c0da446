"""The deformed bodies, coloured by a stress, at the chosen instant."""

from __future__ import annotations

import numpy as np

from app.views.drawing import GREY, Bodies, Colors, Drawing, Plot, Scene, View
from app.views.legend import Key
from app.views.scales import Limits, decimal_scale, held, round_up
from app.worker.shown import Mesh
from solver.scenes import kind_of
from solver.settings import Settings

SHOWN = 0.06
"""Share of the bodies' size that the largest displacement takes by default."""
CIVIDIS = ("#00224e", "#1a386f", "#434e6c", "#61656f", "#7d7c78", "#9b9476", "#bcae6c", "#dfc858")


def applies(settings: Settings) -> bool:
    """Tell whether there are plane bodies to draw."""
    return kind_of(settings) == "plane"


def draw(scene: Scene, kept: tuple[Limits | None, float] | None) -> Drawing | None:
    """Draw the mesh moved by its magnified displacement."""
    mesh, field = scene.run.stand.mesh, scene.frame.mesh
    if mesh is None or field is None:
        return None
    old, fit = kept or (None, 1.0)
    factor = scene.look.magnification
    if factor is None:
        factor = fit = fitting(mesh, field.largest, fit)
    moved = mesh.nodes + np.float32(factor) * field.displacement
    limits = held(old, float(field.stress.min()), float(field.stress.max()))
    unit, name = decimal_scale(max(-limits[0], limits[1]), "Pa")
    low, high = (limit / unit for limit in limits)
    reach = round_up(factor * field.largest) if field.largest > 0.0 else 0.0
    return Drawing(
        bodies=Bodies(mesh.quads, moved, field.stress / np.float32(unit), _box(mesh, reach)),
        colors=Colors(low, high, (low, 0.5 * (low + high), high), name),
        keys=(
            Key(GREY, "bare", field.component),
            Key(GREY, "bare", f"displacement × {factor:g}"),
        ),
        kept=(limits, fit),
    )


def _box(mesh: Mesh, reach: float) -> tuple[float, float, float, float]:
    """Give room for the bodies, and for where they may move to."""
    (left, low), (right, high) = mesh.nodes.min(axis=0), mesh.nodes.max(axis=0)
    margin = 0.02 * float(right - left) + reach
    return float(left - margin), float(right + margin), float(low - margin), float(high + margin)


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


VIEW = View(
    "Deformed bodies",
    Plot("x (m)", "y (m)", palette=CIVIDIS, scale="MPa", equal=True),
    applies,
    draw,
    watches="mesh",
)
