"""The last runs beside the one at work: how far each was, and what was other in it."""

from __future__ import annotations

import numpy as np

from app.picture.labels import changes_of
from app.picture.recording import Recording
from app.views.drawing.colors import GHOST, GREY, LINES
from app.views.drawing.drawing import Curve
from app.views.drawing.legend import Key
from app.views.scene import Scene

MOST = 3
COLORS = (GREY, LINES[3], GHOST)
MOST_POINTS = 200
THIN = 1.5


def ghosts_of(scene: Scene) -> list[Recording]:
    """Give the last runs of other settings than those of the run at work, oldest first."""
    found: dict[str, Recording] = {}
    for one in scene.past:
        if len(one.history) and changes_of(one.settings, scene.run.settings):
            name = called(one, scene.run)
            # The newest run of each name is the one that stays.
            found.pop(name, None)
            found[name] = one
    return list(found.values())[-MOST:]


def called(one: Recording, run: Recording) -> str:
    """Name a run by what is other in it than in the run at work, if that is k; or as it is."""
    if set(changes_of(one.settings, run.settings)) == {"k_scale"}:
        return f"k × {one.settings.k_scale:.3g}"
    return one.title


def drawn(scene: Scene, column: str) -> tuple[list[Curve], list[Key]]:
    """Draw one column of their histories, thin, over iterations."""
    curves, keys = [], []
    ghosts = ghosts_of(scene)
    for one, color in zip(ghosts, COLORS[-len(ghosts) :], strict=False):
        found = one.history.thinned(MOST_POINTS, one.searched)
        known = np.isfinite(found[column])
        values = found["iteration"][known], found[column][known]
        curves.append(Curve(*values, color, THIN))
        keys.append(Key(color, "thin", called(one, scene.run)))
    return curves, keys
