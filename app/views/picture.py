"""A picture of the scene without labels, as columns of its figure's sources, px."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from app.frame import Bytes, Frame, Geometry
from app.views.acts import Arrows, Rest, color_of
from app.views.colors import EDGE, ERROR, HALO, STATUS
from app.views.layout import BAND, GROUND, IMAGE, Layout, turned
from app.views.parts import gapped
from app.views.supports import footing_strokes, ground_edge, strokes_of
from solver.arrays import Array
from solver.laws import OPEN

MECHANISM = 0.12
"""Largest motion of a mechanism as drawn, over the height of all bodies."""
BEYOND = 21.0
"""Length of a horizontal beyond both ends of the bodies, px."""
Columns = dict[str, Any]
"""Columns of one source by their names."""
Strokes = list[tuple[Array, str, float]]
"""Lines with NaN between them, shape (n, 2), px, a colour, and a width, px."""


class Picture:
    """A frame at the instant of a column, with displacements magnified by a factor.

    `peaks` has the value of an arrow of full length for each load, by where it acts. Of
    several interfaces the `selected` one has a halo. `rests` are loads that were
    dragged to zero. Words are no part of it: `labels` places them.
    """

    def __init__(
        self,
        frame: Frame,
        column: int,
        layout: Layout,
        factor: float,
        peaks: Mapping[str, float],
        selected: str,
        rests: Sequence[Rest],
    ) -> None:
        self.frame = frame
        self.column = column
        self.layout = layout
        self.factor = factor
        self._peaks = peaks
        self.selected = selected
        self._rests = rests
        self._geometry = frame.run.geometry
        self.description = layout.description
        # Values of a description are not thinned.
        instant = frame.run.instants[column]
        self.now = int(np.argmin(np.abs(self.description.instants - instant)))
        self.tilt = layout.angle
        if self.description.tilt is not None:
            self.tilt = float(self.description.tilt[self.now])

    @cached_property
    def nodes(self) -> Array:
        """Deformed nodes, px from the middle of the foot, shape (n_nodes, 2)."""
        return self._moved(
            self._geometry.nodes, self.frame.deformed.nodes[:, :, self.column]
        )

    @cached_property
    def points(self) -> Array:
        """Contact points, px from the middle of the foot, shape (n_points, 2)."""
        positions = self._geometry.points
        local = self._moved(positions, self.frame.deformed.points[:, :, self.column])
        is_alone = self.description.bodies == 1 and self.description.height is not None
        if is_alone and self.description.footings is None:
            # The band lies below a single body. Rods leave room for it.
            at_foot = positions[:, 1] <= 1e-6 * self.description.length
            local[at_foot, 1] -= 0.5 * BAND
        return local

    @cached_property
    def arrows(self) -> list[Arrows]:
        """The arrows of all loads."""
        layout = self.layout
        behind = self.frame.run.settings.load_settings()
        arrows = []
        for act in self.description.acts:
            setting = behind.get(act.where)
            peak = self._peaks[act.where]
            points = self._follow(act.points_at(self.now) * layout.size)
            arrows.append(Arrows(act, setting, points, layout, peak, self.now))
        return arrows

    @property
    def draggable(self) -> list[Arrows | Rest]:
        """The arrows whose load is a setting, and handles of zero loads."""
        draggable: list[Arrows | Rest] = list(self._rests)
        for arrows in self.arrows:
            if arrows.setting and len(arrows.handles):
                draggable.append(arrows)
        return draggable

    def columns(self) -> dict[str, Columns]:
        """Columns of all sources, by their names."""
        bodies = _drawn(self._geometry.outlines, self.nodes)
        return {
            "ground": self.many(self.ground),
            "image": self._line(self._image(bodies)),
            "bodies": self._line(bodies),
            "strokes": self._columns(self._strokes()),
            "heads": self._columns(self._heads()),
            "marks": self._marks(),
        }

    @property
    def is_of_any_shape(self) -> bool:
        """Check whether bodies have any shape, not only straight sides."""
        return self.description.footings is not None

    @property
    def _top(self) -> float:
        """Height of all bodies, px."""
        return float(self.layout.size[1] * self.layout.scale[1])

    @property
    def is_around(self) -> bool:
        """Check whether the ground of a case is all around the bodies."""
        surroundings = self.layout.canvas.surroundings
        return surroundings is not None and surroundings.place == "around"

    @cached_property
    def ground(self) -> Array:
        """Patches of the ground of a case, below the bodies or on both sides.

        Shape (n, k, 2), px from the middle of the foot.
        """
        if not self.layout.canvas.has_ground:
            return np.zeros((0, 4, 2))
        edge = ground_edge(self.layout, self.factor)
        low = edge[:, 1].min() - GROUND
        foot = np.array([[edge[-1, 0], low], [edge[0, 0], low]])
        if self.is_around and self.is_of_any_shape:
            # Bodies of any shape have no upper side like the lower: it is behind all.
            edge = edge + np.array([0.0, self._top + GROUND])
        patch = np.concatenate([edge, foot])
        patches = [patch]
        if self.is_around and not self.is_of_any_shape:
            patches.append([0.0, self._top] - [-1.0, 1.0] * patch)
        return np.stack(patches)

    def _image(self, bodies: Array) -> Array:
        """The bodies turned by 180 degrees, if the support is their image.

        Both are outlines with NaN behind each, shape (n, 2), px.
        """
        if not any(hold.kind == "image" for hold in self.description.holds):
            return np.zeros((0, 2))
        # The image goes down as far as the figure has room for it.
        y = np.maximum(-bodies[:, 1], -IMAGE)
        return np.stack([-bodies[:, 0], y], axis=1)

    def _strokes(self) -> Strokes:
        """All lines, the last on top; bare bodies have no bands of interfaces."""
        rims = _drawn(self._geometry.rims, self.nodes)
        strokes: Strokes = [(rims, EDGE, 1.4), (self._holds(), EDGE, 1.3)]
        if not self.layout.canvas.is_bare:
            strokes += self._bands()
        strokes.append((gapped(self.nodes[self._at_break]), ERROR, 3.0))
        for arrows in self.arrows:
            width = 1.6 if len(arrows.lines) > 3 else 3.2
            strokes.append((arrows.strokes, color_of(arrows.act), width))
        return strokes

    def _heads(self) -> Strokes:
        heads: Strokes = []
        for arrows in self.arrows:
            heads.append((gapped(arrows.heads), color_of(arrows.act), 1.0))
        return heads

    def _marks(self) -> Columns:
        """The handles of arrows that can be dragged."""
        handles = [arrows.handle for arrows in self.draggable]
        columns = self._line(np.reshape(handles, (-1, 2)))
        columns["line_color"] = [color_of(arrows.act) for arrows in self.draggable]
        return columns

    def ghost(self, frame: Frame, column: int) -> Columns:
        """Outline of another run's bodies at the same scale, on the page."""
        geometry: Geometry = frame.run.geometry
        nodes = self._moved(geometry.nodes, frame.deformed.nodes[:, :, column])
        return self._line(_drawn(geometry.rims, nodes))

    def mechanism(self, moved: Array) -> Columns:
        """Outline of collapsing bodies, by a motion of nodes, (n, 2), m.

        It begins where the bodies are drawn, so that what is held stays there.
        """
        size = float(np.abs(moved).max())
        shown = MECHANISM * self.layout.size[1] / size * moved
        nodes = self.nodes + shown * self.layout.scale
        return self._line(_drawn(self._geometry.outlines, nodes))

    def page(self, local: Array) -> Array:
        """Px of the figure, of local px from the middle of the foot, (..., 2)."""
        return turned(local, self.tilt) + self.layout.origin

    def to_local(self, x: float, y: float) -> Array:
        """Local px, (2,), from the middle of the foot, of a point of the figure."""
        return turned(np.array([x, y]) - self.layout.origin, -self.tilt)

    def many(self, lines: Array) -> Columns:
        """Columns of lines or patches, (n, k, 2), px from the middle of the foot."""
        x, y = np.moveaxis(np.round(self.page(lines), 1), -1, 0)
        return {"xs": x.tolist(), "ys": y.tolist()}

    def _line(self, local: Array) -> Columns:
        """Columns of a line or of points, (n, 2), px from the middle of the foot."""
        x, y = self.page(local).T.astype(np.float32)
        return {"x": x, "y": y}

    def _moved(self, positions: Array, moved: Array) -> Array:
        """Moved positions in px from the middle of the foot, both (n, 2), m."""
        magnified = moved * (self.factor * self.layout.scale)
        return self.layout.local(positions) + magnified

    def _follow(self, positions: Array) -> Array:
        """Positions on the bodies, (n, 2), m, moved with their nearest nodes, px."""
        away = ((self._geometry.nodes - positions[:, None]) ** 2).sum(axis=-1)
        nearest = away.argmin(axis=1)
        return self._moved(
            positions, self.frame.deformed.nodes[nearest, :, self.column]
        )

    @cached_property
    def _at_break(self) -> Array:
        """Indices of the nodes on both sides of a break, (2, 2); (0, 2) without one."""
        if self.description.broken is None:
            return np.zeros((0, 2), dtype=np.intp)
        body, position = self.description.broken
        x, y = self._geometry.nodes.T
        is_there = np.abs(x - position) < 1e-4 * self.description.length
        row = np.floor(y * self.description.bodies / self.layout.size[1])
        return np.flatnonzero(is_there & (row == body)).reshape(-1, 2)

    def _columns(self, strokes: Strokes) -> Columns:
        """Columns of strokes on the page, as binary arrays, which are sent fast."""
        columns: Columns = {"xs": [], "ys": [], "line_color": [], "line_width": []}
        for line, color, width in strokes:
            x, y = self.page(line).T.astype(np.float32)
            columns["xs"].append(x)
            columns["ys"].append(y)
            columns["line_color"].append(color)
            columns["line_width"].append(width)
        return columns

    def _holds(self) -> Array:
        """Strokes of the supports, and a horizontal where bodies tilt, (n, 2), px."""
        layout = self.layout
        length = self.description.length
        feet = self._follow(np.array([[0.0, 0.0], [length, 0.0]]))
        strokes = strokes_of(layout, self.factor, self.now, feet)
        for footing in self.description.footings or ():
            if footing.kind == "support" and self.layout.canvas.has_ground:
                # The ground of the case is what supports the bodies.
                continue
            points = footing.points * layout.size
            places = layout.local(points)
            if footing.kind != "support":
                places = self._follow(points)
            strokes.append(footing_strokes(footing, places, layout, self.factor))
        if self.description.tilt is not None:
            strokes.append(self.horizontal)
        return np.concatenate([np.zeros((0, 2)), *strokes])

    @property
    def horizontal(self) -> Array:
        """Line from the lower end of the ground, below it, to under its other end.

        Its ends have shape (2, 2), px from the middle of the foot.
        """
        side = math.copysign(1.0, self.tilt)
        across = side * self.description.length * self.layout.scale[0]
        corner = np.array([-0.5 * across - BEYOND * side, -5.0])
        level = np.array([across + 2.0 * BEYOND * side, 0.0])
        return np.array([corner, corner + turned(level, -self.tilt)])

    def _bands(self) -> Strokes:
        """Bands of the interfaces in the colours of their status."""
        status = self.frame.deformed.status[:, self.column]
        chains = self._geometry.chains
        lines = bands(self.points, chains, status)
        if self.is_around and not self.is_of_any_shape:
            # Ground all around straight bodies touches their upper side, too.
            for kind, line in lines.items():
                other = [0.0, self._top] - [-1.0, 1.0] * line
                lines[kind] = np.concatenate([line, other])
        height = self.layout.body_height * self.layout.scale[1]
        width = min(BAND, 0.35 * height)
        # Broad bands of many interfaces, as in a wall, would cover the bodies.
        most = self.description.bodies
        if self.is_of_any_shape:
            most = 1
        if chains.max() >= most:
            width = min(width, 5.0)
        # A dark rim below what slips: what sticks is quiet.
        slipping = [line for kind, line in lines.items() if kind in (-1, 1)]
        rims = np.concatenate([np.zeros((0, 2)), *slipping])
        strokes: Strokes = [
            (self.halo, HALO, width + 9.0),
            (rims, EDGE, width + 2.0),
        ]
        for kind, line in lines.items():
            if kind == OPEN:
                strokes.append((line, STATUS[kind], 0.5 * width))
            else:
                strokes.append((line, STATUS[kind], width))
        return strokes

    @property
    def halo(self) -> Array:
        """Line along the selected interface, (n, 2), px, if there are several."""
        run = self.frame.run
        if self.selected not in run.surfaces or len(run.surfaces) == 1:
            return np.zeros((0, 2))
        chain = list(run.interfaces).index(self.selected)
        return self.points[self._geometry.chains == chain]


