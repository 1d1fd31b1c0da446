"""Colours with a meaning, safe for the colour-blind (Okabe and Ito)."""

from __future__ import annotations

from bokeh.palettes import interp_palette

LATIN = "#0072B2"
PRESSURE = "#B0609A"
REFERENCE = "#7A7A7A"
STAGES = {"local": "#D55E00", "linear": LATIN}
"""Colours of the stages of an iteration."""
ERROR = "#D55E00"
DISPLACEMENT = "#009E73"
EXACT = "#56B48C"
GHOST = "#9467BD"
BESIDE = "#B58500"
FORCE = "#D55E00"
STICK = "#8E979F70"
FORWARD = "#E69F00"
BACKWARD = "#0072B2"
OPENED = "#CC79A760"
HALO = "#D55E0066"
"""Colour round the selected interface."""
STATUS = {-1: BACKWARD, 0: STICK, 1: FORWARD, 2: OPENED}
KEYS = {"stick": STICK, "slip →": FORWARD, "slip ←": BACKWARD, "open": OPENED}
"""Colours of the status by its names in legends."""
BODY = "#8FAAC2"
EDGE = "#607D8B"
FLAG = "#00966E"
"""Colour of the known number of a case."""
GROUND = "#A07C4C"
"""Colour of the ground in which the bodies of a case are drawn."""
MACRO = {"above": "#D55E00", "below": "#00795A"}
MICRO = {"above": "#F0A868", "below": "#6CC5A4"}
"""Colours of macro and micro forces on the pieces above, or right, and below joints."""
CUT = "#8A8A8A"
"""Colour of lines where substructures meet."""
HINT = "#37474F"
"""Colour behind the marks of a first visit."""
UNSEEN = "#00000000"
"""Colour of a mark that only carries a text into a legend."""
RANKS = (LATIN, ERROR, DISPLACEMENT, PRESSURE, "#B58500", REFERENCE)
"""Colours of curves side by side, as modes and wires."""
SCALE = (
    "#7A4FB5",
    "#0072B2",
    "#008577",
    "#5C8700",
    "#B07A00",
    "#C24E00",
)
"""Colours from the first to the last of many curves; no end fades into light or
dark."""


def scaled(count: int) -> list[str]:
    """A number of colours, evenly spaced on the colour scale."""
    return list(interp_palette(SCALE, count))
