"""The structure in pieces, with the forces on both sides of joints."""

from __future__ import annotations

import math
import textwrap
from typing import Any

import numpy as np
import panel as pn
from bokeh.core.properties import value
from bokeh.events import Tap

from app.frame import LINEAR, LOCAL, Frame, Selection
from app.views.acts import gapped, hatched
from app.views.axis import rounded_up
from app.views.colors import BODY, EDGE, GHOST, MACRO, MICRO, WRITTEN
from app.views.parts import bare
from app.views.type_size import TEXT
from app.views.view import ExtraView
from app.worker.pieces import Pieces, StageFields
from solver.arrays import Array, Indices
from solver.files.amounts import number, unit_for

WIDTH = 600.0
HEIGHT = 260.0
"""Size of the figure until the browser reports its own, px."""
ROOM = 22.0
"""Room round the pieces, px."""
FOOT = 1.4
LETTER = 0.5
LETTERS = 115
"""Height of a line and width of a letter over their type size, and number of letters
above the pieces, about."""
TOLD = 0.4
BESIDE = 0.34
"""Largest share of the height for words above the pieces, and of the width beside."""
RAGGED = 1.2
"""Room of words in a narrow column over that of their letters."""
SMALL = 30.0
"""Least room for the pieces, px."""
KEYS = 78
"""Number of letters below them, with the room of their marks."""
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
HEAD = 7.0
SMALLEST = 3.0
"""Length of the head of an arrow, and of an arrow of a force that just is not zero,
px."""
HAIR = 0.6
"""Largest length of a micro force over that of the longest arrow."""
NEWS = 1e-9
"""Force over the largest one from which on it has an arrow."""
BALANCED = 0.01
"""Sum of the macro forces of both sides, over the largest force, that counts as
zero."""
CLOSED = 1e-6
"""Gap over the largest displacement that counts as closed."""
KEPT = 0.3, 1.5
"""Largest values over those of a scale between which it stays."""
SIDES = "below", "above"
"""Names of the sides of a joint, as `Pieces.is_above` counts them."""


