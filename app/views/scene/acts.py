"""What acts on the bodies: an arrow as long as its value now, and that in words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from app.units import Unit, unit_for
from app.views.scene.layout import Layout, beside, is_aside, is_opposite
from solver.arrays import Array
from solver.discrete.structure import Act, Description

LEAST = 0.02
"""Share of its largest value below which an arrow is not drawn, or cannot be dragged."""
HEAD = 9.0
BOW = 0.22
"""Height of the bow of an arrow that bends, over its length."""


@dataclass(frozen=True, eq=False)
class Arrow:
    """An arrow, px from the middle of the bodies' foot.

    Attributes
    ----------
    act
        What it shows.
    line
        From its tail to its head, shape (n, 2).
    base, handle
        Where it would be at the value 0, and the end that moves with the value.
    value
        Now.
    """

    act: Act
    line: Array
    base: Array
    handle: Array
    value: float

    @property
    def head(self) -> Array:
        """Corners of its head."""
        along = self.line[-1] - self.line[-2]
        size = float(np.hypot(*along)) or 1.0
        along = along / size
        across = np.array([-along[1], along[0]])
        tip = self.line[-1]
        whole = np.hypot(*(self.line[-1] - self.line[0]))
        length = min(HEAD, float(whole))
        return np.array(
            [tip, tip + length * (-along + 0.5 * across), tip + length * (-along - 0.5 * across)]
        )

    def dragged(self, pointer: Array) -> float:
        """The value at which its handle is under the pointer."""
        along = self.handle - self.base
        return float(self.value * ((pointer - self.base) @ along) / (along @ along))


@dataclass(frozen=True)
class Word:
    """A text, px from the middle of the bodies' foot, and on which side of it is its anchor."""

    text: str
    place: Array
    align: str
    act: Act | None = None


def arrows_of(
    act: Act, description: Description, layout: Layout, peak: float, column: int, moved: Array
) -> list[Arrow]:
    """The arrows of what acts at an instant, the column of its values.

    An arrow of the value `peak` has full length; `moved` is where the act's places have gone,
    shape (n, 2), px from the middle of the foot.
    """
    towards = np.asarray(act.towards)
    towards = towards[:, column] if towards.ndim > 1 else towards
    away, aside = np.array(act.away), is_aside(act)
    side = act.where.partition(" ")[0]
    is_inside, distance = side == "body", beside(description, side)
    now = np.broadcast_to(act.values.T[column], len(moved))
    arrows = []
    for place, value in zip(moved, now, strict=True):
        share = float(np.clip(value / peak, -1.6, 1.6))
        if abs(share) < LEAST:
            continue
        base = place + distance * away if aside else place
        span = layout.arrow * share * towards
        pushes = not aside and not is_inside and span @ away < 0.0
        tail, head = (base - span, base) if pushes else (base, base + span)
        line = np.array([tail, head])
        if act.unit == "1/m":
            line = _bow(tail, head, away)
        arrows.append(Arrow(act, line, base, tail if pushes else head, float(value)))
    return arrows


def _bow(tail: Array, head: Array, away: Array) -> Array:
    share = np.linspace(0.0, 1.0, 9)[:, None]
    height = BOW * np.hypot(*(head - tail)) * 4.0 * share * (1.0 - share)
    return np.asarray(tail + share * (head - tail) + height * away)


def beam_of(arrows: list[Arrow]) -> Array | None:
    """The line over the arrows of what is spread along a side."""
    if len(arrows) < 3 or arrows[0].act.unit == "N" or is_aside(arrows[0].act):
        return None
    return np.array([arrow.handle for arrow in arrows])


def words_of(
    description: Description,
    layout: Layout,
    acts: Mapping[Act, tuple[Array, list[Arrow]]],
    column: int,
) -> list[Word]:
    """What acts in words; what presses from above and below alike is said once."""
    above = [act for act in description.acts if act.where.startswith("top")]
    words = []
    for act, (places, arrows) in acts.items():
        side = act.where.partition(" ")[0]
        if side != "bottom" or not any(is_opposite(act, other) for other in above):
            words.append(_word(act, description, layout, side, places, arrows, column))
    return words


def _word(
    act: Act,
    description: Description,
    layout: Layout,
    side: str,
    places: Array,
    arrows: list[Arrow],
    column: int,
) -> Word:
    text, aside, away = text_of(act, column), is_aside(act), np.array(act.away)
    if side in ("top", "bottom"):
        is_left = float(np.mean(act.places[:, 0])) < 0.45
        place = places[0 if is_left else -1]
        ends = [place, *(end for arrow in arrows for end in arrow.line)]
        x = min(end[0] for end in ends) - 10.0 if is_left else max(end[0] for end in ends) + 10.0
        up = beside(description, side) if aside else 0.75 * layout.arrow
        return Word(
            text, np.array([x, place[1] + up * away[1]]), "right" if is_left else "left", act
        )
    if side == "body":
        if layout.size[0] < 0.5 * layout.width:
            return Word(
                text, np.array([-0.5 * layout.size[0] - 14.0, layout.size[1]]), "right", act
            )
        return Word(text, np.array([0.0, 0.5 * layout.size[1] + 14.0]), "center", act)
    align = "left" if side == "right" else "right"
    if aside:
        return Word(text, places[-1] + [22.0 * away[0], -16.0], align, act)
    return Word(text, places[-1] + [9.0 * away[0], 15.0], align, act)


def text_of(act: Act, column: int) -> str:
    """A symbol and its value now; what varies along a side at both of its ends."""
    unit = unit_of(act)
    now = np.atleast_1d(act.values.T[column])
    peak = float(np.abs(act.values).max())
    # Rounding of a load path leaves what is nearly nothing, as sin(pi).
    texts = [unit(0.0 if abs(value) < 1e-6 * peak else float(value)) for value in now[[0, -1]]]
    return (
        f"{act.symbol} = {texts[0]}"
        if len(now) == 1
        else f"{act.symbol} = {texts[0]} to {texts[1]}"
    )


def unit_of(act: Act) -> Unit:
    """The unit that its values are read in."""
    return unit_for(float(np.abs(act.values).max()), act.unit)
