"""All that one picture shows, as columns of its sources, px."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from app.frame import OPEN, Frame
from app.units import number
from app.views.colors import DISPLACEMENT, EDGE, FORCE, STATUS
from app.views.scene.acts import Arrow, Word, arrows_of, beam_of, words_of
from app.views.scene.holds import gap_of, strokes_of
from app.views.scene.layout import BAND, FOOT, IMAGE, LETTER, NARROW, Layout, turned
from app.views.scene.outlines import Outlines, bands, drawn
from solver.arrays import Array
from solver.discrete.structure import Act, Description

Columns = dict[str, Any]
GAP = np.array([[np.nan, np.nan]])


@dataclass(frozen=True)
class Handle:
    """What can be dragged: its place, px from the middle of the foot, and what it sets.

    Attributes
    ----------
    setting
        Its name.
    color
        Of what it belongs to.
    value
        The setting, by the one at present and where the pointer is.
    """

    setting: str
    place: Array
    color: str
    value: Callable[[float, Array], float]


class Picture:
    """A frame at one instant.

    Parameters
    ----------
    frame
        What is shown.
    column
        Of the instant in it.
    layout, factor, outlines
        Where bodies lie, how much displacements are magnified, and the lines of the bodies.
    peaks
        Values of arrows of full length, by what acts.
    behind
        Settings behind what acts, by where it does.
    shows_status
        Whether there are keys to the colours of what rubs.
    """

    def __init__(
        self,
        frame: Frame,
        column: int,
        layout: Layout,
        factor: float,
        outlines: Outlines,
        peaks: Mapping[str, float],
        behind: Mapping[str, str],
        shows_status: bool = True,
    ) -> None:
        self.frame, self.column = frame, column
        self.layout, self.factor, self.outlines = layout, factor, outlines
        self._peaks, self._behind, self._shows_status = peaks, behind, shows_status
        self._geometry = frame.run.geometry
        self._described: Description = self._geometry.description
        # Values of a description are not thinned.
        instant = frame.run.instants[column]
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
                act, self._described, self.layout, self._peaks[act.where], self._now, places
            )
            found[act] = places, arrows
        return found

    @cached_property
    def handles(self) -> list[Handle]:
        """All that can be dragged."""
        handles = []
        for act, (_, arrows) in self.acts.items():
            name = self._behind.get(act.where)
            if name is not None and arrows:
                arrow = max(arrows, key=lambda one: abs(one.value))
                handles.append(Handle(name, arrow.handle, _color(act), _scaled_by(arrow)))
        gap = gap_of(self._described, self.layout, self.factor)
        if "gap" in self._behind and gap is not None and -gap[-1, 1] > 1.0:
            depth = -float(gap[-1, 1])
            # What is behind a gap is a radius: the larger, the shallower.
            handles.append(
                Handle("radius", gap[-1], EDGE, lambda r, at: r * depth / max(-float(at[1]), 2.0))
            )
        if "break" in self._behind and self._described.broken is not None:
            ends = self.nodes[self.outlines.broken[self.outlines.broken >= 0]]
            if len(ends):
                place = ends.mean(axis=0)
                handles.append(Handle(self._behind["break"], place, FORCE, self._to_place))
        return handles

    def columns(self) -> dict[str, Columns]:
        """Columns of all sources, by their names."""
        outlines = self.outlines
        page = {
            "parts": drawn(outlines.parts, self.nodes),
            "rims": drawn(outlines.rims, self.nodes),
            "broken": drawn(outlines.broken, self.nodes),
            "holds": _joined(self._strokes()),
            "image": self._image(),
        }
        found = {name: self._lines(lines) for name, lines in page.items()}
        arrows, heads = self._arrows()
        handles = self._page(np.array([handle.place for handle in self.handles]).reshape(-1, 2))
        return found | {
            "bands": self._bands(),
            "arrows": arrows,
            "heads": heads,
            "handles": _xy(handles) | {"color": [handle.color for handle in self.handles]},
            "words": self._words(),
            **self._keys(),
        }

    def ghost(self, frame: Frame, column: int, outlines: Outlines) -> Array:
        """Outline of another run's bodies at the same scale, on the page, px."""
        nodes = self.layout.local(frame.run.geometry.nodes)
        nodes = nodes + self.layout.shift(frame.deformed.nodes[:, :, column], self.factor)
        return self._page(drawn(outlines.rims, nodes))

    def to_local(self, x: float, y: float) -> Array:
        """A place on the page from the middle of the foot, along the bodies, px."""
        return turned(np.array([x, y]) - self.layout.origin, -self.tilt)

    def _page(self, local: Array) -> Array:
        return self.layout.page(local, self.tilt)

    def _lines(self, local: Array) -> Columns:
        return _xy(self._page(local))

    def _follow(self, places: Array) -> Array:
        """Where places on the bodies, in m, have gone with the nearest nodes, local px."""
        nodes = self._geometry.nodes
        nearest = np.argmin(((nodes[None] - places[:, None]) ** 2).sum(axis=-1), axis=1)
        moved = self.frame.deformed.nodes[nearest, :, self.column]
        return self.layout.local(places) + self.layout.shift(moved, self.factor)

    def _to_place(self, present: float, pointer: Array) -> float:
        return float(pointer[0]) / self.layout.scale[0] + 0.5 * self.layout.length

    def _strokes(self) -> list[Array]:
        foot = self._follow(np.array([[self.layout.length, 0.0]]))[0]
        strokes = strokes_of(self._described, self.layout, self.factor, self._now, foot)
        if self._described.tilt is not None:
            corner = np.array([-0.5 * self.layout.size[0] - 21.0, -5.0])
            level = turned(np.array([0.9 * self.layout.size[0], 0.0]), -self.tilt)
            strokes.append(np.array([corner, corner + level]))
        return strokes

    def _image(self) -> Array:
        """What goes on below, turned by half a turn, as far as there is room."""
        if not any(hold.kind == "image" for hold in self._described.holds):
            return np.zeros((0, 2))
        lines = -drawn(self.outlines.parts, self.nodes)
        return np.stack([lines[:, 0], np.maximum(lines[:, 1], -IMAGE)], axis=1)

    def _bands(self) -> Columns:
        status = self.frame.deformed.status[:, self.column]
        lines, kinds = bands(self.points, self._geometry.chains, status)
        width = min(BAND, 0.35 * self.layout.size[1] / self._described.bodies)
        if len(np.unique(self._geometry.chains)) > self._described.bodies:
            width = min(width, 5.0)
        return _many(lines) | {
            "color": [STATUS[kind] for kind in kinds],
            "width": [0.5 * width if kind == OPEN else width for kind in kinds],
            "edge": [0.0 if kind == OPEN else width + 2.0 for kind in kinds],
        }

    def _arrows(self) -> tuple[Columns, Columns]:
        lines, heads, colors, widths, head_colors = [], [], [], [], []
        for act, (_, arrows) in self.acts.items():
            beam = beam_of(arrows)
            for arrow in arrows:
                lines.append(self._page(_shortened(arrow.line)))
                heads.append(self._page(arrow.head))
                head_colors.append(_color(act))
            if beam is not None:
                lines.append(self._page(beam))
            colors += [_color(act)] * (len(lines) - len(colors))
            widths += [1.6 if len(arrows) > 3 else 3.2] * (len(lines) - len(widths))
        return _many(lines) | {"color": colors, "width": widths}, _many(heads) | {
            "color": head_colors
        }

    def _words(self) -> Columns:
        words = words_of(self._described, self.layout, self.acts, self._now)
        shown = [(word, self._page(word.place)) for word in words]
        if self._described.tilt is not None:
            corner = np.array([0.5 * self.layout.size[0] + 30.0, 4.0])
            angle = number(float(np.degrees(self.tilt)))
            shown.append((Word(f"slope {angle}°", corner, "left"), corner + self.layout.origin))
        return _texts(shown, self.layout)

    def _keys(self) -> dict[str, Columns]:
        """What colours mean, and how much displacements are magnified."""
        run, layout = self.frame.run, self.layout
        kinds = {0: "stick", 1: "slip →", -1: "slip ←"} if self._shows_status else {}
        if kinds and any(interface.bound is None for interface in run.interfaces.values()):
            kinds[OPEN] = "open"
        note = f"displacement × {number(self.factor)}"
        if self._described.height is None:
            note += ", thickness not to scale"
        count = len(kinds)
        if layout.keys_beside:
            x, y = np.full(count, 14.0), 30.0 + 18.0 * np.arange(count)[::-1]
            last = 8.0, 11.0, "left"
        else:
            sizes = [26.0 + LETTER * len(text) for text in kinds.values()]
            x, y = 14.0 + np.cumsum([0.0, *sizes])[:count], np.full(count, 0.5 * FOOT)
            last = layout.width - 12.0, 0.5 * FOOT, "right"
            if layout.width < NARROW:
                last = 8.0, 1.5 * FOOT, "left"
        return {
            "keys": {"x": x, "y": y, "color": [STATUS[kind] for kind in kinds]},
            "notes": {
                "x": np.append(x + 11.0, last[0]),
                "y": np.append(y, last[1]),
                "text": [*kinds.values(), note],
                "align": ["left"] * count + [last[2]],
            },
        }


