"""Quantities of arches and of blocks with joints: thrust, hinges, limit of a load."""

from __future__ import annotations

import math

import numpy as np

from solver.arrays import Array
from solver.discrete.contacts import Stacked
from solver.discrete.plane.voussoirs import Arch
from solver.laws import OPEN
from solver.reference.limit_analysis import load_factors
from solver.scenes import discretise
from solver.settings.scene import Settings
from solver.study.quantities.contact_measures import AT, instant_at
from solver.study.quantities.finished import FinishedRun
from solver.study.quantities.quantity import quantity

EDGE = 0.1
"""Largest distance of a resultant from the edge of a joint that is a hinge there, over
the length of the joint."""


def _is_arch(settings: Settings) -> bool:
    return settings.scene == "arch"


def _instant(run: FinishedRun, at: float | None) -> int:
    """Instant at a share of the interval, or the last one."""
    if at is None:
        return run.problem.n_instants - 1
    return instant_at(run, at)


@quantity("Thrust over weight", parameter=AT, applies=_is_arch)
def thrust(run: FinishedRun, at: float | None) -> float:
    """Horizontal thrust over all that weighs, at the end or at a share of the time."""
    instant = _instant(run, at)
    structure = run.settings.structure()
    assert isinstance(structure, Arch)
    weight = float(structure.downwards[instant])
    if weight == 0.0:
        return math.nan
    return float(run.force[instant]) / weight


@quantity(
    "Number of hinges", parameter=AT, applies=lambda settings: settings.has_joints
)
def hinges(run: FinishedRun, at: float | None) -> float:
    """Joints that are open at one edge, with the resultant at the other.

    At the end of the run, or at a share of the interval.
    """
    instant = _instant(run, at)
    count = 0
    for stacked in run.problem.rubbing.stacks:
        pressing = run.iterate.contact_force[stacked.forces[0], instant]
        status = run.iterate.status[stacked.points, instant]
        count += _hinges_of(stacked, np.maximum(pressing, 0.0), status == OPEN)
    return float(count)


def _hinges_of(stacked: Stacked, pressing: Array, is_open: Array) -> int:
    """Number of the joints of a law that are hinges.

    From the pressing forces of all points, N, and whether they are open, (n_points,).
    """
    law = stacked.law
    firsts = np.cumsum(law.sizes) - law.sizes
    lasts = firsts + law.sizes - 1
    positions = law.positions
    whole = np.add.reduceat(pressing, firsts)
    moment = np.add.reduceat(pressing * positions, firsts)
    # Joints without any force are no hinges.
    resultant = moment / np.where(whole > 0.0, whole, np.nan)
    lengths = positions[lasts] - positions[firsts]
    from_first = (resultant - positions[firsts]) / lengths
    at_first = is_open[lasts] & (from_first <= EDGE)
    at_last = is_open[firsts] & (from_first >= 1.0 - EDGE)
    return int(np.count_nonzero(at_first | at_last))


@quantity(
    "Limit of the load on the back, over the load",
    applies=lambda settings: _is_arch(settings) and settings.has("live"),
)
def live_factor(run: FinishedRun) -> float:
    """Smallest factor on the load on the back for which no forces balance it.

    At the worst place of its way, by limit analysis.
    """
    unloaded = discretise(run.settings.replace(live=0.0, live_load="hold"))
    return float(load_factors(run.problem, unloaded).min())
