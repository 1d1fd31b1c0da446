"""Friction force along the bar at the chosen instant."""

from __future__ import annotations

from typing import Any

from app.views.colors import BLUE, GHOST, GREEN, GREY, ORANGE
from app.views.drawing import POSITION, Axis, Curve, Drawing, Plot, Scene, View, is_plane
from app.views.legend import Key
from app.views.scales import across, decimal_scale, length_of, spanned, upright
from solver.settings import Settings


def applies(settings: Settings) -> bool:
    """Plane bodies have no bound that is known beforehand, and tractions instead."""
    return not is_plane(settings)


def draw(scene: Scene, _kept: Any) -> Drawing | None:
    """Draw the force per length, with its bounds, the reference, the closed form and the ghost."""
    run, begun, instant = scene.run, scene.run.stand, scene.instant
    if begun.bound is None:
        return None
    top = float(begun.bound.max()) or 1.0
    factor, unit = decimal_scale(top, "N/m")
    x = spanned(0.0, length_of(run.settings))
    y = Axis(-1.25 * top / factor, 1.25 * top / factor, label=f"Friction force ({unit})")
    places, bound = begun.positions, begun.bound / factor
    curves = [
        upright(begun.cuts, y, color=GREY, alpha=0.35, width=1),
        across([0.0], x, color=GREY, alpha=0.4, width=1),
        Curve(places, bound, GREY, 1.5, "dashed"),
        Curve(places, -bound, GREY, 1.5, "dashed"),
    ]
    keys = [Key(BLUE, "line", scene.name)]
    if run.reference is not None:
        keys.append(Key(ORANGE, "line", "reference"))
    if begun.closed_form is not None:
        curves.append(Curve(places, begun.closed_form[:, instant] / factor, GREEN, 7))
        keys.append(Key(GREEN, "band", "closed form"))
    if scene.ghost is not None:
        before, fields, then = scene.ghost
        curves.append(Curve(before.stand.positions, fields.friction[:, then] / factor, GHOST, 2))
        keys.append(Key(GHOST, "line", scene.ghost_name))
    if run.reference is not None:
        force = run.reference.friction[:, instant] / factor
        curves.append(Curve(places, force, ORANGE, 4.5))
    curves.append(Curve(places, scene.frame.fields.friction[:, instant] / factor, BLUE))
    return Drawing(x, y, curves, keys=(*keys, Key(GREY, "dashed", "±μp")))


VIEW = View("Friction force", Plot(POSITION, "Friction force (N/m)"), draw, applies)
