"""How many numbers the friction force takes: as a table, in products, and as clips with memory."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from app.picture.clipped import Clipped
from app.picture.units import rounded
from app.views.drawing.colors import BLUE, GREEN, GREY, VERMILION
from app.views.drawing.drawing import Curve, Drawing, Marks, Plot, View, has_instants
from app.views.drawing.legend import Key
from app.views.drawing.scales import across, decades, in_decades, upright
from app.views.scene import Scene
from solver.phrases import Phrase
from solver.reduction.sizes import Sizes
from solver.settings import Settings
from solver.study.quantities.clip_measures import can_be_clipped

MOST_VALUES = 1_000_000
"""Values of a field up to which all curves take no longer than a second, in which the worker obeys
no order (measured: 0.9 s for 1001 x 999)."""
FLOOR = 1e-6
"""Smallest error that is told from none."""
SHARE = 0.01
"""Error at which numbers are compared."""
EXACT = 1e-9
"""Error up to which clips are exact, but for rounding."""
RING, ABOVE = Marks((), (), VERMILION, "ring"), 0.04
"""Stands for clips alone, where they are exact this share of the axis above its foot."""


def applies(settings: Settings) -> bool:
    """Tell whether there are rods, whose friction bound is known, and not too many values."""
    if not can_be_clipped(settings) or not has_instants(settings):
        return False
    values = settings.values()
    interfaces = values.get("wires", 2) - 1
    return bool(interfaces * (values["elements"] + 1) * settings.n_instants <= MOST_VALUES)


def draw(scene: Scene, _kept: None) -> Drawing:
    """Draw the error of the friction force of this iterate over the numbers that are kept of it.

    It is a distance to the iterate itself, not to the solution.
    """
    found = scene.frame.clipped
    ways = [*_ways(found)]
    sizes = [one for one, _ in ways]
    x = in_decades(*decades([found.table, *(value for one in sizes for value in one.numbers)], 1.0))
    y = in_decades(decades([SHARE, *(value for one in sizes for value in one.errors)], FLOOR)[0], 1)
    curves = [
        upright([found.table], y, color=GREY, width=1.5, dash="dashed"),
        across([SHARE], x, color=GREY, width=1),
        *(_curve(one, key.color, y.low) for one, key in ways),
    ]
    alone = max(float(found.clips.errors[0]), y.low * (y.high / y.low) ** ABOVE)
    return Drawing(
        x,
        y,
        curves,
        [replace(RING, x=[found.clips.numbers[0]], y=[alone])],
        keys=[*(key for _, key in ways), Key(GREY, "dashed", "whole table")],
        sentence=_sentence(found),
    )


def _ways(found: Clipped) -> Iterator[tuple[Sizes, Key]]:
    """Give all ways with their legend; what is drawn last lies above the others."""
    yield found.products, Key(BLUE, "line", "SVD")
    if found.separated is not None:
        best = Phrase("best PGD in {} pieces", found.pieces)
        yield found.separated, Key(GREEN, "line", "PGD of the run" if found.is_of_bases else best)
    missed = float(found.clips.errors[0])
    if missed <= EXACT:
        key = Key(VERMILION, "ring", Phrase("clips, {} × 2 vectors: exact", found.branches))
    else:
        told = rounded(100.0 * missed, 2)
        key = Key(VERMILION, "line", Phrase("clips, {} × 2 vectors: {} %", found.branches, told))
    yield found.clips, key


def _curve(sizes: Sizes, color: str, low: float) -> Curve:
    """Draw errors from the first number on, down to the first that is as good as none."""
    some = sizes.numbers > 0
    numbers, errors = sizes.numbers[some], sizes.errors[some]
    below = np.flatnonzero(errors <= low)
    end = int(below[0]) + 1 if len(below) else len(errors)
    return Curve(numbers[:end], np.maximum(errors[:end], low), color)


def _sentence(found: Clipped) -> str:
    """Say how many numbers each way takes for the same error."""
    if found.separated is None:
        told, ways = "For 1 %: table {}, SVD {}, clips {} numbers.", (found.products, found.clips)
        return Phrase(told, found.table, *map(_count, ways))
    told = "For 1 %: table {}, SVD {}, PGD {}, clips {} numbers."
    return Phrase(told, found.table, *map(_count, (found.products, found.separated, found.clips)))


def _count(sizes: Sizes) -> str:
    numbers = sizes.within(SHARE)
    return "never" if math.isinf(numbers) else f"{numbers:.0f}"


VIEW = View(
    "Friction as clips",
    Plot("Numbers kept", "Error of the friction", logarithmic="xy", marks=(RING,)),
    draw,
    applies,
)
