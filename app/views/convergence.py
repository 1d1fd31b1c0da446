"""Indicators beside true errors, over iterations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.picture.recording import History
from app.picture.shown import has_reference
from app.views.colors import BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION
from app.views.drawing import Curve, Drawing, Marks, Plot, Scene, View
from app.views.legend import Key
from app.views.scales import decades, in_decades, round_up, spanned, upright

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
KEYS = tuple(
    Key(color, "line" if dash == "solid" else "dashed", text) for _, color, text, dash in CURVES
)


def draw(scene: Scene, _kept: None) -> Drawing:
    """Draw what the method knows of itself (dashed), and how far it really is (solid).

    The ghost is run A, or else with separated bases the full linear stage beside them, or else the
    run before.
    """
    run, before = scene.run, scene.before
    has_modes = run.settings.applies("pgd_modes") and not scene.is_paired
    now = run.history.thinned(MOST_POINTS, run.searched)
    keys = KEYS if has_reference(run.settings) else KEYS[:ERRORS]
    past: History | None = before.history if before else None
    if scene.is_paired:
        keys = (*keys, Key(BLUE, "thin", "A"))
    if has_modes:
        past, keys = run.beside, (*keys, Key(BLUE, "thin", "full stage"))
    searched = before.searched if before and past is before.history else None
    ghost = past.thinned(MOST_POINTS, searched) if past is not None else None
    values = [value for name, *_ in CURVES for value in now[name]]
    if ghost is not None:
        values += [value for name, *_ in CURVES[ERRORS:] for value in ghost[name]]
    y = in_decades(*decades([*LEAST_SPAN, *values], FLOOR))
    length = before.iteration if before and not has_modes else 0
    x = spanned(0, round_up(max(run.iteration, length, 20)))
    curves = []
    if ghost is not None:
        curves += [
            Curve(ghost["iteration"], ghost[name], color, 1.2)
            for name, color, _, _ in CURVES[ERRORS:]
        ]
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


VIEW = View(
    "Convergence",
    Plot("Iteration", "Indicator, error", logarithmic="y", whole="x", marks=(ANSWER,)),
    draw,
)
