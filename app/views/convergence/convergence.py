"""Indicators beside true errors, over iterations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from app.picture.shown import has_reference
from app.views.convergence.earlier_runs import drawn
from app.views.drawing.colors import BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION
from app.views.drawing.drawing import Curve, Drawing, Marks, Plot, View
from app.views.drawing.legend import Key
from app.views.drawing.scales import decades, in_decades, round_up, spanned, upright
from app.views.scene import Scene

CURVES = (
    ("indicator", GREY, "η", "dashed"),
    ("behaviour", PURPLE, "k-free indicator", "dashed"),
    ("estimated_error", ORANGE, "estimated force error", "dashed"),
    ("error_displacement", GREEN, "displacement error", "solid"),
    ("error_force", BLUE, "force error", "solid"),
)
FLOOR = 1e-18
LEAST_SPAN = (1e-2, 10.0)
"""What is shown at least; a curve beyond it widens it by whole decades."""
ERRORS = 3
"""First of them that is an error, and needs a reference."""
MOST_POINTS = 400
ANSWER, ABOVE = Marks([], [], BLUE, "ring"), 0.04
"""Stands at the foot of the axis, as its error is none, this share of it above its end."""
ROOM = 0.36
"""Share of the width that is left to iterations over k, once there are some."""
KEYS = tuple(
    Key(color, "line" if dash == "solid" else "dashed", text) for _, color, text, dash in CURVES
)


def draw(scene: Scene, _kept: None) -> Drawing:
    """Draw what the method knows of itself (dashed), and how far it really is (solid).

    Beside it stands run A, or else with separated bases the full linear stage, or else the last
    runs of other settings. Beyond all of them is room for iterations over k.
    """
    run, is_known = scene.run, has_reference(scene.run.settings)
    now = run.history.thinned(MOST_POINTS, run.searched)
    ghosts, ghost_keys = _beside(scene, "error_force" if is_known else "estimated_error")
    keys = (*(KEYS if is_known else KEYS[:ERRORS]), *ghost_keys)
    values = [value for name, *_ in CURVES for value in now[name]]
    values += [value for one in ghosts for value in np.asarray(one.y)]
    y = in_decades(*decades([*LEAST_SPAN, *values], FLOOR))
    ends = (float(np.max(one.x, initial=0.0)) for one in ghosts)
    end = max(run.iteration, 20, *ends)
    has_inset = scene.bathtub is not None and scene.bathtub.points
    x = spanned(0, end / (1.0 - ROOM) if has_inset else round_up(end))
    curves = [*ghosts]
    for name, color, _, dash in CURVES:
        # An estimate is not made in every iteration, and the reference may come later.
        known = np.isfinite(now[name])
        curves.append(Curve(now["iteration"][known], now[name][known], color, dash=dash))
    curves.append(upright([scene.frame.iteration], y, color=VERMILION, width=2))
    answer = [] if run.answer is None else [run.answer]
    if answer:
        keys = (*keys, Key(ANSWER.color, ANSWER.kind, "answer"))
    low = y.low * (y.high / y.low) ** ABOVE
    marks = [replace(ANSWER, x=answer, y=[low] * len(answer))]
    return Drawing(x, y, curves, marks, keys=keys)


def _beside(scene: Scene, column: str) -> tuple[list[Curve], list[Key]]:
    """Draw what the run at work is compared with, with its legend."""
    run, before = scene.run, scene.before
    if scene.is_paired and before is not None:
        return _errors(before.history.thinned(MOST_POINTS, before.searched), "A")
    if run.settings.applies("pgd_modes"):
        return _errors(run.beside.thinned(MOST_POINTS), "full stage")
    return drawn(scene, column)


def _errors(past: dict[str, NDArray[np.float64]], name: str) -> tuple[list[Curve], list[Key]]:
    curves = [
        Curve(past["iteration"], past[column], color, 1.2)
        for column, color, _, _ in CURVES[ERRORS:]
    ]
    return curves, [Key(BLUE, "thin", name)]


VIEW = View(
    "Convergence",
    Plot("Iteration", "Indicator, error", logarithmic="y", whole="x", marks=(ANSWER,)),
    draw,
)
