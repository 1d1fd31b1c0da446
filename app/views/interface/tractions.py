"""Pressure and friction along an interface of plane bodies at the chosen instant."""

from __future__ import annotations

import numpy as np

from app.picture.frames import DrawnFields, Stand
from app.picture.shown import Floats, floats
from app.views import brought
from app.views.drawing.colors import BLUE, GREEN, GREY, ORANGE, PURPLE
from app.views.drawing.drawing import POSITION, Curve, Drawing, Plot, View, is_plane
from app.views.drawing.legend import Key
from app.views.drawing.scales import Limits, along, held, spanned, upright
from app.views.scene import Scene

PRESSURE = Key(PURPLE, "line", "pressure p")
KEYS = Key(BLUE, "line", "friction"), Key(GREY, "dashed", "±μp")
KNOWN = Key(BLUE, "line", "friction"), Key(GREY, "dashed", "±μ(σ−p)")


def draw(scene: Scene, kept: Limits | None) -> Drawing | None:
    """Draw both tractions on the body above, with the bound of friction: what the pressure gives.

    Where that is given, as on a fault, no pressure is found.

    The scale holds all instants.
    """
    run, begun, now, instant = scene.run, scene.run.stand, scene.frame.fields, scene.instant
    bound = _bound(begun, now)
    if bound is None:
        return None
    top = float(bound.max())
    drawn = [now, scene.ghost[1]] if scene.ghost is not None else [now]
    shown = [one for each in drawn for one in (each.pressure, each.friction) if one is not None]
    shown += brought.friction_of(scene)
    exact = [*begun.known("pressure"), *begun.known("friction")]
    ends = [(float(one.min()), float(one.max())) for one in shown]
    ends += [(float(one.up.min()), float(one.up.max())) for one in exact]
    low, high = min(low for low, _ in ends), max(high for _, high in ends)
    limits = held(kept, min(low, -top), max(high, top))
    y = spanned(*limits, label="Traction", unit="Pa")
    curves = [upright(begun.cuts, y, color=GREY, alpha=0.35, width=1)]
    keys = list(KNOWN) if now.pressure is None else [PRESSURE, *KEYS]
    past = list[Key]()
    if scene.ghost is not None:
        before, fields, then = scene.ghost
        curves += _pair(before.stand.positions, fields, then, width=1.2)
        past.append(Key(BLUE, "thin", scene.ghost_name))
    places = begun.positions
    if exact:
        keys.append(Key(GREEN, "band", "closed form"))
        curves += [Curve(one.across, one.up[:, instant], GREEN, 7) for one in exact]
    if run.reference is not None:
        keys.append(Key(ORANGE, "line", "reference"))
        curves += _pair(places, run.reference, instant, ORANGE, width=4.5)
    for sign in (1.0, -1.0):
        limit = sign * bound[:, min(instant, bound.shape[1] - 1)]
        curves.append(Curve(places, limit, GREY, 1.5, "dashed"))
    theirs, more = brought.along(scene)
    curves += [*_pair(places, now, instant), *theirs]
    return Drawing(along(0.0, scene.length), y, curves, keys=(*keys, *past, *more), kept=limits)


def _bound(begun: Stand, now: DrawnFields) -> Floats | None:
    """Give the largest friction, shape (n_positions, n_instants), or (n_positions, 1), Pa."""
    if begun.coefficient is None or now.pressure is None:
        return begun.bound
    return floats(begun.coefficient[:, None] * np.maximum(now.pressure, 0.0))


def _pair(
    places: np.ndarray,
    fields: DrawnFields,
    instant: int,
    color: str = "",
    width: float = 2.5,
) -> list[Curve]:
    """Give pressure and friction, in their own colours or in one."""
    found = []
    for field, own in ((fields.pressure, PURPLE), (fields.friction, BLUE)):
        if field is not None:
            found.append(Curve(places, field[:, instant], color or own, width))
    return found


VIEW = View("Contact tractions", Plot(POSITION, "Traction"), draw, is_plane)
