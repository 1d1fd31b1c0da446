"""The largest modes of one substructure's separated basis, in space and in time."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.picture.shown import ShownModes
from app.picture.units import measured
from app.views.drawing.colors import BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION
from app.views.drawing.drawing import (
    POSITION,
    TIME,
    Axis,
    Curve,
    Drawing,
    Plot,
    View,
    has_instants,
    is_plane,
)
from app.views.drawing.legend import Key
from app.views.drawing.scales import along, over_time, upright
from app.views.scene import Scene
from solver.phrases import Phrase

RANK_COLORS = (BLUE, ORANGE, GREEN, PURPLE, GREY)
UP = Axis(-1.12, 1.12)


def draw_space(scene: Scene, _kept: None) -> Drawing | None:
    """Draw displacement modes along the chosen substructure, dashed when just born."""
    bases = scene.frame.bases
    if bases is None:
        return None
    modes = bases.modes
    # A substructure of one element may rub at one point only.
    x = along(float(modes.positions[0]), float(modes.positions[-1]))
    keys = (
        Key(GREY, "bare", Phrase("substructure {}", bases.substructure + 1)),
        Key(GREY, "bare", "modes of the search" if bases.is_left else news(modes)),
    )
    return Drawing(x, UP, _curves(modes.positions, modes.space_modes, modes), keys=keys)


def draw_time(scene: Scene, _kept: None) -> Drawing | None:
    """Draw the time functions of the same modes, each over its largest value, which is told."""
    bases, instants = scene.frame.bases, scene.run.stand.instants
    if bases is None:
        return None
    modes = bases.modes
    sizes = np.abs(modes.time_functions).max(axis=1, initial=0.0)
    scaled = modes.time_functions / np.where(sizes > 0.0, sizes, 1.0)[:, None]
    chosen = upright([float(instants[scene.instant])], UP, color=VERMILION, width=2)
    keys = tuple(
        Key(color, "line", measured(float(size), "m", scene.look.units, 2))
        for color, size in zip(RANK_COLORS, sizes, strict=False)
    )
    x = over_time(float(instants[0]), float(instants[-1]))
    return Drawing(x, UP, [*_curves(instants, scaled, modes), chosen], keys=keys)


def news(modes: ShownModes) -> str:
    """Say in words what the iteration did to the basis, in a form whose length hardly changes."""
    record, said = modes.record, "{} modes, {} added, {} dropped"
    said = "{} mode, {} added, {} dropped" if record.modes == 1 else said
    return Phrase(said, record.modes, record.added, modes.lost)


def _curves(along: np.ndarray, lines: Any, modes: ShownModes) -> list[Curve]:
    """Give lines coloured by rank, the largest mode on top."""
    return [
        Curve(along, lines[rank], RANK_COLORS[rank], dash="dashed" if modes.born[rank] else "solid")
        for rank in range(len(lines))[::-1]
    ]


SPACE_MODES = View(
    "PGD space modes",
    Plot(POSITION, "Displacement / largest"),
    draw_space,
    # Those of plane bodies are no curves.
    lambda settings: settings.applies("pgd_modes") and not is_plane(settings),
)
TIME_FUNCTIONS = View(
    "PGD time functions",
    Plot(TIME, "Value / largest"),
    draw_time,
    lambda settings: settings.applies("pgd_modes") and has_instants(settings),
)
