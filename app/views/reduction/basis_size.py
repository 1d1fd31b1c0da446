"""How many modes every substructure's separated basis holds, over the iterations."""

from __future__ import annotations

import numpy as np

from app.views.drawing.colors import VERMILION, VIRIDIS
from app.views.drawing.drawing import Colors, Drawing, Image, Plot, View
from app.views.drawing.legend import Key
from app.views.drawing.scales import across, round_up, spanned, upright
from app.views.scene import Scene

MOST_COLUMNS = 240
"""Iterations that are drawn at most; a small plot has no more pixels."""


def draw(scene: Scene, _kept: None) -> Drawing | None:
    """Draw the numbers of modes of all iterations done as a map."""
    run, frame = scene.run, scene.frame
    if not run.sizes or frame.bases is None:
        return None
    done, total = len(run.sizes), run.settings.n_substructures
    columns = np.linspace(0, done - 1, min(done, MOST_COLUMNS)).round().astype(int)
    sizes = np.stack([run.sizes[column] for column in columns], axis=1)
    most = max(int(sizes.max()), 2)
    x, y = spanned(0, round_up(max(done, 20))), spanned(0.5, total + 0.5)
    return Drawing(
        x,
        y,
        [
            across([frame.bases.substructure + 1], x, color=VERMILION, width=2),
            upright([frame.iteration], y, color=VERMILION, width=1),
        ],
        image=Image(sizes.astype(np.float32), 0.5, 0.5, done, total),
        colors=Colors(0, most),
        keys=(Key(VERMILION, "line", "chosen"),),
    )


VIEW = View(
    "PGD basis size",
    Plot(
        "Iteration",
        "Substructure",
        palette=VIRIDIS,
        scale="modes",
        chooses="substructure",
        whole="y",
    ),
    draw,
    lambda settings: settings.applies("pgd_modes"),
)
