"""Results of another program, where a plot shows their quantity."""

from __future__ import annotations

import numpy as np

from app.picture.shown import Floats, floats
from app.picture.units import TIME, measured
from app.views.drawing.colors import VERMILION
from app.views.drawing.drawing import Curve
from app.views.drawing.legend import Key
from app.views.scene import Scene
from solver.phrases import Phrase
from solver.study.other_programs.brought import DISPLACEMENT, FRICTION

SHORT = 0.01
"""Share of the body's length that a point alone is drawn as."""


def along(scene: Scene) -> tuple[list[Curve], list[Key]]:
    """Draw their friction along the interface, at the instant of theirs that is nearest."""
    beside = scene.beside
    if beside is None or beside.brought.quantity != FRICTION:
        return [], []
    brought, now = beside.brought, float(scene.run.stand.instants[scene.instant])
    time, x, values = brought.nearest(now)
    if len(x) == 1:
        half = 0.5 * SHORT * scene.length
        x, values = np.array([x[0] - half, x[0] + half]), np.repeat(values, 2)
    name = Phrase("{}, t = {}", brought.source, measured(time, TIME, scene.look.units))
    return [Curve(x, values, VERMILION, 2, "dashed")], [Key(VERMILION, "dashed", name)]


def friction_of(scene: Scene) -> list[Floats]:
    """Give all of their friction, which an axis has to hold."""
    brought = scene.beside.brought if scene.beside else None
    return [] if brought is None or brought.quantity != FRICTION else [floats(brought.values)]


def at_end(scene: Scene) -> tuple[list[Curve], list[Key]]:
    """Draw their displacement of the loaded end under our force, at their instants."""
    beside, stand, fields = scene.beside, scene.run.stand, scene.frame.fields
    load = stand.load if fields.load is None else fields.load
    if beside is None or beside.brought.quantity != DISPLACEMENT or load is None:
        return [], []
    times, values = beside.brought.at_end(scene.run.settings.length)
    during = times <= stand.all_instants[-1]
    if not during.any():
        return [], []
    force = np.interp(times[during], stand.all_instants, load)
    name = beside.brought.source
    return [Curve(values[during], force, VERMILION, 2, "dashed")], [Key(VERMILION, "dashed", name)]
