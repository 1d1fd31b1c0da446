"""All that one picture shows, as columns of its sources, px."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from app.frame import OPEN, Frame
from app.units import number
from app.views.acts import Arrow, Word, arrows_of, beam_of, gap_of, strokes_of, words_of
from app.views.colors import DISPLACEMENT, EDGE, ERROR, FORCE, STATUS
from app.views.layout import BAND, FOOT, IMAGE, LETTER, NARROW, Layout, turned
from app.views.outlines import Outlines, bands, drawn
from app.views.view import joined
from solver.arrays import Array
from solver.discrete.structure import Act

Columns = dict[str, Any]
Strokes = list[tuple[list[Array], str, float]]
"""Lines on the page that have a colour and a width, px."""


@dataclass(frozen=True)
class Handle:
    """What can be dragged: its place, px from the middle of the foot, and what it sets."""

    setting: str
    """Its name."""
    place: Array
    color: str
    """Of what it belongs to."""
    value: Callable[[float, Array], float]
    """The setting, by the one at present and where the pointer is."""


@dataclass(eq=False)
class Picture:
    """A frame at one instant."""

    frame: Frame
    column: int
    """Of the instant in it."""
    layout: Layout
    factor: float
    outlines: Outlines
    """Where bodies lie, how much displacements are magnified, and the lines of the bodies."""
    peaks: Mapping[str, float]
    """Values of arrows of full length, by what acts."""
    behind: Mapping[str, str]
    """Settings behind what acts, by where it does."""
    shows_status: bool
    """Whether there are keys to the colours of what rubs."""

    def __post_init__(self) -> None:
        self._geometry = self.frame.run.geometry
        self._described = self._geometry.description
        # Values of a description are not thinned.
        instant = self.frame.run.instants[self.column]
        self._now = int(np.argmin(np.abs(self._described.instants - instant)))
        tilt = self._described.tilt
        self.tilt = 0.0 if tilt is None else float(tilt[self._now])

    @cached_property
    def nodes(self) -> Array:
        """Deformed nodes, px from the middle of the foot."""
        moved = self.frame.deformed.nodes[:, :, self.column]
        return self.layout.local(self._geometry.nodes) + self.layout.shift(moved, self.factor)

    @cached_property
    def points(self) -> Array:
        """Contact points on the page, px."""
        moved = self.frame.deformed.points[:, :, self.column]
        local = self.layout.local(self._geometry.points) + self.layout.shift(moved, self.factor)
        if self._described.height is None:
            # A band is thinner than the room that is left for it.
            return self.layout.page(local, self.tilt)
        beside = [0.0, -0.5 * BAND if self._described.bodies == 1 else 0.0]
        is_above = self._geometry.points[:, 1:] <= 1e-6 * self.layout.length
        return self.layout.page(local + is_above * beside, self.tilt)

    @cached_property
    def acts(self) -> dict[Act, tuple[Array, list[Arrow]]]:
        """Where all that acts does, and its arrows."""
        size = np.array([self.layout.length, self.layout.top])
        found = {}
        for act in self._described.acts:
            places = self._follow(act.places * size)
            arrows = arrows_of(
                act, self._described, self.layout, self.peaks[act.where], self._now, places
            )
            found[act] = places, arrows
        return found

    @cached_property
    def handles(self) -> list[Handle]:
        """All that can be dragged."""
        handles = []
        for act, (_, arrows) in self.acts.items():
            name = self.behind.get(act.where)
            if name is not None and arrows:
                arrow = max(arrows, key=lambda one: abs(one.value))
                handles.append(Handle(name, arrow.handle, _color(act), _scaled_by(arrow)))
        gap = gap_of(self._described, self.layout, self.factor)
        if "gap" in self.behind and gap is not None and -gap[-1, 1] > 1.0:
            depth = -float(gap[-1, 1])
            # What is behind a gap is a radius: the larger, the shallower.
            handles.append(
                Handle("radius", gap[-1], EDGE, lambda r, at: r * depth / max(-float(at[1]), 2.0))
            )
        if "break" in self.behind and self._described.broken is not None:
            ends = self.nodes[self.outlines.broken.ravel()]
            if len(ends):
                place = ends.mean(axis=0)
                handles.append(Handle(self.behind["break"], place, FORCE, self._to_place))
        return handles

    def columns(self) -> dict[str, Columns]:
        """Columns of all sources, by their names."""
        marks, keys = self._keys()
        for handle in self.handles:
            marks.append((self._page(handle.place), "circle", "white", handle.color, 2.5))
        places, *looks = zip(*marks, strict=True) if marks else [()] * 5
        names = "marker", "fill_color", "line_color", "line_width"
        columns = dict(zip(names, map(list, looks), strict=True))
        x, y = np.reshape(places, (-1, 2)).T
        return {
            "bodies": self._bodies(),
            "strokes": self._strokes(),
            "heads": self._heads(),
            "marks": {"x": x, "y": y, **columns},
            "words": _texts(keys, self._words(), self.layout),
        }

    def ghost(self, frame: Frame, column: int, outlines: Outlines) -> Array:
        """Outline of another run's bodies at the same scale, on the page, (2, n), px."""
        nodes = self.layout.local(frame.run.geometry.nodes)
        nodes = nodes + self.layout.shift(frame.deformed.nodes[:, :, column], self.factor)
        return self._page(drawn(outlines.rims, nodes)).T.astype(np.float32)

    def to_local(self, x: float, y: float) -> Array:
        """A place on the page from the middle of the foot, along the bodies, px."""
        return turned(np.array([x, y]) - self.layout.origin, -self.tilt)

    def _page(self, local: Array) -> Array:
        return self.layout.page(local, self.tilt)

    def _follow(self, places: Array) -> Array:
        """Where places on the bodies, in m, have gone with the nearest nodes, local px."""
        nodes = self._geometry.nodes
        nearest = np.argmin(((nodes[None] - places[:, None]) ** 2).sum(axis=-1), axis=1)
        moved = self.frame.deformed.nodes[nearest, :, self.column]
        return self.layout.local(places) + self.layout.shift(moved, self.factor)

    def _to_place(self, present: float, pointer: Array) -> float:
        return float(pointer[0]) / self.layout.scale[0] + 0.5 * self.layout.length

    def _to_place(self, present: float, pointer: Array) -> float:
        return float(pointer[0]) / self.layout.scale[0] + 0.5 * self.layout.length

    def _bodies(self) -> Columns:
        """Substructures, and below them, as far as there is room, what goes on there: their image.

        That is turned by half a turn.
        """
        parts = drawn(self.outlines.parts, self.nodes)
        shown = [(parts, 0.5 if self.shows_status else 0.0, 0.55)]
        if any(hold.kind == "image" for hold in self._described.holds):
            image = np.stack([-parts[:, 0], np.maximum(-parts[:, 1], -IMAGE)], axis=1)
            shown.insert(0, (image, 0.22, 0.0))
        lines, fills, edges = zip(*shown, strict=True)
        pages = _joined([[self._page(line)] for line in lines])
        return pages | {"fill_alpha": list(fills), "line_alpha": list(edges)}

    def _strokes(self) -> Columns:
        """Lines of bodies, of what holds them, of what rubs, and of what acts; the last on top."""
        rims = self._page(drawn(self.outlines.rims, self.nodes))
        strokes = [([rims], EDGE, 1.4), (self._holds(), EDGE, 1.3)]
        if self.shows_status:
            strokes += self._bands()
        broken = self._page(self.nodes[self.outlines.broken])
        strokes += [(list(broken), ERROR, 3.0), *self._arrows()]
        lines, colors, widths = zip(*strokes, strict=True)
        return _joined(lines) | {"line_color": list(colors), "line_width": list(widths)}

    def _holds(self) -> list[Array]:
        foot = self._follow(np.array([[self.layout.length, 0.0]]))[0]
        strokes = strokes_of(self._described, self.layout, self.factor, self._now, foot)
        if self._described.tilt is not None:
            corner = np.array([-0.5 * self.layout.size[0] - 21.0, -5.0])
            level = turned(np.array([0.9 * self.layout.size[0], 0.0]), -self.tilt)
            strokes.append(np.array([corner, corner + level]))
        return [self._page(stroke) for stroke in strokes]

    def _bands(self) -> Strokes:
        """What rubs, by its status, on a rim where there is contact."""
        status = self.frame.deformed.status[:, self.column]
        lines, kinds = bands(self.points, self._geometry.chains, status)
        width = min(BAND, 0.35 * self.layout.size[1] / self._described.bodies)
        if len(np.unique(self._geometry.chains)) > self._described.bodies:
            width = min(width, 5.0)
        of_kind: dict[int, list[Array]] = defaultdict(list)
        for line, kind in zip(lines, kinds, strict=True):
            of_kind[kind].append(line)
        rims = [line for kind, some in of_kind.items() if kind != OPEN for line in some]
        return [(rims, EDGE, width + 2.0)] + [
            (some, STATUS[kind], 0.5 * width if kind == OPEN else width)
            for kind, some in of_kind.items()
        ]

    def _arrows(self) -> Strokes:
        strokes = []
        for act, (_, arrows) in self.acts.items():
            lines, beam = [_shortened(arrow.line) for arrow in arrows], beam_of(arrows)
            lines += [] if beam is None else [beam]
            width = 1.6 if len(arrows) > 3 else 3.2
            strokes.append(([self._page(line) for line in lines], _color(act), width))
        return strokes

    def _heads(self) -> Columns:
        heads = [[self._page(arrow.head) for arrow in arrows] for _, arrows in self.acts.values()]
        return _joined(heads) | {"color": [_color(act) for act in self.acts]}

    def _words(self) -> list[tuple[Word, Array]]:
        """What acts, and the slope, with their places on the page."""
        words = words_of(self._described, self.layout, self.acts, self._now)
        shown = [(word, self._page(word.place)) for word in words]
        if self._described.tilt is not None:
            corner = np.array([0.5 * self.layout.size[0] + 30.0, 4.0])
            angle = number(float(np.degrees(self.tilt)))
            shown.append((Word(f"slope {angle}°", corner, "left"), corner + self.layout.origin))
        return shown

    def _keys(self) -> tuple[list[Any], list[Word]]:
        """What colours mean, squares and words; and how much displacements are magnified."""
        run, layout = self.frame.run, self.layout
        kinds = {0: "stick", 1: "slip →", -1: "slip ←"} if self.shows_status else {}
        if kinds and any(interface.bound is None for interface in run.interfaces.values()):
            kinds[OPEN] = "open"
        note = f"displacement × {number(self.factor)}"
        if self._described.height is None:
            note += ", thickness not to scale"
        if layout.keys_beside:
            places = [(14.0, 30.0 + 18.0 * row) for row in reversed(range(len(kinds)))]
            last = Word(note, np.array([8.0, 11.0]), "left")
        else:
            sizes = [26.0 + LETTER * len(text) for text in kinds.values()]
            places = [(14.0 + sum(sizes[:n]), 0.5 * FOOT) for n in range(len(kinds))]
            last = Word(note, np.array([layout.width - 12.0, 0.5 * FOOT]), "right")
            if layout.width < NARROW:
                last = Word(note, np.array([8.0, 1.5 * FOOT]), "left")
        marks, words = [], []
        for (kind, text), place in zip(kinds.items(), places, strict=True):
            marks.append((np.array(place), "square", STATUS[kind], STATUS[kind], 1.0))
            words.append(Word(text, np.array([place[0] + 11.0, place[1]]), "left"))
        return marks, [*words, last]


