"""What contacts and bodies are asked for beside their motion: pressure, extent, stick, stress."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.discrete.elements import von_mises
from solver.laws import OPEN
from solver.scenes import kind_of
from solver.settings import Settings
from solver.study.quantities.finished import FinishedRun
from solver.study.quantities.measures import largest_load
from solver.study.quantities.quantity import Quantity


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
    return _peak_stress(run)[0]


def peak_stress_x(run: FinishedRun, at: float | None) -> float:
    """Give where that is along the body, m; NaN without stress."""
    return float(_peak_stress(run)[1][0])


def peak_stress_y(run: FinishedRun, at: float | None) -> float:
    """Give how high above the lowest side that is, m; NaN without stress."""
    return float(_peak_stress(run)[1][1])


def _peak_stress(run: FinishedRun) -> tuple[float, Array]:
    """Give the largest von Mises stress, Pa, and the centre of the element that has it first, m."""
    inside, values = run.problem.inside, run.settings.values()
    nowhere = np.full(2, np.nan)
    if inside is None:
        return math.nan, nowhere
    largest, place = 0.0, nowhere
    for instant in range(run.problem.n_instants):
        moved = inside.displacement(run.iterate.displacement, [instant])[:, :, 0]
        stress = von_mises(inside.stress(moved), values["poisson"], values["plane"])
        element = int(stress.argmax())
        if stress[element] > largest:
            largest = float(stress[element])
            place = inside.nodes[inside.elements[element]].mean(axis=0)
    return largest, place


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


def _has_stress(settings: Settings) -> bool:
    return kind_of(settings) == "plane"


OF_STRESS = (
    Quantity("peak_stress", "Largest von Mises stress", "Pa", peak_stress, applies=_has_stress),
    Quantity("peak_stress_x", "x of the largest stress", "m", peak_stress_x, applies=_has_stress),
    Quantity("peak_stress_y", "y of the largest stress", "m", peak_stress_y, applies=_has_stress),
)
