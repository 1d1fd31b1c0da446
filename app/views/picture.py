"""All that one picture of the scene shows, as columns of its sources, px."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np

from app.frame import OPEN, Bytes, Frame, Geometry
from app.units import number
from app.views.acts import Arrows, anchor_of, color_of, gapped, strokes_of, text_of
from app.views.colors import EDGE, ERROR, FORCE, STATUS
from app.views.layout import BAND, IMAGE, Layout, is_opposite, turned
from solver.arrays import Array

MECHANISM = 0.12
"""Share of the height of all bodies that the largest motion of a mechanism is drawn
as."""
Columns = dict[str, Any]
Strokes = list[tuple[Array, str, float]]
"""Lines, NaN between them, with a colour and a width, px."""


class Picture:
    """A frame at the instant of a column, with displacements magnified by a factor.

    Arrows of the values in `peaks` have full length, by where they act.
    """

    def __init__(
        self,
        frame: Frame,
        column: int,
        layout: Layout,
        factor: float,
        peaks: Mapping[str, float],
    ) -> None:
        self.frame = frame
        self.column = column
        self.layout = layout
        self._factor = factor
        self._peaks = peaks
        self._geometry = frame.run.geometry
        self._described = layout.description
        # Values of a description are not thinned.
        instant = frame.run.instants[column]
        self._now = int(np.argmin(np.abs(self._described.instants - instant)))
        tilt = self._described.tilt
        if tilt is None:
            self.tilt = 0.0
        else:
            self.tilt = float(tilt[self._now])

    @cached_property
    def nodes(self) -> Array:
        """Deformed nodes, px from the middle of the foot."""
        return self._moved(
            self._geometry.nodes, self.frame.deformed.nodes[:, :, self.column]
        )

    @cached_property
    def points(self) -> Array:
        """Contact points, px from the middle of the foot."""
        places = self._geometry.points
        local = self._moved(places, self.frame.deformed.points[:, :, self.column])
        if self._described.height is not None and self._described.bodies == 1:
            # Of rods, a band is thinner than the room that is left for it.
            local[places[:, 1] <= 1e-6 * self._described.length, 1] -= 0.5 * BAND
        return local

    @cached_property
    def arrows(self) -> list[Arrows]:
        """Those of all that acts."""
        layout = self.layout
        behind = self.frame.run.settings.behind()
        arrows = []
        for act in self._described.acts:
            setting = behind.get(act.where)
            peak = self._peaks[act.where]
            places = self._follow(act.places * layout.size)
            arrows.append(Arrows(act, setting, places, layout, peak, self._now))
        return arrows

    @property
    def draggable(self) -> list[Arrows]:
        """Those with a setting behind them."""
        return [
            arrows for arrows in self.arrows if arrows.setting and len(arrows.handles)
        ]

    def columns(self) -> dict[str, Columns]:
        """Columns of all sources, by their names; of bare bodies without status of what rubs."""
        parts = _drawn(self._geometry.outlines, self.nodes)
        image = np.zeros((0, 2))
        if any(hold.kind == "image" for hold in self._described.holds):
            # The bodies go on below, turned by half a turn, as far as there is room.
            image = np.stack([-parts[:, 0], np.maximum(-parts[:, 1], -IMAGE)], axis=1)
        handles = np.reshape([arrows.handle for arrows in self.draggable], (-1, 2))
        marks = {"line_color": [color_of(arrows.act) for arrows in self.draggable]}
        rims = _drawn(self._geometry.rims, self.nodes)
        if self.layout.is_bare:
            bands = []
        else:
            bands = self._bands()
        # The last are on top.
        strokes: Strokes = [(rims, EDGE, 1.4), (self._holds(), EDGE, 1.3), *bands]
        strokes.append((gapped(self.nodes[self._at_break]), ERROR, 3.0))
        heads: Strokes = []
        for arrows in self.arrows:
            color = color_of(arrows.act)
            width = 1.6 if len(arrows.lines) > 3 else 3.2
            strokes.append((arrows.strokes, color, width))
            heads.append((gapped(arrows.heads), color, 1.0))
        return {
            "image": self._line(image),
            "bodies": self._line(parts),
            "strokes": self._columns(strokes),
            "heads": self._columns(heads),
            "marks": self._line(handles) | marks,
            "words": self._words(),
        }

    def ghost(self, frame: Frame, column: int) -> Columns:
        """Outline of another run's bodies at the same scale, on the page."""
        geometry: Geometry = frame.run.geometry
        nodes = self._moved(geometry.nodes, frame.deformed.nodes[:, :, column])
        return self._line(_drawn(geometry.rims, nodes))

    def mechanism(self, moved: Array) -> Columns:
        """Outline of the bodies as they begin to collapse, on the page."""
        size = float(np.abs(moved).max(initial=0.0)) or 1.0
        shown = MECHANISM * self.layout.size[1] / size * moved
        nodes = self.layout.local(self._geometry.nodes + shown)
        return self._line(_drawn(self._geometry.outlines, nodes))

    def page(self, local: Array) -> Array:
        """Pixels of the figure, of places from the middle of the foot, along the bodies."""
        return turned(local, self.tilt) + self.layout.origin

    def to_local(self, x: float, y: float) -> Array:
        """A place on the page from the middle of the foot, along the bodies, px."""
        return turned(np.array([x, y]) - self.layout.origin, -self.tilt)

    def many(self, lines: Array) -> Columns:
        """Lines or patches, (n, k, 2), on the page, each by itself."""
        x, y = np.moveaxis(np.round(self.page(lines), 1), -1, 0)
        return {"xs": x.tolist(), "ys": y.tolist()}

    def _line(self, local: Array) -> Columns:
        x, y = self.page(local).T.astype(np.float32)
        return {"x": x, "y": y}

    def _moved(self, places: Array, moved: Array) -> Array:
        return self.layout.local(places) + moved * (self._factor * self.layout.scale)

    def _follow(self, places: Array) -> Array:
        """Where places on the bodies, in m, have gone with the nearest nodes, local px."""
        away = ((self._geometry.nodes - places[:, None]) ** 2).sum(axis=-1)
        return self._moved(
            places, self.frame.deformed.nodes[away.argmin(axis=1), :, self.column]
        )

    @cached_property
    def _at_break(self) -> Array:
        """Nodes of both sides of a break, (2, 2); none where no body is broken."""
        if self._described.broken is None:
            return np.zeros((0, 2), dtype=np.intp)
        body, place = self._described.broken
        x, y = self._geometry.nodes.T
        is_there = np.abs(x - place) < 1e-4 * self._described.length
        row = np.floor(y * self._described.bodies / self.layout.size[1])
        return np.flatnonzero(is_there & (row == body)).reshape(-1, 2)

    def _columns(self, strokes: Strokes) -> Columns:
        """On the page; binary arrays, which go fast to the browser."""
        pages = [self.page(line).T.astype(np.float32) for line, _, _ in strokes]
        return {
            "xs": [x for x, _ in pages],
            "ys": [y for _, y in pages],
            "line_color": [color for _, color, _ in strokes],
            "line_width": [width for _, _, width in strokes],
        }

    def _holds(self) -> Array:
        layout = self.layout
        length = self._described.length
        feet = self._follow(np.array([[0.0, 0.0], [length, 0.0]]))
        strokes = strokes_of(layout, self._factor, self._now, feet)
        if self._described.tilt is not None:
            corner = np.array([-0.5 * length * layout.scale[0] - 21.0, -5.0])
            level = turned(np.array([0.9 * length * layout.scale[0], 0.0]), -self.tilt)
            strokes.append(np.array([corner, corner + level]))
        return np.concatenate([np.zeros((0, 2)), *strokes])

    def _bands(self) -> Strokes:
        """What rubs, by its status, on a rim where there is contact."""
        status = self.frame.deformed.status[:, self.column]
        chains = self._geometry.chains
        lines = bands(self.points, chains, status)
        width = min(
            BAND,
            0.35 * self.layout.size[1] * self.layout.scale[1] / self._described.bodies,
        )
        if chains.max() >= self._described.bodies:
            width = min(width, 5.0)
        rims = [line for kind, line in lines.items() if kind != OPEN]
        return [(np.concatenate([np.zeros((0, 2)), *rims]), EDGE, width + 2.0)] + [
            (line, STATUS[kind], 0.5 * width if kind == OPEN else width)
            for kind, line in lines.items()
        ]

    def _words(self) -> Columns:
        """What acts, and the slope; moved inwards where it would be cut."""
        layout = self.layout
        texts = []
        places = []
        aligns = []
        colors = []
        above = [act for act in self._described.acts if act.where.startswith("top")]
        for arrows in self.arrows:
            act = arrows.act
            (place, align) = anchor_of(arrows, layout)
            # What presses from above and below alike is said once.
            if not act.where.startswith("bottom") or not any(
                is_opposite(act, a) for a in above
            ):
                texts.append(text_of(act, self._now))
                places.append(self.page(place))
                aligns.append(align)
                colors.append(color_of(act))
        if self._described.tilt is not None:
            corner = np.array(
                [0.5 * self._described.length * layout.scale[0] + 30.0, -14.0]
            )
            texts.append(f"slope {number(float(np.degrees(self.tilt)))}°")
            places.append(corner + layout.origin)
            aligns.append("left")
            colors.append(FORCE)
        x, y = np.reshape(places, (-1, 2)).T
        widths = np.array([layout.letter * len(text) + 4.0 for text in texts])
        left = widths * [
            {"left": 0.0, "center": 0.5, "right": 1.0}[align] for align in aligns
        ]
        return {
            "x": np.clip(x, left, np.maximum(layout.width - widths + left, left)),
            "y": np.clip(y, 8.0, layout.height - 8.0),
            "text": texts,
            "text_align": aligns,
            "text_color": colors,
        }


def bands(points: Array, chains: Array, status: Bytes) -> dict[int, Array]:
    """Lines along contact points by their status, each to the middle between it and the next.

    Points, shape (n, 2), are NaN where their chain is broken, and so are lines behind
    stretches.
    """
    is_joined = chains[1:] == chains[:-1]
    cuts = np.flatnonzero(~is_joined | (status[1:] != status[:-1]))
    middles = np.where(
        is_joined[cuts, None], 0.5 * (points[cuts + 1] + points[cuts]), np.nan
    )
    path = np.append(
        np.insert(points, cuts + 1, middles, axis=0), [[np.nan, np.nan]], axis=0
    )
    before, after = (
        np.insert(status, cuts + 1, status[side]) for side in (cuts, cuts + 1)
    )
    lines = {}
    for kind in np.unique(status):
        is_on = np.append((before == kind) | (after == kind), False)
        kept = is_on | np.roll(is_on, 1)
        lines[int(kind)] = np.where(is_on[:, None], path, np.nan)[kept]
    return lines


def _drawn(lines: Array, nodes: Array) -> Array:
    """Places of lines, (n, 2), NaN behind each."""
    return np.append(nodes, [[np.nan, np.nan]], axis=0)[lines]
