"""The scene itself: bodies, what holds them, what acts on them, and where they slip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from app.picture.portrait import THICKNESS, Portrait
from app.picture.units import measured
from app.views.bodies import acting
from app.views.bodies.acting import Arrow
from app.views.bodies.deformed import fitting, ghosts_of, reach_of, sizes_of
from app.views.bodies.held import BEYOND, WALL, held, room_of
from app.views.bodies.posed import Posed
from app.views.drawing.colors import (
    BACKWARD,
    FORCE,
    FORWARD,
    GHOST,
    GIVEN,
    GREY,
    SLIP,
    STICK,
    VERMILION,
    shaded,
)
from app.views.drawing.drawing import Box, Colors, Curve, Drawing, Plot, QuadMesh, View
from app.views.drawing.handles import Handle, on_arrow, on_bodies
from app.views.drawing.legend import Key
from app.views.drawing.scales import round_up
from app.views.scene import Scene
from solver.arrays import Array
from solver.discrete.structure import OUTWARD, Act
from solver.phrases import Phrase, joined
from solver.scenes import behind
from solver.settings import Settings

MARGIN = 6.0
"""Pixels that are left free on every side."""
FILLED, LAYERS_FILL = 0.45, 0.65
"""Shares of its height that bodies have where that is not to scale: of rods, and of layers."""
THICKEST, LAYER, STRAND = 72.0, 40.0, 90.0
"""Pixels of the thickness of a rod, a layer and a strand, at most; none is to scale."""
SHADES = shaded(64)
PALETTE = *SHADES, BACKWARD, STICK, FORWARD
"""Colours of substructures, and then of what slips."""
_OF_PARTS = len(PALETTE) / (len(SHADES) - 1e-3)
"""Times the last substructure: where the whole palette ends, if that has the last shade."""
_COLORS = Colors(0, len(PALETTE))
STEPS = 0.008, 0.01, 0.02, 0.03, 0.045, 0.06, 0.09
"""Shares of the bodies' size that displacements usually take."""
STATUSES = ((0, STICK, "stick"), (-1, BACKWARD, "slip −"), (1, FORWARD, "slip +"))
LEANEST = 4.0
"""Times their height that long bodies count at most, where a displacement is to show: room for one
that bends far would leave them thin."""
SEAMLESS = 0.2
"""How opaque the lines around parts of a wire are, so that none shows where two parts meet."""
FEW_BODIES = 8
"""Bodies above each other with room for a broad band between them."""


@dataclass(frozen=True)
class Scale:
    """What a picture keeps for the next: the factor on displacements, and how far these reach, m.

    The reach is a share of the bodies' size as it is drawn.
    """

    factor: float
    reach: float


def draw(scene: Scene, kept: Scale | None) -> Drawing:
    """Draw the scene at the chosen instant; displacements are magnified until they show."""
    portrait = scene.run.stand.portrait
    scale = _scale(scene, kept)
    instant = float(scene.run.stand.instants[scene.instant])
    posed = Posed(portrait, scene.frame.pose, scale.factor, instant)
    acts = posed.described.acts
    arrows = [(act, acting.arrows(posed, act)) for act in acts]
    outlines, ghosts = ghosts_of(scene, scale.factor)
    last, place = int(portrait.mesh.parts.max()), scene.look.place
    is_told = scene.frame.pose.colors is not None
    if place is not None:
        ghosts = [*ghosts, Key(VERMILION, "line", f"x = {measured(place, 'm', scene.look.units)}")]
    box = _box(posed, scale.reach * posed.size, sizes_of(scene))
    return Drawing(
        bodies=QuadMesh(
            portrait.mesh.quads,
            posed.placed(posed.nodes).astype(np.float32),
            _values(scene),
            box,
            portrait.mesh.nodes[portrait.mesh.quads, 0].mean(axis=1),
            lines=SEAMLESS if posed.is_strand else 1.0,
        ),
        colors=_COLORS if is_told else Colors(0, max(last, 1) * _OF_PARTS),
        curves=[
            *(posed.curve(one, GREY, 1, dash="dotted") for one in posed.outlines()),
            *(posed.curve(one, GREY, 1.5) for one in held(posed)),
            *(_lines(posed) if is_told else _bands(posed)),
            *(posed.curve(one, GREY, 2.5) for one in posed.broken()),
            *(
                posed.curve(acting.stroke(act, own), GIVEN if act.unit == "m" else FORCE, 2.5)
                for act, own in arrows
            ),
            *_chosen(posed, scene, last),
            *(posed.curve(one, GHOST, 1.5) for one in outlines),
        ],
        words=acting.words(posed, box, scene.look.units),
        contacts=posed.contacts(scene.run.stand.interfaces),
        handles=_handles(posed, portrait, arrows, scene.run.settings),
        sentence=joined(" ", (scene.run.stand.words, SLIP)),
        keys=(*_keys(posed, last + 1), *ghosts),
        kept=scale,
    )


def _scale(scene: Scene, kept: Scale | None) -> Scale:
    """Give the scale of what is seen; while a hand moves a slider, the one that there is."""
    portrait, chosen = scene.run.stand.portrait, scene.look.magnification
    size = max(portrait.size)
    shows = min(size, LEANEST * portrait.size[1]) if portrait.described.height is not None else size
    factor = chosen or (kept.factor if kept else 1.0)
    if chosen is None and not (kept and scene.look.is_held):
        factor = fitting(shows, scene.frame.pose.largest, factor)
    share = factor * reach_of(scene) / size
    least = kept.reach if kept and (scene.look.is_held or share >= 0.4 * kept.reach) else 0.0
    return Scale(factor, least if share <= least else _stepped(share))