class PiecesView(ExtraView):
    """Each piece at its own displacement, with the forces on its sides.

    A tap selects the nearest joint.
    """

    name = "Pieces"
    needs = frozenset({"pieces"})

    def make(self) -> None:
        """Draw pieces, forces and the selected joint; the legend is below."""
        plot = bare(120, (0, WIDTH), (0, HEIGHT), x_axis_type=None)
        self._figure = plot
        look = {"fill_color": BODY, "fill_alpha": 0.4, "line_color": EDGE}
        self.add("pieces", "Patch", **look)
        self.add("supports", color=EDGE, width=1.2)
        self.add("selected", color=GHOST, width=8, alpha=0.3)
        for side in SIDES:
            self.add(f"micro {side}", color=MICRO[side], width=2.0)
        for side in SIDES:
            self.add(f"macro {side}", color=MACRO[side], width=2.2)
            self.add(f"heads {side}", "Patches", "xs ys", color=MACRO[side])
        self._told = self.add(
            "words",
            "Text",
            "x y text",
            text_color=WRITTEN[self.state.is_dark],
            text_font_size=TEXT,
            text_font=value("Roboto, sans-serif"),
            text_baseline="top",
        )
        marks = {
            "force on left, lower piece": MACRO["below"],
            "on right, upper piece": MACRO["above"],
            "pale: micro part": MICRO["above"],
        }
        self.mark(marks)
        keys = self.legend(*marks, place="center")
        keys.location = "bottom_left"
        self._scales: dict[str, float] = {}
        self._scene = ""
        self._tapped: int | None = None
        self._placed: _Placed | None = None
        self._last: tuple[Pieces, Frame, Selection] | None = None
        plot.on_event(Tap, self._tap)
        self.follow_size(WIDTH, HEIGHT)

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the pieces of a frame, or nothing if the frame has none."""
        super().update(frame, selection, ghost)
        if "pieces" not in frame.extras:
            self._last = None
            for name, source in self.sources.items():
                self.fill(name, **{column: [] for column in source.data})

    def _show(self, extra: Pieces, frame: Frame, selection: Selection) -> None:
        if self._last is None or self._last[0].names != extra.names:
            self._tapped = None
        self._last = extra, frame, selection
        stage = extra.stages[selection.stage]
        shown = frame.run.column(selection.phase)
        column = int(np.abs(extra.columns - shown).argmin())
        is_plane = frame.run.settings.kind == "plane"
        placed = _Placed(extra, self._box(extra, is_plane), is_plane)
        self._placed = placed
        self._scale(extra, frame)
        placed.move(stage, column, self._scales)
        self._line("pieces", placed.outlines)
        self._line("supports", placed.supports())
        self._show_forces(extra, stage, column)
        self._show_selected(extra, frame, selection)
        sentence = _sentence(extra, stage, column, selection.stage)
        self._write(f"{sentence}.", f"{self._note(extra)}.")

    def _box(self, extra: Pieces, is_plane: bool) -> Array:
        """Corners of the room between text and legend, (2, 2), px.

        The text stands above the pieces, or at their left if high ones are larger so.
        """
        width, height = self.room
        self._figure.x_range.end = width
        self._figure.y_range.end = height
        size = float(self._type.removesuffix("px"))
        letter = LETTER * size
        below = math.ceil(min(KEYS * letter / width, 2.0))
        line = FOOT * size
        most = max(int(TOLD * height / line), 1)
        self._rows = min(math.ceil(LETTERS * letter / width), most)
        self._letters = max(int(width / letter), 20)
        low = below * line
        high = max(height - self._rows * line, low)
        above = np.array([[0.0, low], [width, high]])
        beside = np.array([[BESIDE * width, low], [width, height]])
        rows = int((height - low) / line)
        letters = int(BESIDE * width / letter)
        is_larger = _fitting(extra, beside).min() > _fitting(extra, above).min()
        if is_plane and is_larger and rows * letters > RAGGED * LETTERS:
            self._rows = rows
            self._letters = letters
            return beside
        return above

    def _write(self, sentence: str, note: str) -> None:
        """Write a sentence next to the pieces, and a note if there is room."""
        # A factor stays beside its sign.
        text = f"{sentence} {note}".replace("× ", "×\N{NO-BREAK SPACE}")
        lines = textwrap.wrap(text, self._letters)
        if len(lines) > self._rows:
            lines = textwrap.wrap(sentence, self._letters)
        height = self.room[1]
        self._told.glyph.text_color = WRITTEN[self.state.is_dark]
        self.fill("words", x=[2.0], y=[height - 2.0], text=["\n".join(lines)])

    def _show_forces(self, extra: Pieces, stage: StageFields, column: int) -> None:
        placed = self._placed
        factor = placed.arrow / self._scales["force"]
        tails, forces, sides = placed.arrows(stage.forces[..., column])
        hairs = placed.hairs(factor * stage.micro[..., column])
        for index, side in enumerate(SIDES):
            is_own = extra.is_above[sides] == index
            lines, heads = _arrows(tails[is_own], factor * forces[is_own], placed.arrow)
            self._line(f"macro {side}", lines)
            xs, ys = np.moveaxis(np.round(heads, 1), -1, 0)
            self.fill(f"heads {side}", xs=xs.tolist(), ys=ys.tolist())
            is_own = extra.is_above[extra.sides] == index
            self._line(f"micro {side}", gapped(hairs[is_own]))

    def _line(self, name: str, points: Array) -> None:
        """Fill a line of points, (n, 2), px."""
        x, y = points.T.astype(np.float32)
        self.fill(name, x=x, y=y)

    def _show_selected(self, extra: Pieces, frame: Frame, selection: Selection) -> None:
        """Mark the joint that was tapped, or the one of the selected interface."""
        names = np.array(extra.names)
        chosen = names == selection.interface_of(frame.run)
        if self._tapped is not None:
            chosen = np.arange(len(names)) == self._tapped
        elif chosen.sum() > 1:
            chosen = np.zeros(len(names), dtype=bool)
        quarters = self._placed.quarters[chosen[extra.joints]]
        middle = quarters.mean(axis=1, keepdims=True)
        ends = middle + 2.0 * (quarters - middle)
        self._line("selected", gapped(ends))

    def _scale(self, extra: Pieces, frame: Frame) -> None:
        """Update the scales, if those of earlier frames of the run do not fit."""
        if self._scene != frame.run.settings.scene:
            self._scales = {}
            self._chosen = set[str]()
            self._scene = frame.run.settings.scene
        linear = extra.stages[LINEAR]
        totals = linear.forces.sum(axis=1)
        largest = {
            "force": np.hypot(totals[:, 0], totals[:, 1]).max(initial=0.0),
            "moved": np.nanmax(np.abs(linear.joined), initial=0.0),
            "gap": _open_gap(linear),
        }
        for name, size in largest.items():
            kept = self._scales.setdefault(name, 1.0)
            share = float(size) / kept
            # That gaps close is to be seen.
            is_closing = name == "gap" and share < 1.0 and name in self._chosen
            if share > 0.0 and not is_closing and not KEPT[0] <= share <= KEPT[1]:
                self._scales[name] = rounded_up(float(size))
                self._chosen.add(name)

    def _note(self, extra: Pieces) -> str:
        """Text on scales of displacements, gaps and arrows, and on omissions."""
        placed = self._placed
        force = self._scales["force"]
        texts = [f"Displacement × {number(placed.factor(self._scales), 2)}"]
        if _open_gap(extra.stages[LINEAR]):
            texts.append(f"gaps × {number(placed.jump_factor(self._scales), 2)}")
        texts.append(f"longest arrow {unit_for(force, 'N')(force)}")
        if extra.left_out:
            count = len(extra.names)
            texts.append(f"forces of {count} of {count + extra.left_out} joints")
        if len(extra.points) and not placed.is_plane:
            texts.append("micro forces drawn across")
        return ", ".join(texts)

    def _resize(self, name: str, old: float, new: float) -> None:
        super()._resize(name, old, new)
        if self._last is not None:
            with pn.io.hold():
                self._show(*self._last)

    def _tap(self, event: Any) -> None:
        """Select the joint nearest to the pointer, and its piece."""
        if self._last is None:
            return
        extra, frame, _ = self._last
        middles = self._placed.quarters.mean(axis=1)
        nearest = int(np.hypot(*(middles - [event.x, event.y]).T).argmin())
        self._tapped = int(extra.joints[nearest])
        piece = extra.owners[nearest]
        chosen: dict[str, Any] = {"substructure": int(extra.substructures[piece])}
        if extra.names[self._tapped]:
            chosen["interface"] = extra.names[self._tapped]
        self.state.select(**chosen)
        self._show(extra, frame, self.state.selection)


def _fitting(extra: Pieces, box: Array) -> Array:
    """Scales along x and y, (2,), px/m, with which pieces fill a box, (2, 2), px."""
    size = np.nanmax(extra.corners, axis=0) - np.nanmin(extra.corners, axis=0)
    return np.asarray(np.maximum(np.ptp(box, axis=0) - 2.0 * ROOM, SMALL) / size)


class _Placed:
    """Position of the pieces in a figure, px.

    The pieces fill a box, of two corners, (2, 2), px. Each shrinks about its middle, so
    that pieces that fit are a little apart.
    `outlines` are the moved corners, (n_corners, 2), and `quarters` the moved quarter
    points of sides, (n_sides, 2, 2); the longest arrow is `arrow` long. Micro forces of
    rods, which act along them, are drawn across, as otherwise they would hide in the
    outlines.
    """

    def __init__(self, extra: Pieces, box: Array, is_plane: bool) -> None:
        self._extra = extra
        self.is_plane = is_plane
        low = np.nanmin(extra.corners, axis=0)
        high = np.nanmax(extra.corners, axis=0)
        lows, highs = _boxes(extra.corners, extra.parts)
        scale = _fitting(extra, box)
        if is_plane:
            scale[:] = scale.min()
        else:
            thickness = float(np.median((highs - lows)[:, 1]))
            room = scale[1] * (high - low)[1]
            scale[1] = min(scale[1], THICK * room / thickness)
        self._pixels = scale
        self._origin = box.mean(axis=0) - 0.5 * (low + high) * scale
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


def _arrows(tails: Array, spans: Array, longest: float) -> tuple[Array, Array]:
    """Lines, (n, 2), with NaN in between, and heads, (n, 3, 2), of arrows, px.

    An arrow that is shorter than it can be seen has its least length.
    """
    sizes = np.hypot(*spans.T)
    is_shown = sizes > NEWS * longest
    sizes = sizes[is_shown, None]
    along = spans[is_shown] / sizes
    sizes = np.maximum(sizes, SMALLEST)
    tails = tails[is_shown]
    tips = tails + sizes * along
    length = np.minimum(HEAD, sizes)
    ends = tips - length * along
    half = 0.45 * length * along[:, ::-1] * [-1.0, 1.0]
    heads = np.stack([tips, ends + half, ends - half], axis=1)
    return gapped(np.stack([tails, ends], axis=1)), heads


def _open_gap(stage: StageFields) -> float:
    """Largest gap of a stage, m; 0 where it is no more than rounding."""
    gap = float(stage.gap.max(initial=0.0))
    if gap > CLOSED * float(np.nanmax(np.abs(stage.moved), initial=0.0)):
        return gap
    return 0.0


def _sentence(extra: Pieces, stage: StageFields, column: int, name: str) -> str:
    """Sentence on which pieces fit at the selected instant, and which do not."""
    totals = stage.forces.sum(axis=1)
    largest = float(np.hypot(totals[:, 0], totals[:, 1]).max(initial=0.0))
    size = np.zeros((len(extra.names), 2))
    np.add.at(size, extra.joints, totals[..., column])
    has_two = np.bincount(extra.joints, minlength=len(size)) == 2
    missing = np.hypot(*size[has_two].T) > BALANCED * largest
    count = len(missing)
    if name == LOCAL:
        return "Local stage: joints obey their laws, but pieces are not in balance"
    text = "Linear stage: each piece is in balance"
    if missing.any():
        text += f", macro forces differ at {missing.sum()} of {count} joints"
    elif count:
        text += f", and so are macro forces at {count} joints"
    gap = float(stage.gap[column])
    if gap > CLOSED * float(np.nanmax(np.abs(stage.moved))):
        text += f", gaps up to {unit_for(gap, 'm')(gap)}"
    return text
