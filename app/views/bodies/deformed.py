"""The deformed bodies, coloured by a stress, at the chosen instant."""

from __future__ import annotations

import numpy as np

from app.picture.portrait import rims
from app.views.drawing.colors import GHOST, GREY
from app.views.drawing.drawing import (
    Axis,
    Box,
    Colors,
    Curve,
    Drawing,
    Plot,
    QuadMesh,
    View,
    is_plane,
)
from app.views.drawing.legend import Key
from app.views.drawing.scales import around, round_up
from app.views.scene import Scene
from solver.arrays import Array
from solver.phrases import Phrase

FARTHEST = 5.0
"""Times the displacement of the bodies: a ghost that moves farther is left out."""
SHOWN = 0.06
"""Share of the bodies' size that the largest displacement takes by default."""
CIVIDIS = ("#00224e", "#1a386f", "#434e6c", "#61656f", "#7d7c78", "#9b9476", "#bcae6c", "#dfc858")


def draw(scene: Scene, kept: float | None) -> Drawing | None:
    """Draw the mesh moved by its magnified displacement.

    A colour means the same stress wherever one came from: the scale follows from the picture alone.
    """
    mesh, field = scene.run.stand.mesh, scene.frame.mesh
    if mesh is None or field is None:
        return None
    fit = kept or 1.0
    factor = scene.look.magnification
    if factor is None:
        factor = fit = fitting(float(np.ptp(mesh.nodes, axis=0).max()), field.largest, fit)
    moved = mesh.nodes + np.float32(factor) * field.displacement
    limits = around(float(field.stress.min()), float(field.stress.max()))
    reach = round_up(factor * reach_of(scene)) if field.largest > 0.0 else 0.0
    outlines, ghosts = ghosts_of(scene, factor)
    box = _box(scene, reach)
    return Drawing(
        Axis(box.left, box.right, label="x", unit="m"),
        Axis(box.low, box.high, label="y", unit="m"),
        bodies=QuadMesh(mesh.quads, moved, field.stress, box),
        colors=Colors(*limits, unit="Pa"),
        keys=(
            Key(GREY, "bare", scene.look.stress),
            Key(GREY, "bare", Phrase("displacement × {}", f"{factor:g}")),
            *ghosts,
        ),
        curves=[Curve(one[:, 0], one[:, 1], GHOST, 1.5) for one in outlines],
        kept=fit,
    )


def ghosts_of(scene: Scene, factor: float) -> tuple[list[Array], list[Key]]:
    """Give the outlines of the deformed bodies of what a run is compared with, and their key."""
    if scene.shadow is None or scene.before is None or not _suits(scene):
        return [], []
    portrait = scene.before.stand.portrait
    nodes = portrait.mesh.nodes + np.float32(factor) * scene.shadow.pose.displacement
    return [nodes[rim] for rim in rims(portrait)], [Key(GHOST, "line", scene.ghost_name)]


def reach_of(scene: Scene) -> float:
    """Give the largest displacement over the whole time of all bodies that are drawn, m."""
    own = scene.frame.pose.largest
    return max(own, scene.shadow.pose.largest) if scene.shadow and _suits(scene) else own


def _suits(scene: Scene) -> bool:
    """Tell whether a ghost moves little enough not to make the bodies small."""
    return bool(scene.shadow and scene.shadow.pose.largest <= FARTHEST * scene.frame.pose.largest)


def sizes_of(scene: Scene) -> Array:
    """Give the right and the upper end of all undeformed bodies that are drawn, (2,), m."""
    nodes = [scene.run.stand.portrait.mesh.nodes]
    if scene.before is not None and scene.shadow is not None and _suits(scene):
        nodes.append(scene.before.stand.portrait.mesh.nodes)
    return np.asarray(np.max([one.max(axis=0) for one in nodes], axis=0))


def _box(scene: Scene, reach: float) -> Box:
    """Give room for the bodies, and for where they may move to."""
    assert scene.run.stand.mesh is not None
    (left, low), (right, high) = scene.run.stand.mesh.nodes.min(axis=0), sizes_of(scene)
    margin = 0.02 * float(right - left) + reach
    return Box(
        float(left - margin), float(right + margin), float(low - margin), float(high + margin)
    )


def fitting(size: float, largest: float, present: float = 1.0) -> float:
    """Give a magnification of 1, 2 or 5 times a power of ten at which a displacement shows.

    It shows on bodies of this size, m. The present one is kept as long as it does.
    """
    if not (np.isfinite(largest) and largest > 0.0):
        return present
    wanted = SHOWN * size / largest
    if 0.25 * wanted <= present <= 1.5 * wanted:
        return present
    decade = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step * decade for step in (1.0, 2.0, 5.0) if step * decade <= wanted))


VIEW = View(
    "Deformed bodies",
    Plot("x", "y", palette=CIVIDIS, scale="Pa", equal=True),
    draw,
    is_plane,
)
