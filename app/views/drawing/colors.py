"""The colours of plots, told apart by the colour-blind, and scales.

They are Okabe and Ito's; the bright ones are darker, so that a line is seen on light and dark.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

BLUE, ORANGE, GREEN, PURPLE, GREY = "#0072B2", "#B58500", "#009E73", "#CC79A7", "#8A8A8A"
SKY, VERMILION = "#2B93CC", "#D55E00"
GHOST = "#9467BD"
"""Of what a run is compared with."""
FORCE, GIVEN = "#C24E00", "#A8508A"
"""Of forces and of displacements that are given."""
BACKWARD, STICK, FORWARD, OPEN = BLUE, "#D9D9D9", "#E69F00", "#4D4D4D"
SLIP = "Blue slips one way, orange the other."
"""What these mean, in a sentence."""
FRONT = "#000000"
"""Of lines on these."""
VIRIDIS = ("#470e61", "#433d84", "#33628d", "#25828e", "#1fa287", "#42be71", "#91d742", "#d8e219")
LINES = ("#7a4fb5", BLUE, "#008577", "#5c8700", "#b07a00", FORCE)
"""As a scale of curves: no end of it fades into light or dark."""


def shaded(count: int, palette: Sequence[str] = VIRIDIS) -> list[str]:
    """Give so many colours between those of a palette."""
    anchors = np.array([[int(one[i : i + 2], 16) for i in (1, 3, 5)] for one in palette])
    places = np.linspace(0, len(anchors) - 1, max(count, 2))
    mixed = [np.interp(places, range(len(anchors)), anchors[:, part]) for part in range(3)]
    return [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in np.array(mixed).T.round().astype(int)]
