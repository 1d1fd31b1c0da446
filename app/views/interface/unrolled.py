"""Stick and slip of all wires of a strand, side by side."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.views.bodies.section import is_bent
from app.views.drawing.colors import BACKWARD, FORWARD, GREY, STICK, VERMILION
from app.views.drawing.drawing import Axis, Drawing, Image, Plot, View
from app.views.drawing.legend import Key
from app.views.drawing.scales import across, along, spanned, upright
from app.views.interface.status_map import KEYS
from app.views.scene import Scene

ANGLE = "Polar angle (°)"


def draw(scene: Scene, _kept: Any) -> Drawing | None:
    """Draw the status of every wire at the chosen instant, along it: layer upon layer."""
    stand, field = scene.run.stand, scene.frame.strand
    strand = stand.strand
    if strand is None or field is None:
        return None
    count = len(strand.layers)
    x = along(0.0, strand.length) if strand.is_clamped else Axis(0.0, 180.0, label=ANGLE)
    y = spanned(0.5, count + 0.5, label="Wire" if strand.is_clamped else "Layer")
    first, last = float(strand.places[0]), float(strand.places[-1])
    half = 0.5 * (last - first) / max(len(strand.places) - 1, 1) or first
    image = Image(
        np.ascontiguousarray((field.status + 1).astype(np.uint8)),
        left=first - half,
        low=0.5,
        width=last - first + 2 * half,
        height=float(count),
    )
    chosen = stand.interfaces.index(stand.interface) + 0.5
    curves = [
        across(list(np.flatnonzero(np.diff(strand.layers)) + 1.5), x, color=GREY, width=1.5),
        across([chosen, chosen + 1.0], x, color=VERMILION, width=2),
    ]
    if scene.look.place is not None and strand.is_clamped:
        curves.append(upright([scene.look.place], y, color=VERMILION, width=1.5))
    keys = (*KEYS, Key(VERMILION, "line", "chosen wire"))
    return Drawing(x, y, curves, image=image, keys=keys)


VIEW = View(
    "All wires",
    Plot("Along the strand", "Wire", palette=(BACKWARD, STICK, FORWARD), chooses="wire", whole="y"),
    draw,
    is_bent,
)
