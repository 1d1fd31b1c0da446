"""What acts on the bodies of a scene: an arrow as long as its value, and that in words."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from app.picture.units import scale_of
from app.views.bodies.posed import Posed
from app.views.drawing import sketch
from app.views.drawing.drawing import Box, Word
from solver.arrays import Array
from solver.discrete.structure import OUTWARD, Act
from solver.phrases import Phrase, joined

ARROW, BESIDE = 38.0, 8.0
"""Length of an arrow at the largest value, and its distance from the side that it points along."""
LEAST = 0.02
"""Share of its largest value below which an arrow is not drawn."""
NOTHING = 1e-6
"""Share of its largest value below which one is told as zero."""
GAP = 4.0
"""Pixels between what is drawn and what is said."""
BETWEEN = "\u2003"
"""Between words of one line, whose room follows the type and not the size of the picture."""


@dataclass(frozen=True, eq=False)
class Arrow:
    """One that is drawn: its place, m, and where its tail and its head are from there, px."""

    place: Array
    tail: Array
    head: Array

    @property
    def stroke(self) -> Array:
        """The line from its tail to its head."""
        return sketch.line([self.place, self.place], [self.tail, self.head])


def side_of(act: Act) -> str:
    """Name the side that it acts on, or "body"."""
    return act.where.partition(" ")[0]


def room_of(act: Act) -> float:
    """Give the pixels that its arrow takes beside the bodies."""
    return BESIDE + GAP if _is_aside(act) else ARROW + GAP


def arrows(posed: Posed, act: Act) -> list[Arrow]:
    """Give the arrows of what acts, as long as it is now."""
    peak = float(np.abs(act.values).max())
    shares = np.broadcast_to(posed.now(act.values) / peak, len(act.places))
    towards, away = np.array(act.towards), np.array(act.away)
    if towards.ndim > 1:
        towards = posed.now(towards)
    base = BESIDE * away if _is_aside(act) else np.zeros(2)
    is_inside = side_of(act) == "body"
    found = []
    places = posed.moved(act.places * [posed.length, posed.height])
    for place, share in zip(places, shares, strict=True):
        length = ARROW * float(share) * towards
        if abs(share) <= LEAST:
            continue
        before = 0.5 if _is_aside(act) else 0.0 if is_inside or length @ away >= 0.0 else 1.0
        found.append(Arrow(place, base - before * length, base + (1.0 - before) * length))
    return found


def stroke(act: Act, found: list[Arrow]) -> Array:
    """Give arrows; what is spread over a side has a line over their tails."""
    draws = sketch.bow if act.unit == "1/m" else sketch.arrow
    strokes = [draws(one.place, one.tail, one.head) for one in found]
    if len(found) > 2 and act.unit != "N":
        outer = [max((one.tail, one.head), key=lambda end: float(np.hypot(*end))) for one in found]
        strokes.append(sketch.line([one.place for one in found], outer))
    return sketch.joined(strokes)


def words(posed: Posed, box: Box, units: str) -> list[Word]:
    """Give values of all that acts: above and below the bodies, and at their sides' corners."""
    left, right, below, above = box.room
    rows = {"top": (box.high, above, "bottom"), "bottom": (box.low, -below, "top")}
    columns = {"left": (box.left, GAP - left), "right": (box.right, right - GAP)}
    found = []
    for (row, column), acts in _said(posed).items():
        y, dy, up = rows[row]
        texts = [_value(posed, act, units) for act in acts]
        if column:
            x, dx = columns[column]
            between = BETWEEN if posed.is_strand else "\n"
            found.append(Word(x, y, joined(between, texts), column, up, dx, dy))
            continue
        found.append(Word(0.5 * posed.length, y, BETWEEN.join(texts), "center", up, dy=dy))
    for act in posed.described.acts:
        if side_of(act) == "body":
            x, y = posed.placed(posed.moved(act.places * [posed.length, posed.height]))[0]
            found.append(Word(x, y, _value(posed, act, units), "center", "bottom", dy=GAP))
    return found


def lines_of(posed: Posed) -> tuple[int, int]:
    """Give the lines of words below and above the bodies."""
    lines = {"bottom": 0, "top": 0}
    for (row, column), own in _said(posed).items():
        lines[row] = max(lines[row], len(own) if column and not posed.is_strand else 1)
    return lines["bottom"], lines["top"]


def _said(posed: Posed) -> dict[tuple[str, str], list[Act]]:
    """Give what is said in which row, by its column: "" is the middle.

    What acts on an end is said above if that is long, or if it acts up or down, as far as there is
    room. What acts on the top and on the bottom alike is said once.
    """
    acts = posed.described.acts
    found: dict[tuple[str, str], list[Act]] = defaultdict(list)
    by_side = {side: [act for act in acts if side_of(act) == side] for side in OUTWARD}
    for act in by_side["top"]:
        found["top", ""].append(act)
    for act in by_side["bottom"]:
        if not any(_is_opposite(act, other) for other in by_side["top"]):
            found["bottom", ""].append(act)
    for side in ("left", "right"):
        for act in by_side[side]:
            is_above = (_is_aside(act) or posed.is_long) and len(by_side["top"]) < 2
            found["top" if is_above else "bottom", side].append(act)
    return found


def _is_opposite(act: Act, other: Act) -> bool:
    return act.unit == other.unit and np.array_equal(act.values, -other.values)


def _value(posed: Posed, act: Act, units: str) -> str:
    """Say what acts now; what varies along a side, at both of its ends."""
    unit, name = scale_of(float(np.abs(act.values).max()), act.unit, units)
    now = np.atleast_1d(posed.now(act.values)) / unit
    # Instants are rounded as they are sent: what passes zero is not quite there.
    now = np.where(np.abs(now) < NOTHING * float(np.abs(act.values).max()) / unit, 0.0, now)
    values = [sketch.plain(float(one)) for one in now]
    value = values[0] if len(values) == 1 else Phrase("{} to {}", *values)
    return Phrase("{} = {} {}", act.symbol, value, name)


def _is_aside(act: Act) -> bool:
    return np.ndim(act.towards) < 2 and abs(float(np.dot(act.towards, act.away))) < 0.5
