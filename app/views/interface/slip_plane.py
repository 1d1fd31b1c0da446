"""Two points in the plane of their slips: what friction can hold moves, and pushes them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.picture.slip_plane import SlipPlane
from app.views.drawing.colors import BLUE, FORCE, GREEN, GREY, VERMILION
from app.views.drawing.drawing import Curve, Drawing, Marks, Plot, View
from app.views.drawing.legend import Key
from app.views.drawing.scales import Limits, held, spanned
from app.views.scene import Scene
from solver.settings import Settings

POINT = Marks((), (), VERMILION)
COLORS = BLUE, FORCE
"""Of the lines at which the left and the right point slip."""
COULOMB = "coulomb"
FAR = 10.0
"""Times the plot by which a line goes beyond it."""
HELD, NONE = (
    "Between the lines both points stick; in the green field no line of the last cycle comes.",
    "Between the lines both points stick; in the last cycle they come everywhere.",
)

ALONE = "Contact alone holds the block: how far it slips does not say what presses it."


def applies(settings: Settings) -> bool:
    """Tell whether two points rub, whose friction follows from what presses them."""
    law = settings.values()["friction_law"]
    return settings.opens and law == COULOMB and settings.n_jumps == 2 * len(COLORS)


def draw(scene: Scene, kept: tuple[Limits, Limits] | None) -> Drawing:
    """Draw where two points have slipped so far, and the lines at which they slip now."""
    found = scene.frame.slips
    if found is None:
        return Drawing(spanned(0.0, 1.0), spanned(0.0, 1.0), sentence=ALONE)
    limits = _limits(found, kept)
    x, y = (
        spanned(*ends, label=title, unit="m")
        for ends, title in zip(limits, (VIEW.plot.x_label, VIEW.plot.y_label), strict=True)
    )
    so_far = found.slip[:, : scene.instant + 1]
    curves = [_around(found.room)] if len(found.room) else []
    curves += _lines(found, scene.instant, limits)
    curves.append(Curve(so_far[0], so_far[1], GREY, 2))
    at = so_far[:, -1:]
    keys = [
        Key(COLORS[0], "line", "left point slips"),
        Key(COLORS[1], "line", "right point slips"),
        Key(GREY, "line", "so far"),
    ]
    if len(found.room):
        keys.append(Key(GREEN, "line", "free in the last cycle"))
    sentence = HELD if len(found.room) else NONE
    point = replace(POINT, x=at[0], y=at[1])
    return Drawing(x, y, curves, (point,), keys=keys, sentence=sentence, kept=limits)


def _limits(found: SlipPlane, kept: tuple[Limits, Limits] | None) -> tuple[Limits, Limits]:
    """Hold all slips, and the field that is left."""
    both = np.concatenate([found.slip.T, found.room])
    across, up = (
        held(kept and kept[place], float(one.min()), float(one.max()))
        for place, one in enumerate(both.T)
    )
    return across, up


def _lines(found: SlipPlane, instant: int, limits: tuple[Limits, Limits]) -> list[Curve]:
    """Give the lines of an instant, a curve for each point, farther than the plot goes."""
    far = FAR * max(high - low for low, high in limits)
    curves = []
    for point, color in enumerate(COLORS):
        ends = []
        for row in (point, point + len(COLORS)):
            normal = found.matrix[row]
            size = float(np.linalg.norm(normal))
            foot = normal * found.limit[row, instant] / size**2
            along = far * np.array([-normal[1], normal[0]]) / size
            ends += [foot - along, foot + along, np.full(2, np.nan)]
        across, up = np.array(ends).T
        curves.append(Curve(across, up, color, 1.5))
    return curves


def _around(corners: np.ndarray) -> Curve:
    """Draw a field by its border."""
    across, up = np.concatenate([corners, corners[:1]]).T
    return Curve(across, up, GREEN, 3)


VIEW = View(
    "Plane of slips",
    Plot("Left slip", "Right slip", marks=(POINT,)),
    draw,
    applies,
)
