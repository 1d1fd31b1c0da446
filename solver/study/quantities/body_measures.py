"""Quantities of bodies: displacement and force of the loop, forces at sides, stress."""

from __future__ import annotations

import math
from collections.abc import Collection
from operator import attrgetter
from typing import Literal

import numpy as np

from solver.arrays import Array
from solver.discrete.plane.makers.band import Band
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.probes import AxialForce, reaction
from solver.discrete.rods.rods import Rods
from solver.settings.scene import Settings
from solver.study.quantities.finished import (
    FinishedRun,
    figures_of,
    first_largest,
    largest_load,
)
from solver.study.quantities.quantity import Parameter, Quantity, quantity

AT = Parameter(" after a share {:g} of the interval", (0.0, 1.0))
ENDS: tuple[Literal["left"], Literal["right"]] = ("left", "right")
UNLOADED = 1e-3
"""Share of the largest force below which a structure counts as unloaded."""
loop_is_over_displacement = attrgetter("loop_is_over_displacement")


def is_rope(settings: Settings) -> bool:
    """Check whether the structure is a rope: helical wires around a core."""
    return settings.kind == "helices"


def _may_show_force(settings: Settings) -> bool:
    """Check whether the loop may show a force: that of a rope shows its moment."""
    return not is_rope(settings)


def _in_the_plane(settings: Settings) -> bool:
    """Check whether bodies are plane ones."""
    return settings.kind == "plane"


@quantity("Largest displacement", "m")
def peak_displacement(run: FinishedRun) -> float:
    """Largest displacement of any node at any instant, m.

    Where a body lies on its image, the displacement is relative to the point across:
    the image moves by as much the other way along the interface, and alike across it.
    """
    inside = run.problem.inside
    absolute = run.problem.absolute(run.iterate.displacement)
    if inside is None:
        return float(np.abs(absolute).max())
    vectors = inside.displacement(absolute, slice(None))
    # On its image a body shows half of the slip.
    ratio = max(law.slip_ratio for law in run.problem.contacts.laws.values())
    if ratio > 1.0:
        return ratio * float(np.abs(vectors[:, 0]).max())
    return float(np.linalg.norm(vectors, axis=1).max())


def _of_loop(run: FinishedRun, name: str, at: float | None) -> float:
    """Key figure of the loop: of largest size, or at a share of the interval.

    NaN where the loop has no figure of that name.
    """
    for figure in figures_of(run):
        if figure.name == name:
            if at is None:
                return figure.largest
            return figure.at(instant_at(run, at))
    return math.nan


@quantity(
    "Largest displacement of the loop", "m", parameter=AT, applies=_may_show_force
)
def displacement(run: FinishedRun, at: float | None) -> float:
    """Displacement of the loop of largest size, m.

    NaN where the loop is not over a displacement.
    """
    return _of_loop(run, "displacement", at)


@quantity("Largest force of the loop", "N", parameter=AT, applies=_may_show_force)
def force(run: FinishedRun, at: float | None) -> float:
    """Force of the loop of largest size, N; NaN for loops without force."""
    return _of_loop(run, "force", at)


def _has_axial_force(settings: Settings) -> bool:
    """Check whether bodies are rods, wires, or a band on a guide."""
    return settings.kind in ("rod", "wires") or settings.scene == "belt"


def _axial_force(run: FinishedRun) -> Array:
    """Axial force in all elements, and at both ends: (n_elements + 2, n_instants), N.

    Tension is positive. The ends are rows of their own, since friction takes a part of
    the end force before the middle of the last element.
    """
    rods = run.settings.structure()
    if isinstance(rods, Band):
        # The free spans are elements of their own.
        return rods.tensions(run.problem, run.iterate)
    assert isinstance(rods, Rods)
    left, right = (rods.end_force(run.problem, side).of(run.iterate) for side in ENDS)
    in_elements = AxialForce(run.problem)(run.iterate.displacement)
    return np.vstack([in_elements, -left, right])


