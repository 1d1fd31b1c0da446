"""Positions of pieces, of their arrows and supports, in the figure that shows them."""

from __future__ import annotations

import numpy as np

from app.views.supports import hatched
from app.worker.pieces import Pieces, StageFields
from solver.arrays import Array, Indices

ROOM = 22.0
"""Room round the pieces, px."""
SMALL = 30.0
"""Least room for the pieces, px."""
THICK = 0.3
"""Largest thickness of a rod over the height for all."""
APART = 12.0
"""Largest distance between pieces that fit, px."""
MOTION = 18.0
JUMP = 9.0
"""Largest displacement, and jump at a cut, px."""
LONGEST = 46.0
"""Largest length of the longest arrow, px."""
PAIRED = 34.0
"""Distance from which both quarter points of a side have an arrow, px."""
ASKEW = 3.5
"""Distance of arrows from their points, along the joint, px: those on both sides pass
each other."""
HAIR = 0.6
"""Largest length of a micro force over that of the longest arrow."""


class PlacedPieces:
    """Position of the pieces in a figure, px.

    The pieces fill the `room` of the figure, (2,), px. Each shrinks about its middle,
    so that pieces that fit are a little apart.
    `outlines` are the moved corners, (n_corners, 2), and `quarters` the moved quarter
    points of sides, (n_sides, 2, 2); the longest arrow is `arrow` long. Micro forces of
    rods, which act along them, are drawn across, as otherwise they would hide in the
    outlines.
    """

    def __init__(self, extra: Pieces, room: Array, is_plane: bool) -> None:
        self._extra = extra
        self.is_plane = is_plane
        low = np.nanmin(extra.corners, axis=0)
        high = np.nanmax(extra.corners, axis=0)
        lows, highs = _boxes(extra.corners, extra.parts)
        scale = np.maximum(room - 2.0 * ROOM, SMALL) / (high - low)
        if is_plane:
            scale[:] = scale.min()
        else:
            thickness = float(np.median((highs - lows)[:, 1]))
            tallest = scale[1] * (high - low)[1]
            scale[1] = min(scale[1], THICK * tallest / thickness)
        self._pixels = scale
        self._origin = 0.5 * room - 0.5 * (low + high) * scale
        sizes = (highs - lows) * scale
        self._middles = 0.5 * (lows + highs) * scale + self._origin
        self._share = 1.0 - np.minimum(APART, 0.25 * sizes) / sizes
        typical = np.median(sizes, axis=0)
        self.arrow = float(min(0.7 * np.sqrt(typical.prod()), LONGEST))

    def factor(self, scales: dict[str, float]) -> float:
        """Factor on displacements."""
        return float(MOTION / (scales["moved"] * self._pixels[0]))

    def jump_factor(self, scales: dict[str, float]) -> float:
        """Factor on the jumps at cuts, which are smaller than displacements."""
        of_jumps = float(JUMP / (scales["gap"] * self._pixels[0]))
        return max(of_jumps, self.factor(scales))

    def move(self, stage: StageFields, column: int, scales: dict[str, float]) -> None:
        """Move the pieces as at an instant of a stage."""
        extra = self._extra
        joined = stage.joined[..., column]
        apart = stage.moved[..., column] - joined
        moved = self.factor(scales) * joined + self.jump_factor(scales) * apart
        self._moved = moved * self._pixels
        placed = self._placed(extra.corners, extra.parts)
        self.outlines = placed + self._moved
        owners = np.repeat(extra.owners, 2)
        quarters = self.on_pieces(extra.quarters.reshape(-1, 2), owners)
        self.quarters = quarters.reshape(-1, 2, 2)

    def _placed(self, positions: Array, parts: Indices) -> Array:
        """Positions on undeformed pieces, (n, 2), px, of positions, m."""
        whole = positions * self._pixels + self._origin
        middles = self._middles[parts]
        return np.asarray(middles + self._share[parts] * (whole - middles))

    def on_pieces(self, positions: Array, parts: Indices) -> Array:
        """Positions that move with the nearest corner of their piece, (n, 2), px."""
        corners = self._extra.corners
        nearest = np.zeros(len(parts), dtype=np.intp)
        for part in np.unique(parts):
            own = np.flatnonzero(self._extra.parts == part)[:-1]
            chosen = np.flatnonzero(parts == part)
            away = positions[chosen, None] - corners[own]
            nearest[chosen] = own[(away**2).sum(axis=-1).argmin(axis=1)]
        return self._placed(positions, parts) + self._moved[nearest]

    def hairs(self, spans: Array) -> Array:
        """Lines of micro forces, (n_points, 2, 2), px, from their spans, (n_points, 2).

        The longest are cut, as the traction is large at corners.
        """
        extra = self._extra
        longest = np.hypot(*spans.T) / (HAIR * self.arrow)
        spans = spans / np.maximum(longest, 1.0)[:, None]
        if not self.is_plane:
            spans = spans[:, :1] * self._outward[extra.sides]
        roots = self.on_pieces(extra.points, extra.owners[extra.sides])
        return np.stack([roots, roots + spans], axis=1)

    def arrows(self, forces: Array) -> tuple[Array, Array, Indices]:
        """Tails, (n, 2), px, and forces, (n, 2), N, of arrows, and their sides, (n,).

        Long sides have an arrow at both quarter points, others one for both.
        """
        lengths = np.hypot(*(self.quarters[:, 1] - self.quarters[:, 0]).T)
        is_short = lengths < PAIRED
        tails = self.quarters + self._aside()[:, None]
        tails[is_short] = tails[is_short].mean(axis=1, keepdims=True)
        shown = forces.copy()
        shown[is_short, 0] = forces[is_short].sum(axis=1)
        shown[is_short, 1] = 0.0
        sides = np.repeat(np.arange(len(lengths)), 2)
        return tails.reshape(-1, 2), shown.reshape(-1, 2), sides

    def supports(self) -> Array:
        """Hatched lines along the joints of pieces with a support, (n, 2), px."""
        extra = self._extra
        is_held = np.bincount(extra.joints)[extra.joints] == 1
        is_held &= extra.is_straight
        quarters = extra.quarters[is_held] * self._pixels + self._origin
        middles = quarters.mean(axis=1, keepdims=True)
        edges = middles + 2.0 * (quarters - middles)
        strokes = [np.zeros((0, 2))]
        for edge, away in zip(edges, self._outward[is_held], strict=True):
            strokes.append(hatched(edge + 0.5 * APART * away, away))
        return np.concatenate(strokes)

    @property
    def _along(self) -> Array:
        """Unit vectors along sides, (n_sides, 2); of a side without length upright."""
        quarters = self._extra.quarters
        along = (quarters[:, 1] - quarters[:, 0]) * self._pixels
        lengths = np.hypot(*along.T)[:, None]
        along = np.where(lengths > 0.0, along, [0.0, 1.0])
        return np.asarray(along / np.where(lengths > 0.0, lengths, 1.0))

    @property
    def _outward(self) -> Array:
        """Unit vectors from pieces across their sides, (n_sides, 2)."""
        extra = self._extra
        across = self._along[:, ::-1] * [-1.0, 1.0]
        middles = extra.quarters.mean(axis=1) * self._pixels + self._origin
        beyond = ((middles - self._middles[extra.owners]) * across).sum(axis=1)
        return np.asarray(np.copysign(1.0, beyond)[:, None] * across)

    def _aside(self) -> Array:
        """Shift of arrows along joints, (n_sides, 2), px."""
        sign = np.where(self._extra.is_above == 1, ASKEW, -ASKEW)[:, None]
        return sign * self._along


def _boxes(corners: Array, parts: Indices) -> tuple[Array, Array]:
    """Lower and upper corners of the boxes round pieces, (n_parts, 2) each."""
    shape = int(parts.max()) + 1, 2
    lows = np.full(shape, np.inf)
    highs = np.full(shape, -np.inf)
    np.fmin.at(lows, parts, corners)
    np.fmax.at(highs, parts, corners)
    return lows, highs
