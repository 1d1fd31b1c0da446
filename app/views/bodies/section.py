"""The cross-section of a strand: its wires, coloured by stress, ringed where they slip."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from app.picture.strands import StrandField
from app.picture.units import measured
from app.views.bodies.deformed import CIVIDIS
from app.views.drawing.colors import BACKWARD, FORWARD, GREY, LINES, VERMILION, shaded
from app.views.drawing.drawing import Box, Colors, Curve, Drawing, Plot, QuadMesh, View
from app.views.drawing.legend import Key
from app.views.drawing.scales import Limits, around, held, spanned
from app.views.scene import Scene
from solver.arrays import Array
from solver.phrases import Phrase
from solver.scenes import kind_of
from solver.settings import Settings

CORNERS = 20
"""Of the polygons that circles are drawn as."""
RING = 0.84
"""Radius of the ring around what slips, over the wire's."""
ROOM = 8.0
"""Pixels beside the strand."""
WIDEST, ALL_BARS = 16.0, 150.0
"""Width of a bar, and of all together, px."""


def is_bent(settings: Settings) -> bool:
    """Tell whether there is a strand of helical wires."""
    return kind_of(settings) == "helices"


def draw(scene: Scene, _kept: None) -> Drawing | None:
    """Draw all wires where the strand is cut: at its clamp, or at the chosen place."""
    strand, field = scene.run.stand.strand, scene.frame.strand
    if strand is None or field is None:
        return None
    ends = field.ends()
    stress, radius = field.core
    circles = field.centres[:, None] + field.radii[:, None, None] * _circle()
    whole = np.concatenate([radius * _circle()[None], circles])
    values = np.append(np.float32(stress), field.stress)
    reach = float(np.abs(circles).max())
    corners = np.arange(len(whole) * CORNERS, dtype=np.int32).reshape(-1, CORNERS)
    number = scene.run.stand.interfaces.index(scene.run.stand.interface)
    chosen = np.flatnonzero(strand.is_clamped & (field.wires == number))
    room = (ROOM,) * 4
    return Drawing(
        bodies=QuadMesh(
            corners,
            whole.reshape(-1, 2).astype(np.float32),
            values,
            Box(-reach, reach, -reach, reach, room),
        ),
        colors=Colors(
            *around(min(float(ends.min()), stress), max(float(ends.max()), stress)), unit="Pa"
        ),
        curves=[
            *(_rings(_slipping(field, status), color, 3) for status, color, _ in WAYS),
            _rings(circles[chosen], VERMILION, 2),
        ],
        contacts=_contacts(scene, field),
        keys=(
            Key(GREY, "bare", f"x = {measured(field.place, 'm', scene.look.units)}"),
            *(Key(color, "square", name) for _, color, name in WAYS),
        ),
    )


WAYS = (-1, BACKWARD, "slip −"), (1, FORWARD, "slip +")


def _circle() -> Array:
    angle = np.linspace(0.0, 2.0 * np.pi, CORNERS, endpoint=False)
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _slipping(field: StrandField, status: int) -> Array:
    own = field.slips == status
    return np.asarray(field.centres[own, None] + RING * field.radii[own, None, None] * _circle())


def _rings(circles: Array, color: str, width: float) -> Curve:
    """Give closed lines, (n, n_corners, 2), as one curve."""
    gaps = np.full((len(circles), 1, 2), np.nan)
    whole = np.concatenate([circles, circles[:, :1], gaps], axis=1).reshape(-1, 2)
    return Curve(whole[:, 0], whole[:, 1], color, width)


def _contacts(scene: Scene, field: StrandField) -> dict[str, Array]:
    """Give lines across the wires, by which a tap on one is known."""
    names, found = scene.run.stand.interfaces, {}
    if len(names) > 1:
        ways = np.array([[-0.7, 0], [0.7, 0], [0, 0], [0, 0.7], [0, -0.7], [np.nan, np.nan]])
        for number, name in enumerate(names):
            own = field.wires == number
            lines = field.centres[own, None] + field.radii[own, None, None] * ways
            found[name] = lines.reshape(-1, 2)
    return found


def draw_ranges(scene: Scene, kept: Limits | None) -> Drawing | None:
    """Draw how far the stress of every wire swings where it swings most, as bars."""
    strand, field = scene.run.stand.strand, scene.frame.strand
    if strand is None or field is None:
        return None
    ranges = field.ranges()
    limits = held(kept, 0.0, float(ranges.max()))
    colors, count, curves = layer_colors(strand.layers), len(ranges), []
    width = min(WIDEST, max(ALL_BARS / count, 1.5))
    for layer, color in enumerate(colors):
        own = np.flatnonzero(strand.layers == layer)
        x = np.stack([own + 1.0, own + 1.0, np.full(len(own), np.nan)], axis=1)
        y = np.stack([0.0 * own, ranges[own], x[:, 2]], axis=1)
        curves.append(Curve(x.ravel(), y.ravel(), color, width))
    return Drawing(
        spanned(0.5, count + 0.5, label="Wire" if strand.is_clamped else "Layer"),
        spanned(*limits, label="Stress range", unit="Pa"),
        curves,
        keys=[
            Key(color, "square", Phrase("layer {}", layer + 1))
            for layer, color in enumerate(colors)
        ],
        kept=limits,
    )


def layer_colors(layers: NDArray[np.intp]) -> list[str]:
    """Give a colour to every layer, inside out."""
    return shaded(int(layers.max()) + 1, LINES)[: int(layers.max()) + 1]


SECTION = View(
    "Cross-section",
    Plot("", "", palette=CIVIDIS, scale="Pa", equal=True, is_touched=True),
    draw,
    is_bent,
)
RANGES = View("Stress range", Plot("Wire", "Stress range", whole="x"), draw_ranges, is_bent)
