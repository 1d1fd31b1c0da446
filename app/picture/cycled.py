"""The cycles of a load as views see them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.picture.shown import Floats, floats
from solver.arrays import Array
from solver.latin import Iterate
from solver.settings import Settings
from solver.study.quantities.cycles import cycles_of
from solver.study.quantities.shakedown import Fate, fate_of


@dataclass(frozen=True)
class Cycled:
    """An iterate, cycle by cycle.

    Attributes
    ----------
    fate
        What becomes of slip, where that is settled.
    slips
        Whether anything slips at any instant.
    times
        At which cycles begin, and the last one ends, shape (n_cycles + 1,), s.
    energy
        What friction takes in each, shape (n_cycles,), J.
    slip, work
        Of the last one, at the positions of the interface, shape (n_positions,): slip to and fro,
        m, and friction work, J/m, or J/m^2 of bodies in the plane.
    """

    fate: Fate | None
    slips: bool
    times: Floats
    energy: Floats
    slip: Floats
    work: Floats


def cycled(
    settings: Settings, iterate: Iterate, points: slice, rows: NDArray[np.intp], lengths: Array
) -> Cycled:
    """Cut an iterate into the cycles of its load.

    Parameters
    ----------
    settings, iterate
        Of a load that has cycles.
    points, rows
        Those of an interface among all points, and those that are drawn among them.
    lengths
        Tributary lengths of the latter, m.
    """
    found = cycles_of(settings, iterate)
    return Cycled(
        fate_of(found),
        bool(found.slip.any() or found.before.any()),
        floats(iterate.problem.instants[found.ends]),
        floats(found.energy),
        floats(found.slip[points, -1][rows]),
        floats(found.work[points, -1][rows] / lengths),
    )
