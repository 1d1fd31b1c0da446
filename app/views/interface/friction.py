"""Friction force along the bar at the chosen instant."""

from __future__ import annotations

import numpy as np

from app.picture.labels import called
from app.views import brought
from app.views.drawing.colors import BLUE, GHOST, GREEN, GREY, ORANGE
from app.views.drawing.drawing import POSITION, Axis, Curve, Drawing, Plot, View, is_plane
from app.views.drawing.legend import Key
from app.views.drawing.scales import Limits, across, along, held, upright
from app.views.scene import Scene

ROOM = 1.25
"""What is seen of forces, over their bound."""


def draw(scene: Scene, kept: Limits | None) -> Drawing | None:
    """Draw the force per length, with its bounds, the reference, the closed form and the ghost."""
    run, begun, instant = scene.run, scene.run.stand, scene.instant
    if begun.bound is None:
        return None
    limits = _limits(scene, float(begun.bound.max()) or 1.0, kept)
    x, y = along(0.0, scene.length), Axis(*limits, label="Force", unit="N/m")
    places = begun.positions
    bound = begun.bound[:, min(instant, begun.bound.shape[1] - 1)]
    curves = [
        upright(begun.cuts, y, color=GREY, alpha=0.35, width=1),
        across([0.0], x, color=GREY, alpha=0.4, width=1),
        Curve(places, bound, GREY, 1.5, "dashed"),
        Curve(places, -bound, GREY, 1.5, "dashed"),
    ]
    keys = [Key(BLUE, "line", scene.name)]
    if begun.strand is not None:
        keys.insert(0, Key(GREY, "bare", called(begun.interface, begun.interfaces)))
    if run.reference is not None:
        keys.append(Key(ORANGE, "line", "reference"))
    if exact := begun.known("friction"):
        curves += [Curve(one.across, one.up[:, instant], GREEN, 7) for one in exact]
        keys.append(Key(GREEN, "band", "closed form"))
    if scene.ghost is not None:
        before, fields, then = scene.ghost
        curves.append(Curve(before.stand.positions, fields.friction[:, then], GHOST, 2))
        keys.append(Key(GHOST, "line", scene.ghost_name))
    if run.reference is not None:
        curves.append(Curve(places, run.reference.friction[:, instant], ORANGE, 4.5))
    curves.append(Curve(places, scene.frame.fields.friction[:, instant], BLUE))
    theirs, more = brought.along(scene)
    keys += [*more, Key(GREY, "dashed", "±μp")]
    return Drawing(x, y, [*curves, *theirs], keys=keys, kept=limits)


def _limits(scene: Scene, bound: float, kept: Limits | None) -> Limits:
    """Give the bound room on both sides, and more to what reaches beyond at any instant."""
    shown = [scene.frame.fields.friction]
    if scene.ghost is not None:
        shown.append(scene.ghost[1].friction)
    largest = max(float(np.abs(one).max()) for one in [*shown, *brought.friction_of(scene)])
    if largest <= ROOM * bound:
        return -ROOM * bound, ROOM * bound
    return held(kept, -largest, largest)


VIEW = View(
    "Friction force",
    Plot(POSITION, "Force"),
    draw,
    # Plane bodies have no bound that is known beforehand, and tractions instead.
    lambda settings: not is_plane(settings),
)
