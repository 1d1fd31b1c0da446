"""What sweeps ask of a run whose load repeats itself; NaN with fewer cycles than that takes."""

from __future__ import annotations

import math

import numpy as np

from solver.arrays import RESIDUE
from solver.laws import OPEN
from solver.reference.condensation import NoReferenceError
from solver.reference.shakedown import largest_swing, shakedown_limit, slip_space
from solver.scenes import kind_of, structure_of
from solver.settings import Settings
from solver.study.quantities.cycles import cycles_in, cycles_of, ends_of
from solver.study.quantities.finished import FinishedRun
from solver.study.quantities.quantity import Quantity

NO_ENERGY = 1e-12
"""Share of all energy that rounding makes."""


def has_cycles(settings: Settings) -> bool:
    """Tell whether a load has a cycle."""
    return cycles_in(settings) > 0


def has_several(settings: Settings) -> bool:
    """Tell whether a load has a second cycle, to compare others with."""
    return cycles_in(settings) > 1


def has_a_limit(settings: Settings) -> bool:
    """Tell whether slip that stays is known: of rods, and in the plane of closed contacts."""
    if not has_cycles(settings) or settings.applies("friction_ratio"):
        return False
    return kind_of(settings) != "plane" or _may_stay_closed(settings)


def _may_stay_closed(settings: Settings) -> bool:
    """Tell whether surfaces rub by Coulomb's law that are closed as long as something presses."""
    if not settings.opens or settings.has_spring or settings.applies("contact_stiffness"):
        return False
    holds = structure_of(settings).described().holds
    gaps = [hold.gap for hold in holds if hold.gap is not None]
    return settings.values()["friction"] != 0.0 and not np.any(gaps)


def energy_ratio(run: FinishedRun, at: float | None) -> float:
    """Give the energy of the last cycle over that of the second; NaN where that took none."""
    energy = cycles_of(run.settings, run.iterate).energy
    if len(energy) < 2 or energy[1] <= NO_ENERGY * np.abs(run.dissipated).sum():
        return math.nan
    return float(energy[-1] / energy[1])


def ratchet(run: FinishedRun, at: float | None) -> float:
    """Give the slip that the last cycle leaves, at the point where it leaves most, m."""
    cycles = cycles_of(run.settings, run.iterate)
    if not cycles.net.size:
        return math.nan
    left = np.abs(cycles.net[:, -1]).max()
    return float(left) if left > RESIDUE * cycles.slip.max() else 0.0


def sliding_share(run: FinishedRun, at: float | None) -> float:
    """Give the largest share of the contact that slips at once in the last cycle, by length.

    0 is stick, 1 gross slip, anything between partial slip (O. Vingsbo, S. Söderberg, On fretting
    maps, Wear 126, 1988). A point that a clamp holds never slips, and is left out.
    """
    ends = ends_of(run.settings)
    if len(ends) < 2:
        return math.nan
    last, held = slice(ends[-2] + 1, ends[-1] + 1), run.problem.is_held
    lengths = [
        law.by_point(law.weights * ~np.all([held[rows] for rows in law.tangent.sides], axis=0))
        for law in run.problem.rubbing.values()
    ]
    length, status = np.concatenate(lengths)[:, None], run.iterate.status[:, last]
    touching = (length * (status != OPEN)).sum(axis=0)
    slipping = (length * (np.abs(status) == 1)).sum(axis=0)
    shares = slipping[touching > 0.0] / touching[touching > 0.0]
    return float(shares.max(initial=0.0))


def shakedown_factor(run: FinishedRun, at: float | None) -> float:
    """Give the largest factor on the swing of the loads under which there is slip that stays.

    The swing is about the mean of the last cycle, as often as one likes. On rods the mean does not
    matter, so that it is the factor on all loads, too, and slip ceases below it wherever it began.
    In the plane all contacts have to stay closed; below it slip may cease, or not, by its start,
    where slip changes what presses. Above it something slips, or opens, in every cycle.

    NaN where none is known, or not even the mean keeps all contacts closed.
    """
    ends = ends_of(run.settings)
    if len(ends) < 2 or not has_a_limit(run.settings):
        return math.nan
    last = slice(ends[-2], ends[-1] + 1)
    try:
        if run.problem.opens:
            return largest_swing(slip_space(run.problem), last)[0]
        return shakedown_limit(run.problem, last)
    except NoReferenceError:
        return math.nan


OF_CYCLES = (
    Quantity(
        "cycle_energy_ratio",
        "Energy of the last cycle over the second",
        "",
        energy_ratio,
        applies=has_several,
    ),
    Quantity("ratchet", "Slip that the last cycle leaves", "m", ratchet, applies=has_cycles),
    Quantity(
        "sliding_share",
        "Share of the contact that slips at once in the last cycle",
        "",
        sliding_share,
        is_share=True,
        applies=has_cycles,
    ),
    Quantity(
        "shakedown_factor",
        "Shakedown factor on the swing of the load",
        "",
        shakedown_factor,
        applies=has_a_limit,
    ),
)
"""Quantities of cycles."""
