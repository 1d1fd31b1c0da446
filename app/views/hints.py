"""Marks in the picture on a first visit: the pull, the friction, and the solver."""

from __future__ import annotations

import numpy as np

from app.views.picture import Columns, Picture

PULLED = "↖ pulled to and fro"
RUBS = "↑ rubs here"
SOLVER = "the solver corrects a guess\nof the whole motion"
ASIDE = 8.0
UNDER = 38.0
BELOW = 26.0
"""Distances of marks from a side of the bodies, under an arrow, and below the contact,
px."""
PADDING = 10.0
"""Width of a mark beside its text, px."""
RUBBING = 0.55
"""Place of the mark of friction, over the length."""
NONE: Columns = {"x": [], "y": [], "text": [], "text_align": []}


def hints_of(picture: Picture) -> Columns:
    """Columns of the marks on a picture of the bar with which every visit begins.

    An address with settings is no first visit, and a changed setting ends it.
    """
    layout = picture.layout
    length, top = layout.size * layout.scale
    # The mark of the pull ends within the picture.
    right = layout.canvas.width - layout.origin[0]
    begin = right - layout.letter * len(PULLED) - PADDING
    end = float(picture.arrows[0].points[0, 0])
    solved = [ASIDE - 0.5 * length, 0.5 * top]
    pulled = [min(end + ASIDE, begin), 0.5 * top - UNDER]
    rubbed = [(RUBBING - 0.5) * length, picture.points[:, 1].min() - BELOW]
    x, y = picture.page(np.array([solved, pulled, rubbed])).T
    return {
        "x": x,
        "y": y,
        "text": [SOLVER, PULLED, RUBS],
        "text_align": ["left", "left", "center"],
    }
