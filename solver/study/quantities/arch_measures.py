"""Quantities of arches and of blocks with joints: thrust, hinges, limits."""

from __future__ import annotations

import math
from collections.abc import Callable
from operator import attrgetter

import numpy as np

from solver.arrays import Flags
from solver.discrete import discretise
from solver.discrete.plane.makers.voussoirs import LIVE, Arch
from solver.laws import OPEN, Contact
from solver.reference.closed_forms.arch import VoussoirArch
from solver.reference.limit_analysis import load_factors
from solver.settings.scene import Settings
from solver.study.quantities.body_measures import AT, instant_at
from solver.study.quantities.finished import FinishedRun
from solver.study.quantities.quantity import quantity

_statics = attrgetter("statics")
"""Statics of the settings of an arch as rigid voussoirs."""


def _is_arch(settings: Settings) -> bool:
    return settings.scene == "arch"


def _instant(run: FinishedRun, at: float | None) -> int:
    """Instant at a share of the interval, or the last one."""
    if at is None:
        return run.problem.n_instants - 1
    return instant_at(run, at)


@quantity("Thrust over weight", parameter=AT, applies=_is_arch)
def thrust(run: FinishedRun, at: float | None) -> float:
    """Horizontal thrust over the weight, at the end or at a share of the time."""
    instant = _instant(run, at)
    structure = run.settings.structure()
    assert isinstance(structure, Arch)
    weight = float(structure.downwards[instant])
    if weight == 0.0:
        return math.nan
    return float(run.force[instant]) / weight


def _weighs_alone(settings: Settings) -> bool:
    """Check whether an arch carries its weight and a fill by the friction mu N."""
    return (
        _is_arch(settings)
        and settings.law.is_by_pressure_alone
        and settings.has("unit_weight")
        and not settings.has("live")
    )


@quantity("Least thickness that stands, over radius", applies=_weighs_alone)
def thinnest(run: FinishedRun) -> float:
    """Thickness over the mean radius below which nothing balances the weight.

    Of rigid voussoirs, by statics; nan where no thickness stands.
    """
    return _limit(run.settings, VoussoirArch.thinnest)


@quantity("Least friction that holds the arch", applies=_weighs_alone)
def least_friction(run: FinishedRun) -> float:
    """Coefficient of friction below which nothing balances the weight.

    Of rigid voussoirs, by statics; nan where no friction holds the arch.
    """
    return _limit(run.settings, VoussoirArch.least_friction)


def _limit(
    settings: Settings, limit_of: Callable[[VoussoirArch], float | None]
) -> float:
    """Limit of an arch by its statics; NaN without one."""
    limit = limit_of(_statics(settings))
    if limit is None:
        return math.nan
    return limit


@quantity(
    "Joints that are hinges", parameter=AT, applies=lambda settings: settings.has_joints
)
def hinges(run: FinishedRun, at: float | None) -> float:
    """Number of hinges: joints that touch at one edge only.

    At the end of the run, or at a share of the interval.
    """
    instant = _instant(run, at)
    count = 0
    for law, _, points, _ in run.problem.contacts.stacks:
        touches = run.iterate.status[points, instant, None] != OPEN
        count += int(np.count_nonzero(are_hinges(law, touches)))
    return float(count)


def are_hinges(law: Contact, touches: Flags) -> Flags:
    """Mask of joints of a law that touch at one edge only, (n_joints, n_instants).

    `touches` says at which points there is contact, (n_points, n_instants).
    """
    firsts = np.cumsum(law.sizes) - law.sizes
    lasts = firsts + law.sizes - 1
    touching = np.add.reduceat(touches.astype(np.intp), firsts)
    is_at_edge = touches[firsts] | touches[lasts]
    has_edges = (law.sizes > 1)[:, None]
    return np.asarray((touching == 1) & is_at_edge & has_edges)


@quantity(
    "Limit of the load on the back, over the load",
    applies=lambda settings: _is_arch(settings) and settings.has("live"),
)
def live_factor(run: FinishedRun) -> float:
    """Smallest factor on the load on the back at which the arch collapses.

    At the worst place of its way, by limit analysis.
    """
    structure = run.settings.structure()
    assert isinstance(structure, Arch)
    unloaded = discretise(structure.without(LIVE))
    return float(load_factors(run.problem, unloaded).min())
