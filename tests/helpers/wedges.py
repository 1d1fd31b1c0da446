"""Closed form of a tendon whose wedges draw in (EN 1992-1-1, 5.10.5.3)."""

from __future__ import annotations

import math
from typing import NamedTuple

from solver.reference.closed_forms.belt import Capstan


class DrawIn(NamedTuple):
    """Forces of a tendon after its wedges have drawn in.

    Attributes
    ----------
    length
        Length from the anchor over which friction has turned round, m.
    largest, at_anchor
        Largest force, at the end of that length, and force at the anchor, N.
    """

    length: float
    largest: float
    at_anchor: float


def drawn_in(capstan: Capstan, tension: float, by: float) -> DrawIn:
    """Forces after wedges have drawn in by a length, m.

    Friction turns round on a part of the length alone, and the span of the anchor is
    short.
    """
    share = math.sqrt(capstan.stiffness * capstan.loss * by / tension)
    assert share < -math.expm1(-capstan.loss * capstan.length)
    length = -math.log1p(-share) / capstan.loss
    left = 1.0 - share
    return DrawIn(length, tension * left, tension * left**2)
