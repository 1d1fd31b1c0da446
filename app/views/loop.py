"""Force against displacement at the loaded end: what is inside the loop is dissipated."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from app.views.colors import BLUE, GHOST, ORANGE, VERMILION
from app.views.drawing import Axis, Curve, Drawing, Marks, Plot, Scene, View, has_instants
from app.views.legend import Key
from app.views.scales import Limits, decimal_scale, held, spanned
from app.worker.frames import Fields
from app.worker.recording import Recording
from app.worker.shown import Axes

Pair = tuple[np.ndarray, np.ndarray]
POINT = Marks((), (), VERMILION)
STILL = 1e-6
"""Displacement that an axis reaches where nothing moves, m."""


def draw(scene: Scene, kept: tuple[Limits, Limits] | None) -> Drawing:
    """Draw the loop of the shown iterate, beside its reference and the run before."""
    run, begun, axes = scene.run, scene.run.stand, scene.run.stand.loop
    now = _pair(run, scene.frame.fields)
    limits = _limits(run, now, kept)
    (x, across), (y, up) = (
        _axis(quantity, one) for quantity, one in zip((axes.across, axes.up), limits, strict=True)
    )

    def scaled(pair: Pair, *style: Any, **more: Any) -> Curve:
        return Curve(pair[0] / across, pair[1] / up, *style, **more)

    curves, keys = [], [Key(BLUE, "line", scene.name)]
    if run.reference is not None:
        keys.append(Key(ORANGE, "line", "reference"))
    if scene.before is not None and (ghost := _newest(scene.before, axes)):
        curves.append(scaled(ghost, GHOST, 2))
        keys.append(Key(GHOST, "line", scene.ghost_name))
    if run.reference is not None:
        curves.append(scaled(_pair(run, run.reference), ORANGE, 4.5))
    curves.append(scaled(now, BLUE))
    time = begun.instants[scene.instant]
    at = [float(np.interp(time, begun.all_instants, one)) for one in now]
    point = replace(POINT, x=[at[0] / across], y=[at[1] / up])
    return Drawing(x, y, curves, (point,), keys=keys, kept=limits)


def _limits(run: Recording, now: Pair, kept: tuple[Limits, Limits] | None) -> tuple[Limits, Limits]:
    """Hold the loop that the run should come to, where it is known."""
    begun, settled = run.stand, None
    if run.reference is not None:
        settled = _pair(run, run.reference)
    elif begun.closed_form_end is not None and begun.load is not None:
        settled = begun.closed_form_end, begun.load
    if settled is None:
        old: Any = kept or (None, None)
        across, up = (
            held(o, float(v.min()), float(v.max())) for o, v in zip(old, now, strict=True)
        )
        return across, up
    return _around(settled[0], begun.loop.across[1]), _around(settled[1], begun.loop.up[1])


def _pair(run: Recording, fields: Fields) -> Pair:
    """Give displacement and force of an iterate or a reference."""
    load = run.stand.load if fields.load is None else fields.load
    assert load is not None
    return fields.end_displacement, load


def _newest(run: Recording, axes: Axes) -> Pair | None:
    """Give the loop that a run came to, where it is one of the same quantities."""
    return None if run.frame is None or run.stand.loop != axes else _pair(run, run.frame)


def _axis(quantity: tuple[str, str], limits: Limits) -> tuple[Axis, float]:
    """Put limits and a unit that suits them on an axis; give the factor of the unit too."""
    title, unit = quantity
    size = max(-limits[0], limits[1])
    angle = (1e-3, "mrad") if size < 0.5 else (1.0, "rad")
    factor, shown = decimal_scale(size, unit) if unit else angle
    return spanned(limits[0] / factor, limits[1] / factor, label=f"{title} ({shown})"), factor


def _around(values: np.ndarray, unit: str) -> Limits:
    low, high = min(float(values.min()), 0.0), max(float(values.max()), 0.0)
    margin = 0.12 * (high - low) or (STILL if unit == "m" else 1.0)
    return low - margin, high + margin


VIEW = View(
    "Hysteresis loop",
    Plot("End displacement (mm)", "Force (N)", marks=(POINT,)),
    draw,
    has_instants,
)
