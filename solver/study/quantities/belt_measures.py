"""Quantities of a band on a guide: ratio of tensions, torque on a drum, and creep."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array, without_residue
from solver.discrete.plane.makers.band import Band
from solver.settings.scene import Settings
from solver.study.quantities.body_measures import AT, instant_at
from solver.study.quantities.finished import FinishedRun, first_largest
from solver.study.quantities.quantity import quantity

SLACK = 1e-6
"""Tension over the largest one of a run below which a band is slack."""


def _is_belt(settings: Settings) -> bool:
    return settings.scene == "belt"


def _is_drum(settings: Settings) -> bool:
    return _is_belt(settings) and settings.values()["guide"] == "drum"


def _band(run: FinishedRun) -> Band:
    """Structure of the settings of a band on a guide."""
    band = run.settings.structure()
    assert isinstance(band, Band)
    return band


def _ends(run: FinishedRun) -> tuple[Array, Array]:
    """Tensions of the tail and of the pulled end, (n_instants,) each, N."""
    tensions = _band(run).tensions(run.problem, run.iterate)
    return tensions[0], tensions[-1]


def _carried(run: FinishedRun) -> Array:
    """Tension that the drum carries, T2 - T1, (n_instants,), N; 0 where it is rounding.

    Tensions are differences of displacements, which ends that are pulled alike share.
    """
    tail, pulled = _ends(run)
    values = run.settings.values()
    stretched = np.abs(run.iterate.displacement).max() / _band(run).guide.spacing
    terms = values["young"] * values["section"] * stretched
    return without_residue(pulled - tail, terms)


def _largest(run: FinishedRun, values: Array, at: float | None) -> float:
    """Value at a share of the interval, else the largest in size, of (n_instants,)."""
    if at is not None:
        return float(values[instant_at(run, at)])
    return float(values[first_largest(np.abs(values))])


@quantity("Tension of the pulled end over the tail's", parameter=AT, applies=_is_belt)
def tension_ratio(run: FinishedRun, at: float | None) -> float:
    """Largest ratio of both tensions, or that at a share of the interval.

    0 while the tail is slack.
    """
    tail, pulled = _ends(run)
    ratio = np.zeros_like(tail)
    is_tight = tail > SLACK * max(tail.max(), pulled.max())
    np.divide(pulled, tail, out=ratio, where=is_tight)
    return _largest(run, ratio, at)


@quantity("Torque on the drum", "N·m", parameter=AT, applies=_is_drum)
def torque(run: FinishedRun, at: float | None) -> float:
    """Torque (T2 - T1) R of the band on the drum, of largest size, N m."""
    radius = run.settings.values()["drum_radius"]
    return _largest(run, _carried(run) * radius, at)


@quantity("Creep of a belt that runs on", parameter=AT, applies=_is_drum)
def creep(run: FinishedRun, at: float | None) -> float:
    """Creep of largest size, or at a share of the interval.

    Share by which a belt that runs over a turning drum with these tensions leaves it
    slower than it comes, (T2 - T1) / (E A): as much of it passes both ends, stretched
    by more and by less (K. L. Johnson, Contact Mechanics, 1985, 8.3).
    """
    values = run.settings.values()
    return _largest(run, _carried(run) / (values["young"] * values["section"]), at)
