"""Singular values of the friction force in every substructure, and those of a separated basis."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.views.drawing.colors import GREY, LINES, VERMILION, shaded
from app.views.drawing.drawing import Colors, Curve, Drawing, Marks, Plot, View, has_instants
from app.views.drawing.legend import Key
from app.views.drawing.scales import decades, in_decades, round_up, spanned
from app.views.scene import Scene
from solver.phrases import Phrase

FLOOR = 1e-8
LEAST = 1e-30
CROSS, RING = Marks((), (), GREY, "cross"), Marks((), (), VERMILION, "ring")


def draw(scene: Scene, _kept: None) -> Drawing:
    """Draw how fast the singular values fall, each over the largest of all.

    Rings are the sizes of the chosen separated basis's modes; crosses are the singular values of
    the field that it has to hold.
    """
    spectra, bases = scene.frame.spectra, scene.frame.bases
    count, width = spectra.shape
    total = scene.run.settings.n_substructures
    numbers = np.linspace(1, total, count).round().astype(int)
    largest = float(np.nanmax(spectra, initial=0.0)) or 1.0
    scaled = np.maximum(spectra / largest, LEAST)
    modes = np.arange(1, width + 1)
    curves = [
        Curve(modes, values, color, name=str(number))
        for values, color, number in zip(scaled, shaded(count, LINES), numbers, strict=False)
    ]
    marks: tuple[Marks, ...] = ()
    keys: tuple[Key, ...] = ()
    more = np.zeros(0, np.float32)
    if bases is not None:
        own, more = bases.values
        marks = (_sizes(more, CROSS), _sizes(own, RING))
        keys = (
            Key(VERMILION, "ring", Phrase("PGD, sub. {}", bases.substructure + 1)),
            Key(GREY, "cross", "its field"),
        )
    low, _ = decades([*scaled.ravel(), *more], FLOOR)
    return Drawing(
        spanned(0.5, round_up(max(width, len(more))) + 0.5),
        in_decades(low, 2.0),
        curves,
        marks,
        colors=Colors(1, max(total, 2)),
        keys=keys,
    )


def _sizes(values: np.ndarray, kind: Marks) -> Marks:
    return replace(kind, x=np.arange(1, len(values) + 1), y=np.maximum(values, LEAST))


VIEW = View(
    "Singular values",
    Plot(
        "Mode n",
        "Size / largest",
        logarithmic="y",
        palette=LINES,
        scale="substructure",
        marks=(CROSS, RING),
        names="substructure",
    ),
    draw,
    has_instants,
)
