"""Marks in the picture on a first visit: the pull, the friction, and the solver."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.views.picture import Columns, Picture
from solver.discrete.structure import Act

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
    """Columns of the marks on a picture; the pull is the load that varies most."""
    layout = picture.layout
    length, top = layout.size * layout.scale
    texts = [SOLVER]
    aligns = ["left"]
    anchors = [np.array([ASIDE - 0.5 * length, 0.5 * top])]
    if picture.draggable:
        driving = max(picture.draggable, key=_change)
        x = float(driving.points[:, 0].mean())
        text = f"↖ {_word_of(driving.act)}"
        # It ends within the picture.
        right = layout.canvas.width - layout.origin[0]
        begin = right - layout.letter * len(text) - PADDING
        texts.append(text)
        anchors.append(np.array([min(x + ASIDE, begin), 0.5 * top - UNDER]))
        aligns.append("left")
    texts.append(RUBS)
    aligns.append("center")
    rubbing = np.array([(RUBBING - 0.5) * length, np.nanmin(picture.points[:, 1])])
    if layout.description.footings is not None:
        # Bodies of any shape may touch nowhere below.
        rubbing = picture.points[int(RUBBING * len(picture.points))]
    anchors.append(rubbing - [0.0, BELOW])
    x, y = picture.page(np.array(anchors)).T
    return {"x": x, "y": y, "text": texts, "text_align": aligns}


def _word_of(act: Act) -> str:
    """Word for what a load does throughout its path, where it acts."""
    if act.unit in ("m", "1/m"):
        return "moved here"
    low = float(act.values.min())
    high = float(act.values.max())
    if low < 0.0 < high:
        return "pulled to and fro"
    outward = float(np.dot(np.reshape(act.towards, (-1, 2))[0], act.away))
    if outward * (low + high) < 0.0:
        return "pushed here"
    return "pulled here"


def _change(arrows: Any) -> float:
    """Largest change of a load through time over its largest size."""
    values = np.abs(arrows.act.values).max() or 1.0
    return float(np.ptp(arrows.act.values, axis=-1).max() / values)