def _color(act: Act) -> str:
    return DISPLACEMENT if act.unit in ("m", "1/m") else FORCE


def _scaled_by(arrow: Arrow) -> Callable[[float, Array], float]:
    return lambda present, at: present * arrow.dragged(at) / arrow.value


def _shortened(line: Array) -> Array:
    """A line that ends inside its head."""
    along = line[-1] - line[-2]
    size = float(np.hypot(*along)) or 1.0
    return np.concatenate([line[:-1], [line[-1] - min(5.0, 0.9 * size) / size * along]])


def _joined(lines: Sequence[Sequence[Array]]) -> Columns:
    """Lines, several as one; binary arrays, which go fast to the browser."""
    both = [joined([line.T for line in some]).astype(np.float32) for some in lines]
    return {"xs": [x for x, _ in both], "ys": [y for _, y in both]}


def _texts(keys: list[Word], shown: list[tuple[Word, Array]], layout: Layout) -> Columns:
    """Keys, and texts that are whole: moved inwards where they would be cut."""
    x, y = ([float(key.place[axis]) for key in keys] for axis in (0, 1))
    for word, place in shown:
        width = LETTER * len(word.text) + 4.0
        left = {"left": 0.0, "center": 0.5, "right": 1.0}[word.align] * width
        x.append(float(np.clip(place[0], left, max(layout.width - width + left, left))))
        y.append(float(np.clip(place[1], 8.0, layout.height - 8.0)))
    words = [word for word, _ in shown]
    colors = [FORCE if word.act is None else _color(word.act) for word in words]
    return {
        "x": x,
        "y": y,
        "text": [word.text for word in keys + words],
        "text_align": [word.align for word in keys + words],
        "text_color": ["#78858C"] * len(keys) + colors,
        "text_font_size": ["12px"] * len(keys) + ["14px"] * len(words),
        "text_font_style": ["normal"] * len(keys) + ["bold"] * len(words),
    }
