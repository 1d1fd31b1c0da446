"""Axial force in the wires of a strand at the chosen instant."""

from __future__ import annotations

import numpy as np

from app.picture.labels import called
from app.picture.shown import Wires
from app.views.drawing.colors import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from app.views.drawing.drawing import POSITION, Curve, Drawing, Plot, View
from app.views.drawing.legend import Key
from app.views.drawing.scales import Limits, along, held, spanned
from app.views.scene import Scene
from solver.phrases import Phrase
from solver.scenes import kind_of

SHARED = 1.5
"""Times the tension: what neighbours take over from a wire between two others."""
WIRE_COLORS = (BLUE, ORANGE, PURPLE, SKY, GREY)


def draw(scene: Scene, kept: Limits | None) -> Drawing | None:
    """Draw the force along every wire; the broken one regains it from its break on.

    The scale holds all instants: the largest tension, and what a break adds to it.
    """
    if scene.run.stand.strand is not None:
        return _of_one(scene, kept)
    wires, axial = scene.run.stand.wires, scene.frame.axial
    if wires is None or axial is None:
        return None
    load = scene.run.stand.load if scene.run.stand.load is not None else scene.frame.fields.load
    assert load is not None
    top = max(SHARED * float(np.abs(load).max()), float(axial.max()))
    limits = held(kept, min(-0.1 * top, float(axial.min())), top)
    curves = []
    exact = scene.run.stand.known("axial force")
    curves += [Curve(one.across, one.up[:, scene.instant], GREEN, 7) for one in exact]
    for place in np.argsort([number == wires.broken for number in wires.numbers], kind="stable"):
        number = wires.numbers[place]
        width = 3.5 if number == wires.broken else 2.0
        curves.append(Curve(wires.positions, axial[place], _color(number, wires), width))
    return Drawing(
        along(0.0, scene.run.settings.length),
        spanned(*limits, label="Axial force", unit="N"),
        curves,
        keys=_keys(wires, is_exact=bool(exact)),
        kept=limits,
    )


def _of_one(scene: Scene, kept: Limits | None) -> Drawing | None:
    """Draw the force along the chosen wire of a strand that is bent, which slip keeps low."""
    stand, field = scene.run.stand, scene.frame.strand
    if stand.strand is None or field is None:
        return None
    values = np.concatenate([field.force, field.stuck_force])
    limits = held(kept, float(values.min()), float(values.max()))
    places = stand.strand.middles * (stand.length or scene.length)
    return Drawing(
        along(0.0, scene.length),
        spanned(*limits, label="Axial force", unit="N"),
        [
            Curve(places, field.stuck_force, GREY, 1.5, "dashed"),
            Curve(places, field.force, BLUE),
        ],
        keys=(
            Key(BLUE, "line", called(stand.interface, stand.interfaces)),
            Key(GREY, "dashed", "all stick"),
        ),
        kept=limits,
    )


def _color(number: int, wires: Wires) -> str:
    if number == wires.broken:
        return VERMILION
    return WIRE_COLORS[(number - 1) % len(WIRE_COLORS)]


def _keys(wires: Wires, *, is_exact: bool) -> tuple[Key, ...]:
    shown = wires.numbers[:5]
    if wires.broken and wires.broken not in shown:
        shown = (*shown[:4], wires.broken)
    named = (Phrase("{}, broken", n) if n == wires.broken else str(n) for n in shown)
    keys = [Key(_color(n, wires), "line", name) for n, name in zip(shown, named, strict=True)]
    return (*keys, *((Key(GREEN, "band", "closed form"),) if is_exact else ()))


VIEW = View(
    "Force in the wires",
    Plot(POSITION, "Axial force"),
    draw,
    lambda settings: kind_of(settings) in ("wires", "helices"),
)