def _axial_force_instant(run: FinishedRun, at: float | None) -> int:
    """Instant at a share of the interval, or the instant of the largest axial force."""
    if at is None:
        return first_largest(np.abs(_axial_force(run)).max(axis=0))
    return instant_at(run, at)


def instant_at(run: FinishedRun, share: float) -> int:
    """Index of the instant nearest to a share of the interval."""
    times = run.problem.instants
    return int(np.abs(times - share * times[-1]).argmin())


@quantity(
    "Largest axial force",
    "N",
    parameter=AT,
    applies=_has_axial_force,
    when=_axial_force_instant,
)
def axial_force(run: FinishedRun, instant: int) -> float:
    """Largest axial force along a body at an instant, with ends, N.

    Tension is positive.
    """
    force = _axial_force(run)[:, instant]
    return float(force[first_largest(force)])


def _force_at(side: str) -> Quantity:
    """Largest force that holds a side of bodies, or pulls that end of a rod.

    The force on an end is along the rod and positive to the right; the force on a side
    in the plane is the size of a vector.
    """

    def force(run: FinishedRun) -> float:
        problem = run.problem
        structure = run.settings.structure()
        if isinstance(structure, Rods):
            end = structure.end_force(problem, "right" if side == "right" else "left")
            values = end.of(run.iterate)
            return float(values[first_largest(values)])
        along = reaction(problem, side, 0).of(run.iterate)
        up = reaction(problem, side, 1).of(run.iterate)
        return float(np.hypot(along, up).max())

    def applies(settings: Settings) -> bool:
        return side in holding_sides(settings)

    title = f"Largest force at the {side}"
    return Quantity(f"{side}_force", title, "N", force, applies=applies)


def holding_sides(settings: Settings) -> Collection[str]:
    """Sides with a holding force: rod ends, or sides of prescribed displacement."""
    if settings.kind == "rod":
        return "left", "right"
    structure = settings.structure()
    if not isinstance(structure, Stack):
        return []
    held = []
    for side, components in structure.sides.items():
        if any(component.prescribed for component in components):
            held.append(side)
    return held


left_force = _force_at("left")
right_force = _force_at("right")
top_force = _force_at("top")
bottom_force = _force_at("bottom")


def _peak_stress(name: str, title: str, unit: str, component: int) -> Quantity:
    """Largest von Mises stress, its x or its y: 0, 1 or 2 of `peak_stress`."""

    def of(run: FinishedRun) -> float:
        return run.peak_stress[component]

    return Quantity(name, title, unit, of, applies=_in_the_plane)


peak_stress = _peak_stress("peak_stress", "Largest von Mises stress", "Pa", 0)
peak_stress_x = _peak_stress("peak_stress_x", "x of the largest stress", "m", 1)
peak_stress_y = _peak_stress("peak_stress_y", "y of the largest stress", "m", 2)


@quantity(
    "Displacement at the largest load",
    "m",
    applies=loop_is_over_displacement,
    when=largest_load,
)
def end_displacement(run: FinishedRun, instant: int) -> float:
    """Displacement of the loop at the largest load, m."""
    return float(run.displacement[instant])


@quantity("Displacement left without load", "m", applies=loop_is_over_displacement)
def residual_displacement(run: FinishedRun) -> float:
    """Residual displacement of an unloaded end, m; NaN if the end is loaded."""
    size = np.abs(run.force)
    # Under load the displacement is not what is left.
    if size[-1] > UNLOADED * size.max():
        return math.nan
    return float(run.displacement[-1])


@quantity(
    "Largest load over its displacement", "N/m", applies=loop_is_over_displacement
)
def stiffness(run: FinishedRun) -> float:
    """Largest force of the loop over its displacement, N/m."""
    return secant(run, largest_load(run))


def secant(run: FinishedRun, instant: int) -> float:
    """Force of the loop over its displacement at an instant; NaN over zero."""
    displacement = float(run.displacement[instant])
    if displacement:
        return float(run.force[instant]) / displacement
    return math.nan
