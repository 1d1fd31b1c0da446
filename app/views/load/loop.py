"""Force against displacement at the loaded end: what is inside the loop is dissipated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from app.picture.frames import DrawnFields
from app.picture.recording import Recording
from app.picture.shown import Axes
from app.picture.strands import Stiffness
from app.views import brought
from app.views.drawing.colors import BLUE, GHOST, GREEN, GREY, ORANGE, PURPLE, VERMILION
from app.views.drawing.drawing import Axis, Curve, Drawing, Marks, Plot, View, has_instants
from app.views.drawing.legend import Key
from app.views.drawing.scales import Limits, held, spanned
from app.views.scene import Scene

STIFFNESS = Key(GREY, "dashed", "all stick"), Key(PURPLE, "dotted", "all slip")
Pair = tuple[np.ndarray, np.ndarray]
POINT = Marks((), (), VERMILION)
STILL = 1e-6
"""Displacement that an axis reaches where nothing moves, m."""


def draw(scene: Scene, kept: tuple[Limits, Limits] | None) -> Drawing:
    """Draw the loop of the shown iterate, beside its reference and the run before."""
    run, begun, axes = scene.run, scene.run.stand, scene.run.stand.loop
    now = _pair(run, scene.frame.fields)
    ghost = _newest(scene.before, axes) if scene.before is not None else None
    theirs, more = brought.at_end(scene)
    pairs = [
        now,
        *([ghost] if ghost else []),
        *((np.asarray(o.x), np.asarray(o.y)) for o in theirs),
    ]
    limits = _limits(run, pairs, kept)
    x, y = (
        spanned(*one, label=title, unit=unit)
        for (title, unit), one in zip((axes.across, axes.up), limits, strict=True)
    )
    curves, keys = [], [Key(BLUE, "line", scene.name)]
    if run.reference is not None:
        keys.append(Key(ORANGE, "line", "reference"))
    if begun.strand is not None:
        curves += _stiffness(begun.strand.bending, x, y)
        keys += STIFFNESS
    if ghost is not None:
        curves.append(Curve(*ghost, GHOST, 2))
        keys.append(Key(GHOST, "line", scene.ghost_name))
    if exact := begun.known("loop"):
        curves += [Curve(one.across, one.up, GREEN, 7) for one in exact]
        keys.append(Key(GREEN, "band", "closed form"))
    if run.reference is not None:
        curves.append(Curve(*_pair(run, run.reference), ORANGE, 4.5))
    curves += [Curve(*now, BLUE), *theirs]
    time = begun.instants[scene.instant]
    at = [float(np.interp(time, begun.all_instants, one)) for one in now]
    point = replace(POINT, x=at[:1], y=at[1:])
    return Drawing(x, y, curves, (point,), keys=[*keys, *more], kept=limits)


def _stiffness(bending: Stiffness, x: Axis, y: Axis) -> list[Curve]:
    """Give lines as steep as a strand is stiff while nothing slips, and once all does."""
    found = []
    for key, value in zip(STIFFNESS, bending, strict=True):
        ends = np.clip([x.low, x.high], y.low / value, y.high / value)
        found.append(Curve(ends, value * ends, key.color, 1.5, key.mark))
    return found


def _limits(
    run: Recording, pairs: Sequence[Pair], kept: tuple[Limits, Limits] | None
) -> tuple[Limits, Limits]:
    """Hold the loop that the run should come to, where it is known, with all that is drawn."""
    begun, settled = run.stand, None
    if run.reference is not None:
        settled = _pair(run, run.reference)
    elif exact := begun.known("loop"):
        settled = exact[0].across, exact[0].up
    across, up = (
        _around([one[axis] for one in pairs], settled and settled[axis], unit, kept and kept[axis])
        for axis, (_, unit) in enumerate((begun.loop.across, begun.loop.up))
    )
    return across, up


def _pair(run: Recording, fields: DrawnFields) -> Pair:
    """Give displacement and force of an iterate or a reference."""
    load = run.stand.load if fields.load is None else fields.load
    assert load is not None
    return fields.end_displacement, load


def _newest(run: Recording, axes: Axes) -> Pair | None:
    """Give the loop that a run came to, where it is one of the same quantities."""
    return None if run.frame is None or run.stand.loop != axes else _pair(run, run.frame)


def _around(
    values: Sequence[np.ndarray], settled: np.ndarray | None, unit: str, old: Limits | None
) -> Limits:
    """Give limits around values: those of what is settled, as long as they have all the others."""
    if settled is None:
        return held(old, *_ends(values))
    low, high = _ends([settled])
    margin = 0.12 * (high - low) or (STILL if unit == "m" else 1.0)
    first, last = _ends([settled, *values])
    if low - margin <= first and last <= high + margin:
        return low - margin, high + margin
    return held(old, first, last)


def _ends(values: Sequence[np.ndarray]) -> Limits:
    """Give the smallest and the largest value, and zero."""
    low, high = min(float(one.min()) for one in values), max(float(one.max()) for one in values)
    return min(low, 0.0), max(high, 0.0)


VIEW = View(
    "Hysteresis loop",
    Plot("End displacement", "Force", marks=(POINT,)),
    draw,
    has_instants,
)
