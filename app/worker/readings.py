"""Quantities of the iterate that is shown, in words, as sentences of a lesson hold them."""

from __future__ import annotations

import math

from app.picture.units import BY_SIZE, measured
from app.views.scene import Scene
from app.worker.words import number, percent
from solver.latin import Solution
from solver.latin.criteria.status import CANCELLED
from solver.phrases import Phrase
from solver.study.quantities.finished import FinishedRun
from solver.study.quantities.quantities import reading
from solver.study.quantities.quantity import Quantity

OPEN = "…"
"""What only the rest of the run will tell."""
NONE = "–"


def values(scene: Scene) -> list[tuple[str, str]]:
    """Give name and text (HTML) of every quantity that is looked at.

    The run is taken as far as the iterate that is shown, and no further. The first iterate is shown
    before there is a record of it.
    """
    run, iterate = scene.run, scene.frame.iterate
    if iterate.number > len(run.history):
        return [(name, OPEN) for name in scene.look.readings]
    is_final = run.status is not None and iterate.number == run.iteration
    solution = Solution(iterate, run.history.records(iterate.number), run.status or CANCELLED)
    loop, has_errors = scene.frame.sampler.loop, run.reference is not None
    so_far = FinishedRun(run.settings, solution, has_errors, loop)
    found = []
    for name in scene.look.readings:
        asked = reading(name)
        value = asked(so_far)
        known = is_final or math.isfinite(value)
        text = written(value, asked.quantity, iterate.number, scene.look.units) if known else OPEN
        found.append((name, scene.look.say(text)))
    return found


def written(value: float, quantity: Quantity, done: int, units: str = BY_SIZE) -> str:
    """Write a quantity of a run of so many iterations with its unit (HTML)."""
    if math.isnan(value):
        return NONE
    if math.isinf(value):
        # All that is counted and may never come are iterations.
        return "not reached" if quantity.unit else Phrase("more than {}", done)
    if quantity.is_share:
        return percent(value)
    return measured(value, quantity.unit, units) if quantity.unit else number(value)
