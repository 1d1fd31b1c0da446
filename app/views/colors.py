"""The colours of plots: Okabe and Ito's, told apart by the colour-blind, and a scale."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

BLUE, ORANGE, GREEN, PURPLE, GREY = "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#8A8A8A"
SKY, VERMILION = "#56B4E9", "#D55E00"
FORCE, GIVEN = "#C24E00", "#A8508A"
"""Of forces and of displacements that are given; words in them can be read on light and dark."""
BACKWARD, STICK, FORWARD, OPEN = BLUE, "#D9D9D9", ORANGE, "#4D4D4D"
VIRIDIS = ("#470e61", "#433d84", "#33628d", "#25828e", "#1fa287", "#42be71", "#91d742", "#d8e219")


def shaded(count: int, palette: Sequence[str] = VIRIDIS) -> list[str]:
    """Give so many colours between those of a palette."""
    anchors = np.array([[int(one[i : i + 2], 16) for i in (1, 3, 5)] for one in palette])
    places = np.linspace(0, len(anchors) - 1, max(count, 2))
    mixed = [np.interp(places, range(len(anchors)), anchors[:, part]) for part in range(3)]
    return [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in np.array(mixed).T.round().astype(int)]
