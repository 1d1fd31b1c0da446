"""Friction force error against run time, for the last runs together."""

from __future__ import annotations

from app.picture.recording import History
from app.picture.shown import has_reference
from app.views.drawing.colors import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from app.views.drawing.drawing import Curve, Drawing, Plot, View
from app.views.drawing.legend import Key
from app.views.drawing.scales import decades, in_decades, upright
from app.views.scene import Scene

PAST_COLORS = (GREEN, VERMILION, PURPLE, SKY, ORANGE, GREY)
FLOOR = 1e-14
MOST_POINTS = 200


def draw(scene: Scene, kept: dict[int, str] | None) -> Drawing:
    """Draw error over the method's own time, set-up included: what settings are compared by.

    A run on separated bases has the full linear stage beside it, on a clock of its own.
    """
    run = scene.run
    twin = scene.before if scene.is_paired else None
    past = [one for one in (*scene.past, twin) if one and len(one.history)][-len(PAST_COLORS) :]
    colors = _colors(kept or {}, [one.ticket for one in past])
    every = [one.history for one in [*past, run]] + [run.beside]
    histories = [one.thinned(MOST_POINTS) for one in every if len(one)]
    times = [one["seconds"][place] for one in histories for place in (0, -1)]
    errors = [0.1, *(error for one in histories for error in one["error_force"])]
    if run.reference is not None:
        times.append(run.reference_seconds)
    x = in_decades(*decades(times, 1e-6))
    low, high = decades(errors, FLOOR)
    y = in_decades(low, max(high, 2.0) if max(errors) > 2.0 else 2.0)
    curves = [_curve(one.history, colors[one.ticket], 2) for one in past]
    keys = [Key(BLUE, "line", "B" if twin else "this run")]
    if run.settings.applies("pgd_modes"):
        keys.append(Key(BLUE, "dashed", "full stage"))
        curves.append(_curve(run.beside, BLUE, 2.5, "dashed"))
    curves.append(_curve(run.history, BLUE, 3))
    keys += [
        Key(colors[one.ticket], "line", "A" if one is twin else one.title) for one in reversed(past)
    ]
    if run.reference is not None:
        keys.append(Key(GREY, "dotted", "incremental"))
        curves.append(upright([run.reference_seconds], y, color=GREY, dash="dotted", width=2))
    return Drawing(x, y, curves, keys=keys, kept=colors)


def _curve(history: History, color: str, width: float, dash: str = "solid") -> Curve:
    found = history.thinned(MOST_POINTS)
    return Curve(found["seconds"], found["error_force"], color, width, dash)


def _colors(given: dict[int, str], tickets: list[int]) -> dict[int, str]:
    """Give every run a color of its own, which it keeps as long as it is drawn."""
    found = {ticket: given[ticket] for ticket in tickets if ticket in given}
    free = [color for color in PAST_COLORS if color not in found.values()]
    new = [ticket for ticket in tickets if ticket not in found]
    return found | dict(zip(new, free, strict=False))


VIEW = View(
    "Error against run time",
    Plot("Run time of the method (s)", "Friction force error", logarithmic="xy"),
    draw,
    has_reference,
)
