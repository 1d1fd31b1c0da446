"""The structure in pieces, with the forces on both sides of joints."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.models import Title

from app.frame import LINEAR, LOCAL, Frame, Selection
from app.views.axis import rounded_up
from app.views.colors import BODY, EDGE, GHOST, MACRO, MICRO
from app.views.parts import bare, gapped, heads_of
from app.views.placed_pieces import PlacedPieces
from app.views.type_size import LETTER
from app.views.view import ExtraView
from app.worker.pieces import Pieces, StageFields
from solver.arrays import Array
from solver.files.amounts import number, unit_for

WIDTH = 600.0
HEIGHT = 260.0
"""Size of the figure until the browser reports its own, px."""
HEAD = 7.0
SMALLEST = 3.0
"""Length of the head of an arrow, and of an arrow of a force that just is not zero,
px."""
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
        self._told = Title(text_font_style="normal")
        plot.add_layout(self._told, "above")
        marks = {
            "force on left, lower piece": MACRO["below"],
            "on right, upper piece": MACRO["above"],
            "pale: micro part": MICRO["above"],
        }
        self.mark(marks)
        self.legend(*marks, place="below")
        self._scales: dict[str, float] = {}
        self._scene = ""
        self._tapped: int | None = None
        self._placed: PlacedPieces | None = None
        self._names: Sequence[str] = ()
        plot.on_event(Tap, self._tap)
        self.follow_size(WIDTH, HEIGHT)

    def _show(self, extra: Pieces, frame: Frame, selection: Selection) -> None:
        if self._names != extra.names:
            self._tapped = None
        self._names = extra.names
        stage = extra.stages[selection.stage]
        shown = frame.run.column(selection.phase)
        column = int(np.abs(extra.columns - shown).argmin())
        is_plane = frame.run.settings.kind == "plane"
        self._figure.x_range.end = self.room[0]
        self._figure.y_range.end = self.room[1]
        placed = PlacedPieces(extra, self.room, is_plane)
        self._placed = placed
        self._scale(extra, frame)
        placed.move(stage, column, self._scales)
        self._line("pieces", placed.outlines)
        self._line("supports", placed.supports())
        self._show_forces(extra, stage, column)
        self._show_selected(extra, frame, selection)
        sentence = _sentence(extra, stage, column, selection.stage)
        self._write(f"{sentence}. {self._note(extra)}.")

    def clear(self, *names: str) -> None:
        """Leave no data in sources, and no text."""
        super().clear(*names)
        self._told.text = ""

    def _write(self, text: str) -> None:
        """Write a text above the pieces, in lines that are as long as the figure."""
        # A factor stays beside its sign.
        text = text.replace("× ", "×\N{NO-BREAK SPACE}")
        letters = int(self.room[0] / (LETTER * self.type_size))
        self._told.text = textwrap.fill(text, max(letters, 20))

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
        chosen = names == frame.run.interface(selection.interface)
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

    def _tap(self, event: Any) -> None:
        """Select the joint nearest to the pointer, and its piece."""
        if self._shown is None or "pieces" not in self._shown[0].extras:
            return
        frame = self._shown[0]
        extra = frame.extras["pieces"]
        middles = self._placed.quarters.mean(axis=1)
        nearest = int(np.hypot(*(middles - [event.x, event.y]).T).argmin())
        self._tapped = int(extra.joints[nearest])
        piece = extra.owners[nearest]
        chosen: dict[str, Any] = {"substructure": int(extra.substructures[piece])}
        if extra.names[self._tapped]:
            chosen["interface"] = extra.names[self._tapped]
        self.state.select(**chosen)
        self._show(extra, frame, self.state.selection)


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
    lengths = np.minimum(HEAD, sizes)
    shafts = np.stack([tails, tips - lengths * along], axis=1)
    return gapped(shafts), heads_of(tips, along, lengths)


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
