"""The scene itself: bodies, what holds them, what acts on them, and where they slip."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from app.picture.portrait import Portrait, Pose
from app.views import sketch
from app.views.colors import BACKWARD, FORCE, FORWARD, GHOST, GIVEN, GREY, VERMILION, shaded
from app.views.deformed import fitting, ghosts_of, reach_of, sizes_of
from app.views.drawing import Colors, Curve, Drawing, Plot, QuadMesh, Scene, View, Word
from app.views.handles import Handle, choices, on_arrow, on_bodies
from app.views.legend import Key
from app.views.scales import decimal_scale
from solver.arrays import Array
from solver.discrete.structure import OUTWARD, Act, Hold, ends_of
from solver.scenes import behind
from solver.settings import Settings

ARROW = 0.17
"""Length of the largest arrow, as a share of the size of what is drawn."""
LEAST = 0.02
"""Share of its largest value below which an arrow is not drawn."""
HATCH, ROOM, WORDS = 0.03, 0.06, 0.48
"""Depth of a hatch, room around what is drawn, and for words beside it; shares of the size."""
DEEPEST = 0.2
"""Gap below a body that is drawn at most, as a share of the size."""
SHADES = shaded(64)
SLIPS = ((-1, BACKWARD), (1, FORWARD))


def draw(scene: Scene, kept: float | None) -> Drawing:
    """Draw the scene at the chosen instant; displacements are magnified until they show."""
    portrait, pose = scene.run.stand.portrait, scene.frame.pose
    factor = scene.look.magnification
    fit = fitting(portrait.mesh, pose.largest, kept or 1.0)
    artist = _Artist(portrait, pose, factor or fit, float(scene.run.stand.instants[scene.instant]))
    acts = portrait.described.acts
    strokes = [Curve(*artist.placed(one), GREY, 1, "dotted") for one in artist.outlines()]
    strokes += [Curve(*artist.placed(one), GREY, 1.5) for one in artist.held()]
    last = int(portrait.mesh.parts.max())
    words: list[Word] = []
    arrows = []
    for act in acts:
        color = GIVEN if act.unit == "m" else FORCE
        own, found = artist.arrows(act)
        arrows.append((act, own))
        drawn = sketch.joined(sketch.arrow(tail, head, artist.size) for tail, head in own)
        strokes.append(Curve(*artist.placed(drawn), color, 2.5))
        words += [Word(*artist.placed(place), text, *align) for place, text, align in found]
    settings = scene.run.settings
    if settings.applies("pgd_modes") and last:
        chosen = scene.look.substructure
        part = last if chosen is None else min(chosen, last)
        strokes += [Curve(*artist.placed(one), VERMILION, 2.5) for one in artist.outline_of(part)]
    outlines, ghosts = ghosts_of(scene, factor or fit)
    strokes += [Curve(*artist.placed(one), GHOST, 1.5) for one in outlines]
    place = scene.look.place
    if place is not None:
        strokes.append(Curve(*artist.placed(artist.across(place)), VERMILION, 1.5))
        ghosts = [*ghosts, Key(VERMILION, "line", f"x = {place:.3g} m")]
    width = 7 if portrait.chains.max() == 0 else 4
    slips = [Curve(*artist.placed(artist.band(status)), color, width) for status, color in SLIPS]
    return Drawing(
        bodies=QuadMesh(
            portrait.mesh.quads,
            np.stack(artist.placed(artist.nodes), axis=1).astype(np.float32),
            portrait.mesh.parts.astype(np.float32),
            artist.box(acts, reach_of(scene), sizes_of(scene)),
            portrait.mesh.nodes[portrait.mesh.quads, 0].mean(axis=1),
        ),
        colors=Colors(0, max(last, 1)),
        curves=[*strokes, *slips],
        words=words,
        contacts=artist.contacts(scene.run.stand.interfaces),
        handles=artist.handles(arrows, scene.run.settings),
        keys=(*_keys(portrait, factor or fit), *ghosts),
        kept=fit,
    )


def _keys(portrait: Portrait, factor: float) -> tuple[Key, ...]:
    keys = [Key(BACKWARD, "square", "slip −"), Key(FORWARD, "square", "slip +")]
    keys.append(Key(GREY, "bare", f"displacement × {factor:g}"))
    if portrait.described.height is None:
        keys.append(Key(GREY, "bare", "thickness not to scale"))
    return tuple(keys)


class _Artist:
    """Draws one instant, in the axes of the bodies; `placed` turns them as they lie."""

    def __init__(self, portrait: Portrait, pose: Pose, factor: float, time: float) -> None:
        self._portrait, self._pose, self._factor, self._time = portrait, pose, factor, time
        self._described = portrait.described
        self._length, self._height = portrait.size
        self.size = max(portrait.size)
        tilt = self._described.tilt
        self._tilts = np.zeros(1) if tilt is None else tilt
        self._tilt = float(self._now(tilt)) if tilt is not None else 0.0
        self.nodes: Array = portrait.mesh.nodes + np.float32(factor) * pose.displacement

    def placed(self, points: Array) -> tuple[Array, Array]:
        """Give x and y of points on the page."""
        found = sketch.turned(np.asarray(points, dtype=np.float64), self._tilt)
        return found[..., 0], found[..., 1]

    def box(
        self, acts: Sequence[Act], reach: float, sizes: Array
    ) -> tuple[float, float, float, float]:
        """Give the ends of what is seen at any instant.

        Nothing moves farther than the reach, m, and no body ends beyond the sizes, (2,), m.
        """
        moves = self._factor * reach
        sides = dict.fromkeys(OUTWARD, (ROOM + HATCH) * self.size + moves)
        gap = self._gap()
        if gap is not None:
            sides["bottom"] = float(gap.max()) + 2 * HATCH * self.size
        for act in acts:
            side = next(name for name, away in OUTWARD.items() if away == act.away)
            words = WORDS * self.size if side in ("left", "right") else 0.0
            sides[side] = max(sides[side], (ARROW + ROOM) * self.size + words + moves)
        left, low = -sides["left"], -sides["bottom"]
        right = max(self._length, float(sizes[0])) + sides["right"]
        high = max(self._height, float(sizes[1])) + sides["top"]
        corners = np.array([[left, low], [right, low], [right, high], [left, high]])
        angles = np.linspace(float(self._tilts.min()), float(self._tilts.max()), 5)
        found = np.concatenate([sketch.turned(corners, float(angle)) for angle in angles])
        (left, low), (right, high) = found.min(axis=0), found.max(axis=0)
        return float(left), float(right), float(low), float(high)

    def outlines(self) -> Iterator[Array]:
        """Give the undeformed bodies."""
        nodes = self._portrait.mesh.nodes[self._portrait.mesh.quads]
        for body in nodes.reshape(self._described.bodies, -1, 2):
            (left, low), (right, high) = body.min(axis=0), body.max(axis=0)
            yield sketch.line((left, low), (right, low), (right, high), (left, high), (left, low))

    def outline_of(self, part: int) -> Iterator[Array]:
        """Give the deformed edge of a substructure: sides that only one of its quads has."""
        quads = self._portrait.mesh.quads[self._portrait.mesh.parts == part]
        sides = np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2)
        _, first, counts = np.unique(
            np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True
        )
        yield sketch.joined(self.nodes[sides[first[counts == 1]]])

    def held(self) -> Iterator[Array]:
        """Give what holds the bodies: supports, clamps, rollers, a spring."""
        draws = {
            "clamp": self._clamp,
            "rollers": self._rollers,
            "support": self._support,
            "spring": self._spring,
        }
        for hold in self._described.holds:
            yield from draws[hold.kind](hold)

    def _ends(self, hold: Hold) -> Array:
        """Give both ends of the part of a side that is held, undeformed, shape (2, 2), m."""
        first, last = ends_of(hold.side) * [self._length, self._height]
        return np.array([first + share * (last - first) for share in hold.stretch])

    def _clamp(self, hold: Hold) -> Iterator[Array]:
        depth, ends = HATCH * self.size, self._ends(hold)
        if self._described.height is None:
            ends += [[0.0, -depth], [0.0, depth]]
        if hold.moved is not None:
            ends[:, 0] += self._factor * float(self._now(hold.moved))
        yield sketch.hatched(ends, depth, 1.0 if hold.side in ("left", "top") else -1.0)

    def _rollers(self, hold: Hold) -> Iterator[Array]:
        depth = HATCH * self.size
        first, last = self._ends(hold) + 0.5 * depth * np.array(OUTWARD[hold.side])
        yield sketch.rollers(first, last, 0.5 * depth)

    def _support(self, hold: Hold) -> Iterator[Array]:
        edge, gap = self._ends(hold), self._gap()
        if gap is not None:
            x = np.linspace(0.0, self._length, len(gap))
            edge = np.stack([x, -gap], axis=1)
            beyond = ROOM * self.size + self._factor * self._pose.largest
            aside = np.array([[beyond, 0.0]])
            edge = np.concatenate([edge[:1] - aside, edge, edge[-1:] + aside])
        yield sketch.hatched(edge, HATCH * self.size)

    def _spring(self, hold: Hold) -> Iterator[Array]:
        depth, foot = HATCH * self.size, self._ends(hold)[:1]
        wall = foot[0] + [0.25 * self.size, depth]
        yield sketch.spring(self._moved(foot)[0] + [0.0, depth], wall, 0.5 * depth)
        half = np.array([0.0, depth])
        yield sketch.hatched(np.stack([wall - half, wall + half]), depth)

    def across(self, place: float) -> Array:
        """Give a line through all bodies at a place along them, m."""
        return self._moved(np.array([[place, 0.0], [place, self._height]]))

    def contacts(self, names: Sequence[str]) -> dict[str, Array]:
        """Give where interfaces lie, as far as there are several to choose from."""
        places = self._portrait.places + np.float32(self._factor) * self._pose.slid
        found = {name: places[self._portrait.chains == number] for number, name in enumerate(names)}
        return {name: np.stack(self.placed(one), axis=1) for name, one in choices(found).items()}

    def handles(
        self, arrows: Sequence[tuple[Act, Sequence[Array]]], settings: Settings
    ) -> list[Handle]:
        """Give what can be dragged, with the arrows of what acts, where it lies on the page."""
        found = list(on_bodies(self._portrait, settings, self._gap()))
        names = behind(settings)
        for act, own in arrows:
            if act.where in names:
                found += [on_arrow(names[act.where], settings, arrow, self.size) for arrow in own]
        if found:
            x, y = self.placed(np.stack([one.ends for one in found]))
            ends = np.stack([x, y], axis=2)
            found = [replace(one, ends=own) for one, own in zip(found, ends, strict=True)]
        return found

    def arrows(self, act: Act) -> tuple[list[Array], list[tuple[Array, str, tuple[str, str]]]]:
        """Give tails and heads of what acts, and the value beside it: place, words, alignment."""
        peak = float(np.abs(act.values).max())
        unit, name = decimal_scale(peak, act.unit)
        now = self._now(act.values)
        shares = np.broadcast_to(now / peak, len(act.places))
        places = act.places * [self._length, self._height]
        towards, away = np.array(act.towards), np.array(act.away)
        if towards.ndim > 1:
            towards = self._now(towards)
        is_aside = np.ndim(act.towards) < 2 and abs(float(towards @ away)) < 0.5
        ends, drawn, words = [], [], []
        for place, share in zip(self._moved(places), shares, strict=True):
            length = ARROW * self.size * float(share) * towards
            base = place + (0.5 * ROOM * self.size) * away if is_aside else place
            if is_aside:
                tail, head = base - 0.5 * length, base + 0.5 * length
            elif length @ away >= 0.0:
                tail, head = base, base + length
            else:
                tail, head = base - length, base
            if abs(share) > LEAST:
                drawn.append(np.stack([tail, head]))
            outer = base if is_aside else max((tail, head), key=lambda end: float(end @ away))
            ends.append(outer + 0.25 * ROOM * self.size * away)
        chosen = range(len(ends)) if np.ndim(now) else [len(ends) // 2]
        for number in chosen:
            value = float(np.broadcast_to(now, len(ends))[number]) / unit
            says = f"{act.symbol} = {sketch.plain(value)} {name}"
            words.append((ends[number], says, sketch.aligned(act.away)))
        return drawn, words

    def band(self, status: int) -> Array:
        """Give the stretches of all contacts that have a status."""
        pose, portrait = self._pose, self._portrait
        places = portrait.places + np.float32(self._factor) * pose.slid
        strokes = []
        for chain in range(int(portrait.chains.max()) + 1):
            own = portrait.chains == chain
            strokes += sketch.stretches(places[own], pose.status[own] == status)
        return sketch.joined(strokes)

    def _gap(self) -> Array | None:
        """Give the gap as it is drawn: magnified as displacements are, and at most so deep."""
        gaps = [hold.gap for hold in self._described.holds if hold.gap is not None]
        return np.minimum(self._factor * gaps[0], DEEPEST * self.size) if gaps else None

    def _moved(self, places: Array) -> Array:
        """Give where the nodes nearest to undeformed places have gone, as seen from there."""
        nodes = self._portrait.mesh.nodes
        nearest = [int(np.argmin(np.sum((nodes - place) ** 2, axis=1))) for place in places]
        return np.asarray(places + self._factor * self._pose.displacement[nearest])

    def _now(self, values: Array) -> Array:
        """Give values over time at the chosen instant."""
        instants = self._described.instants
        flat = np.atleast_2d(values)
        found = np.array([np.interp(self._time, instants, one) for one in flat])
        return found if values.ndim > 1 else found[0]


VIEW = View(
    "Scene",
    Plot(
        "",
        "",
        palette=tuple(SHADES),
        equal=True,
        words=True,
        chooses="substructure",
        is_touched=True,
    ),
    draw,
)
