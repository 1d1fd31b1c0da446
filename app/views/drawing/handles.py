"""What one can take hold of, and tap on, in the picture of a scene."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from app.picture.portrait import PITCH, THICKNESS, Portrait
from app.picture.shown import thinned
from app.views.drawing.sketch import line
from solver.arrays import Array
from solver.scenes import behind
from solver.settings import Settings

DOUBLED = 120.0
"""Pixels along an arrow that double its value."""
REACH = 14.0
"""Half of the length, px, of what is taken hold of at a place."""
ROUGH = 9
"""Points of an interface by which a tap on it is known."""
STEEPEST = 0.03
"""Depth of a gap, as a share of the size, below which it is dragged as one so deep."""


@dataclass(frozen=True, eq=False)
class Handle:
    """A stretch that is dragged along itself.

    Attributes
    ----------
    setting
        Name of the setting that follows.
    ends
        Where it lies, a stroke of shape (2, 4), m and px; the value grows by the rate from the
        first to the second.
    value
        Of the setting.
    rate
        What the value gains on the way of a metre, or of a pixel; its decimal logarithm, where the
        setting's slider is logarithmic.
    is_metric
        Whether the rate is of a metre.
    """

    setting: str
    ends: Array
    value: float
    rate: float
    is_metric: bool = True


def on_arrow(setting: str, settings: Settings, arrow: Array) -> Handle:
    """Make a handle of an arrow, from its tail to its head."""
    value = float(getattr(settings, setting))
    return Handle(setting, arrow, value, value / DOUBLED, is_metric=False)


def on_bodies(portrait: Portrait, settings: Settings, gap: Array | None) -> Iterator[Handle]:
    """Make handles of the break of a wire, and of both ends of a gap as it is drawn, m."""
    found, size = behind(settings), max(portrait.size)
    length, broken = portrait.described.length, portrait.described.broken
    if "break" in found and broken is not None:
        body, x = broken
        place = (x, (PITCH * body + 0.5 * THICKNESS) * length)
        name = found["break"]
        ends = line([place, place], [[-REACH, 0.0], [REACH, 0.0]])
        yield Handle(name, ends, float(getattr(settings, name)), 1.0 / length)
    if "gap" in found and gap is not None:
        name = found["gap"]
        for x, depth in ((0.0, gap[0]), (length, gap[-1])):
            ends = line([(x, -depth), (x, -depth)], [[0.0, -REACH], [0.0, REACH]])
            # The depth is in inverse proportion to the radius.
            rate = 1.0 / (np.log(10.0) * max(float(depth), STEEPEST * size))
            yield Handle(name, ends, float(getattr(settings, name)), rate)


def choices(contacts: Mapping[str, Array]) -> dict[str, Array]:
    """Thin out where interfaces lie, shape (n_points, 2) each; none where there is no choice.

    Lines that are broken, by NaN, stay as they are.
    """
    found = {
        name: one if np.isnan(one).any() else one[thinned(len(one), ROUGH)]
        for name, one in contacts.items()
        if len(one)
    }
    return found if len(found) > 1 else {}
