"""What contacts and bodies are asked for beside their motion: pressure, extent, stick, stress."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.discrete.elements import von_mises
from solver.laws import OPEN
from solver.study.finished import FinishedRun
from solver.study.measures import largest_load


def peak_pressure(run: FinishedRun, at: float | None) -> float:
    """Give the largest pressure at any point of an interface, Pa; NaN where it is given.

    Force of a point over its tributary length, one metre thick. A single point, as that under a
    spring, has a force and no pressure.
    """
    found = [
        float((normal / length[:, None]).max())
        for name, length in _extended(run).items()
        if (normal := run.iterate.contact(name).normal_force) is not None
    ]
    return max(found, default=math.nan)


def contact_width(run: FinishedRun, at: float | None) -> float:
    """Give the largest length over which bodies touch at once, m; NaN where they always do."""
    return max(_contact_width_at(run, instant) for instant in range(run.problem.n_instants))


def stuck_share(run: FinishedRun, at: float | None) -> float:
    """Give the share of what touches that sticks at the largest load."""
    return stuck_share_at(run, largest_load(run))


def stuck_share_at(run: FinishedRun, instant: int) -> float:
    """Give the share of what touches that sticks at an instant, by length; NaN if nothing does."""
    length, status = _touching(run, instant)
    touching = length[status != OPEN].sum()
    return float(length[status == 0].sum() / touching) if touching else math.nan


def peak_stress(run: FinishedRun, at: float | None) -> float:
    """Give the largest von Mises stress at the centre of an element at any instant, Pa; or NaN."""
    inside, values = run.problem.inside, run.settings.values()
    if inside is None:
        return math.nan
    largest = 0.0
    for instant in range(run.problem.n_instants):
        moved = inside.displacement(run.iterate.displacement, [instant])[:, :, 0]
        stress = von_mises(inside.stress(moved), values["poisson"], values["plane"])
        largest = max(largest, float(stress.max()))
    return largest


def spring_force(run: FinishedRun, at: float | None) -> float:
    """Give the largest force in the spring, N; NaN without one."""
    return float(run.force.max()) if run.settings.has_spring else math.nan


def _contact_width_at(run: FinishedRun, instant: int) -> float:
    """Give the length over which bodies touch at an instant, m; NaN where they always do."""
    if run.problem.inside is None:
        return math.nan
    length, status = _touching(run, instant)
    return float(length[status != OPEN].sum())


def _extended(run: FinishedRun) -> dict[str, Array]:
    """Give the tributary lengths of all interfaces that are more than a point, m."""
    lengths = {name: law.by_point(law.weights) for name, law in run.problem.rubbing.items()}
    return {name: length for name, length in lengths.items() if len(length) > 1}


def _touching(run: FinishedRun, instant: int) -> tuple[Array, NDArray[np.int8]]:
    """Give length and status of the points of these interfaces, one interface after the other."""
    lengths = _extended(run)
    status = [run.iterate.contact(name).status[:, instant] for name in lengths]
    return np.concatenate(list(lengths.values())), np.concatenate(status)