def _color(act: Act) -> str:
    return DISPLACEMENT if act.unit in ("m", "1/m") else FORCE


def _scaled_by(arrow: Arrow) -> Callable[[float, Array], float]:
    return lambda present, at: present * arrow.dragged(at) / arrow.value


def _shortened(line: Array) -> Array:
    """A line that ends inside its head."""
    along = line[-1] - line[-2]
    size = float(np.hypot(*along)) or 1.0
    return np.concatenate([line[:-1], [line[-1] - min(5.0, 0.9 * size) / size * along]])


def _joined(lines: Sequence[Array]) -> Array:
    pieces = [piece for line in lines for piece in (line, GAP)]
    return np.concatenate(pieces[:-1]) if pieces else np.zeros((0, 2))


def _xy(lines: Array) -> Columns:
    x, y = lines.T.astype(np.float32)
    return {"x": x, "y": y}


def _many(lines: Sequence[Array]) -> Columns:
    rounded = [np.round(line, 1).T.tolist() for line in lines]
    return {"xs": [line[0] for line in rounded], "ys": [line[1] for line in rounded]}


def _texts(shown: Sequence[tuple[Word, Array]], layout: Layout) -> Columns:
    """Texts that are whole: moved inwards where they would be cut."""
    x, y = [], []
    for word, place in shown:
        width = LETTER * len(word.text) + 4.0
        left = {"left": 0.0, "center": 0.5, "right": 1.0}[word.align] * width
        x.append(float(np.clip(place[0], left, max(layout.width - width + left, left))))
        y.append(float(np.clip(place[1], 8.0, layout.height - 8.0)))
    return {
        "x": x,
        "y": y,
        "text": [word.text for word, _ in shown],
        "align": [word.align for word, _ in shown],
        "color": [FORCE if word.act is None else _color(word.act) for word, _ in shown],
    }