def bands(points: Array, chains: Array, status: Bytes) -> dict[int, Array]:
    """Lines along contact points by status, each to the middle before the next status.

    Points have shape (n, 2), numbers of their chains and status (n,). Points are NaN
    where a chain is broken, and lines behind each stretch.
    """
    is_joined = chains[1:] == chains[:-1]
    cuts = np.flatnonzero(~is_joined | (status[1:] != status[:-1]))
    middles = 0.5 * (points[cuts + 1] + points[cuts])
    middles = np.where(is_joined[cuts, None], middles, np.nan)
    path = np.insert(points, cuts + 1, middles, axis=0)
    path = np.append(path, [[np.nan, np.nan]], axis=0)
    # At a cut the path belongs to both status.
    before = np.insert(status, cuts + 1, status[cuts])
    after = np.insert(status, cuts + 1, status[cuts + 1])
    lines = {}
    for kind in np.unique(status):
        is_on = np.append((before == kind) | (after == kind), False)
        kept = is_on | np.roll(is_on, 1)
        lines[int(kind)] = np.where(is_on[:, None], path, np.nan)[kept]
    return lines


def _drawn(lines: Array, nodes: Array) -> Array:
    """Points of lines, (n, 2), with NaN behind each, of numbers of nodes, (n,)."""
    return np.append(nodes, [[np.nan, np.nan]], axis=0)[lines]
