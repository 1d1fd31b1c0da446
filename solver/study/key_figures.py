"""What a person wants of a run first: its loop at an instant, what slips there, what is lost."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.laws import OPEN
from solver.study.quantities.contact_measures import largest_load
from solver.study.quantities.finished import FinishedRun

ZERO = 1e-9
"""Share of the largest value in the run below which one is zero."""


@dataclass(frozen=True)
class KeyFigure:
    """A number of a run at an instant, in SI, by the names of scripts and of people.

    The unit is empty for a share, and chosen by the size of the largest value in the run.
    """

    name: str
    title: str
    value: float
    unit: str
    largest: float


def key_figures(
    axes: tuple[tuple[str, str], tuple[str, str]],
    loop: Iterable[NDArray[Any]],
    status: NDArray[np.int8],
    energy: float,
    instant: int,
) -> list[KeyFigure]:
    """Key figures at an instant.

    Of the axes of the loop and both of its sides, shape (2, n_instants), the status of all contact
    points, shape (n_points, n_instants), and the energy that friction takes in the whole run, J.
    """
    figures = []
    for name, (title, unit), values in zip(("displacement", "force"), axes, loop, strict=True):
        largest, value = float(np.abs(values).max()), float(values[instant])
        value = value if abs(value) > ZERO * largest else 0.0
        figures.append(KeyFigure(name, title, value, unit, largest))
    now = status[:, instant]
    slipping = float(np.mean((now != 0) & (now != OPEN))) if len(now) else 0.0
    figures.append(KeyFigure("slipping", "Slips", slipping, "", 1.0))
    return [*figures, KeyFigure("energy", "Energy lost", energy, "J", abs(energy))]


def figures_of(run: FinishedRun) -> tuple[list[KeyFigure], float]:
    """Key figures of a run where its force first is largest, and when that is, s."""
    instant = largest_load(run)
    loop = run.displacement, run.force
    energy = float(run.dissipated.sum())
    figures = key_figures(run.loop.axes, loop, run.iterate.status, energy, instant)
    return figures, float(run.problem.instants[instant])