def _stepped(share: float) -> float:
    """Give the next of a few values, so that what is seen changes seldom."""
    return next((step for step in STEPS if share <= step), round_up(share))


def _box(posed: Posed, moves: float, sizes: Array) -> Box:
    """Give what is seen at any instant, of bodies that move so far and end at these sizes, m."""
    described = posed.described
    sides = dict.fromkeys(OUTWARD, moves)
    if described.height is None:
        sides["top"] = sides["bottom"] = 0.0
    rooms = dict.fromkeys(OUTWARD, MARGIN)
    for hold in described.holds:
        rooms[hold.side] = max(rooms[hold.side], MARGIN + room_of(hold))
        if hold.side in ("left", "right"):
            rooms |= {side: max(rooms[side], MARGIN + BEYOND) for side in ("bottom", "top")}
        if hold.kind == "clamp" and hold.moved is None:
            sides[hold.side] = 0.0
        elif hold.kind == "support":
            gap = posed.gap()
            sides["bottom"] = 0.0 if gap is None else float(gap.max())
        elif hold.kind == "spring":
            sides["right"] += WALL * posed.size
    for act in described.acts:
        if (side := acting.side_of(act)) in rooms:
            rooms[side] = max(rooms[side], MARGIN + acting.room_of(act))
    left, low = -sides["left"], -sides["bottom"]
    right = max(posed.length, float(sizes[0])) + sides["right"]
    high = max(posed.height, float(sizes[1])) + sides["top"]
    corners = np.array([[left, low], [right, low], [right, high], [left, high]])
    angles = np.linspace(float(posed.tilts.min()), float(posed.tilts.max()), 5)
    found = np.concatenate([posed.turned(corners, float(angle)) for angle in angles])
    (left, low), (right, high) = found.min(axis=0), found.max(axis=0)
    if described.tilt is not None:
        rooms["left"] = rooms["right"] = rooms["bottom"]
    return Box(
        float(left),
        float(right),
        float(low),
        float(high),
        room=(rooms["left"], rooms["right"], rooms["bottom"], rooms["top"]),
        lines=acting.lines_of(posed),
        flattest=_flattest(posed),
        filled=FILLED if described.height is None else LAYERS_FILL,
    )


def _flattest(posed: Posed) -> float:
    """Give the metres up in a pixel at least, of long bodies."""
    if posed.described.height is None:
        return THICKNESS * posed.length / THICKEST
    thick = STRAND if posed.is_strand else LAYER
    return posed.height / posed.described.bodies / thick if posed.is_long else 0.0


def _values(scene: Scene) -> NDArray[np.float32]:
    """Give what colours the bodies: their substructures, or what slips where they are wires."""
    told = scene.frame.pose.colors
    if told is None:
        return scene.run.stand.portrait.mesh.parts.astype(np.float32)
    return (told + (len(SHADES) + 1.5)).astype(np.float32)


def _lines(posed: Posed) -> list[Curve]:
    """Give the lines between the wires of a strand."""
    return [posed.curve(posed.seams(), GREY, 1)]


def _bands(posed: Posed) -> list[Curve]:
    """Give bands along contacts, beside a single body and between several."""
    bodies, is_flat = posed.described.bodies, posed.described.height is None
    width = 6 if bodies == 1 else 5 if is_flat and bodies <= FEW_BODIES else 3
    return [posed.band(one, color, width) for one, color, _ in _statuses(posed)]


def _statuses(posed: Posed) -> tuple[tuple[int, str, str], ...]:
    """Give what has a colour: layers upon each other would be hidden by what sticks."""
    is_stacked = posed.described.bodies > 1 and posed.described.height is not None
    return STATUSES[1:] if is_stacked else STATUSES


def _chosen(posed: Posed, scene: Scene, last: int) -> list[Curve]:
    """Mark the substructure whose modes are looked at, and the chosen place."""
    found, look = [], scene.look
    if scene.run.settings.applies("pgd_modes") and last:
        part = last if look.substructure is None else min(look.substructure, last)
        found.append(posed.curve(posed.outline_of(part), VERMILION, 2.5))
    stand = scene.run.stand
    if stand.strand is not None:
        wire = posed.line_of(stand.interfaces.index(stand.interface))
        found.append(posed.curve(wire, VERMILION, 2))
    if look.place is not None:
        found.append(posed.curve(posed.across(look.place), VERMILION, 1.5))
    return found


def _handles(
    posed: Posed,
    portrait: Portrait,
    arrows: Sequence[tuple[Act, Sequence[Arrow]]],
    settings: Settings,
) -> list[Handle]:
    """Give what can be dragged, with the arrows of what acts, where it lies on the page."""
    found, names = list(on_bodies(portrait, settings, posed.gap())), behind(settings)
    for act, own in arrows:
        if act.where in names:
            found += [on_arrow(names[act.where], settings, one.stroke) for one in own]
    return [replace(one, ends=posed.placed(one.ends)) for one in found]


def _keys(posed: Posed, parts: int) -> tuple[Key, ...]:
    keys = [Key(color, "square", text) for _, color, text in _statuses(posed)]
    keys.append(Key(GREY, "bare", Phrase("displacement × {}", f"{posed.factor:g}")))
    if posed.is_long:
        keys.append(Key(GREY, "bare", "thickness not to scale"))
    return (
        (Key(GREY, "strip", Phrase("{} substructures", parts)), *keys) if parts > 1 else tuple(keys)
    )


VIEW = View(
    "Scene",
    Plot(
        "",
        "",
        palette=PALETTE,
        equal=True,
        words=True,
        chooses="substructure",
        is_touched=True,
    ),
    draw,
)
