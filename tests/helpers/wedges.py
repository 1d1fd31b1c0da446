"""Closed forms of a tendon: its elongation, and its wedges that draw in.

EN 1992-1-1, 5.10.5.3.
"""

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


def loss(capstan: Capstan) -> float:
    """Share of the tension that friction takes per length, c = mu a / L, 1/m."""
    return capstan.friction * capstan.angle / capstan.length


def stretched(capstan: Capstan, tension: float, length: float) -> float:
    """Elongation of a length that slips towards an end, and of the span, m.

    `tension` is that of the end, N.
    """
    along = -math.expm1(-loss(capstan) * length) / loss(capstan)
    return tension / capstan.stiffness * (along + capstan.span)


def drawn_in(capstan: Capstan, tension: float, by: float) -> DrawIn:
    """Forces after wedges have drawn in by a length, m.

    Friction turns round on a part of the length alone, and the span of the anchor is
    short.
    """
    lost = loss(capstan)
    share = math.sqrt(capstan.stiffness * lost * by / tension)
    assert share < -math.expm1(-lost * capstan.length)
    length = -math.log1p(-share) / lost
    left = 1.0 - share
    return DrawIn(length, tension * left, tension * left**2)
