"""Quantities of the result: displacement, slip, forces, pressure, stress, loop."""

from __future__ import annotations

import math
from collections.abc import Collection
from operator import attrgetter
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, Flags, without_residue
from solver.discrete.plane.makers.band import Band
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.probes import AxialForce, reaction
from solver.discrete.problem import Problem
from solver.discrete.rods.rods import Rods
from solver.laws import OPEN, Contact
from solver.settings.scene import Settings
from solver.study.quantities.cycles import instants_of_cycle
from solver.study.quantities.finished import (
    FinishedRun,
    figures_of,
    first_largest,
    largest_load,
)
from solver.study.quantities.quantity import CYCLE, Parameter, Quantity, quantity

AT = Parameter(" after a share {:g} of the interval", (0.0, 1.0))
SHARE = Parameter(" of a share {:g} of the points", (0.0, 1.0))
ENDS: tuple[Literal["left"], Literal["right"]] = ("left", "right")
UNLOADED = 1e-3
"""Share of the largest force below which a structure counts as unloaded."""
_opens = attrgetter("opens")
_over_a_displacement = attrgetter("loop_is_over_displacement")


def _has_no_wires_around(settings: Settings) -> bool:
    """Check whether the loop is not the moment over the curvature of a rope."""
    return settings.kind != "helices"


def _in_the_plane(settings: Settings) -> bool:
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
    "Largest displacement of the loop", "m", parameter=AT, applies=_has_no_wires_around
)
def displacement(run: FinishedRun, at: float | None) -> float:
    """Displacement of the loop of largest size, m.

    NaN where the loop is not over a displacement.
    """
    return _of_loop(run, "displacement", at)


@quantity("Largest force of the loop", "N", parameter=AT, applies=_has_no_wires_around)
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


@quantity("Largest slip", "m")
def peak_slip(run: FinishedRun) -> float:
    """Largest slip of any point in contact, at any instant, m."""
    contacts = [run.iterate.contact(name) for name in run.problem.contacts.surfaces]
    slips = [np.abs(each.slip * (each.status != OPEN)).max() for each in contacts]
    # What sticks moves by rounding of the bodies' displacements.
    return float(without_residue(max(slips), np.abs(run.iterate.displacement)))


@quantity("Largest friction, all points", "N")
def peak_friction(run: FinishedRun) -> float:
    """Largest sum over all points of the size of the friction force, N."""
    contacts = run.problem.contacts
    sums = np.empty((len(contacts), run.problem.n_instants))
    for law, numbers, places, forces in contacts.stacks:
        is_open = run.iterate.status[places] == OPEN
        size = np.where(is_open, 0.0, np.abs(run.iterate.contact_force[forces[-1]]))
        for number, (points, _) in zip(numbers, law.ranges, strict=True):
            sums[number] = law.copies * np.add.reduce(size[points])
    return float(sums.sum(axis=0).max())


def _pressing(run: FinishedRun, name: str) -> Array:
    """Pressing force at an interface, shape (n_points, n_instants), N.

    The force is an unknown only in scenes whose contacts open. Where a point is open,
    rounding alone leaves something of it.
    """
    contact = run.iterate.contact(name)
    assert contact.normal_force is not None
    return np.where(contact.status == OPEN, 0.0, contact.normal_force)


@quantity("Largest pressing force, all points", "N", applies=_opens)
def peak_pressing(run: FinishedRun) -> float:
    """Largest sum over all points of the pressing force, N."""
    # Instant by instant over all interfaces: their peaks may come at other times.
    forces = [
        _pressing(run, name).sum(axis=0) for name in run.problem.contacts.surfaces
    ]
    return float(np.sum(forces, axis=0).max())


@quantity("Largest pressure", "Pa", applies=_opens)
def peak_pressure(run: FinishedRun) -> float:
    """Largest pressure at any point of an interface, Pa.

    The pressure is the force of a point over its tributary length, one metre thick. A
    spring has a force and no pressure.
    """
    peaks = []
    for name, lengths in _lengths(run).items():
        pressure = _pressing(run, name) / lengths[:, None]
        peaks.append(float(pressure.max()))
    return max(peaks, default=math.nan)


@quantity("Largest length in contact", "m", applies=_opens)
def contact_width(run: FinishedRun) -> float:
    """Largest length over which bodies touch at once, m."""
    length, status = _touching(run)
    return float((length[:, None] * (status != OPEN)).sum(axis=0).max())


def _lengths(run: FinishedRun) -> dict[str, Array]:
    """Tributary lengths of the points of each surface by name, shape (n_points,), m."""
    contacts = run.problem.contacts
    laws = contacts.laws.values()
    lengths = contacts.of_points([law.by_point(law.weights) for law in laws])
    return {name: lengths[contacts.points[name]] for name in contacts.surfaces}


def _touching(run: FinishedRun) -> tuple[Array, NDArray[np.int8]]:
    """Tributary length and status of all points of surfaces, one surface after another.

    The lengths have shape (n_points,), m, the statuses (n_points, n_instants).
    """
    lengths = _lengths(run)
    status = [run.iterate.contact(name).status for name in lengths]
    return np.concatenate(list(lengths.values())), np.concatenate(status)


def _peak_stress(name: str, title: str, unit: str, component: int) -> Quantity:
    """Largest von Mises stress, its x or its y: 0, 1 or 2 of `peak_stress`."""

    def of(run: FinishedRun) -> float:
        return run.peak_stress[component]

    return Quantity(name, title, unit, of, applies=_in_the_plane)


peak_stress = _peak_stress("peak_stress", "Largest von Mises stress", "Pa", 0)
peak_stress_x = _peak_stress("peak_stress_x", "x of the largest stress", "m", 1)
peak_stress_y = _peak_stress("peak_stress_y", "y of the largest stress", "m", 2)


@quantity(
    "Largest force in the spring", "N", applies=lambda settings: settings.has("spring")
)
def spring_force(run: FinishedRun) -> float:
    """Largest force in the spring, N."""
    return float(_pressing(run, "spring").max())


@quantity(
    "Displacement at the largest load",
    "m",
    applies=_over_a_displacement,
    when=largest_load,
)
def end_displacement(run: FinishedRun, instant: int) -> float:
    """Displacement of the loop at the largest load, m."""
    return float(run.displacement[instant])


@quantity("Displacement left without load", "m", applies=_over_a_displacement)
def residual_displacement(run: FinishedRun) -> float:
    """Residual displacement of an unloaded end, m; NaN if the end is loaded."""
    size = np.abs(run.force)
    # Under load the displacement is not what is left.
    if size[-1] > UNLOADED * size.max():
        return math.nan
    return float(run.displacement[-1])


@quantity("Largest load over its displacement", "N/m", applies=_over_a_displacement)
def stiffness(run: FinishedRun) -> float:
    """Largest force of the loop over its displacement, N/m."""
    instant = largest_load(run)
    displacement = float(run.displacement[instant])
    if displacement:
        return float(run.force[instant]) / displacement
    return math.nan


@quantity("Energy dissipated", "J", parameter=CYCLE)
def dissipation(run: FinishedRun, at: float | None) -> float:
    """Energy dissipated by friction, J: in the whole run, or in one cycle.

    NaN where the load has fewer cycles.
    """
    instants = instants_of_cycle(run.settings, at)
    if instants is None:
        return math.nan
    return float(run.dissipated[instants].sum())


@quantity("Share of the points that slip", is_share=True)
def slipped_share(run: FinishedRun) -> float:
    """Share of the points that slip at any instant, among those that can slip."""
    return float(_slipped_shares(run)[-1])


@quantity(
    "Share of the contact that sticks at the largest load",
    is_share=True,
    when=largest_load,
)
def stuck_share(run: FinishedRun, instant: int) -> float:
    """Share of the length in contact that sticks at the largest load.

    Points that are held and never move are left out. NaN if nothing is in contact.
    """
    # Clamped points would count as sticking.
    length, statuses = _touching(run)
    still = _stand_still(run)[run.problem.contacts.on_surfaces]
    length = length * ~still
    status = statuses[:, instant]
    touching = length[status != OPEN].sum()
    if touching:
        return float(length[status == 0].sum() / touching)
    return math.nan


def _slipped_shares(run: FinishedRun) -> Array:
    """Share of the points that have slipped by each instant, (n_instants,).

    Only points of surfaces that can slip count.
    """
    problem = run.problem
    # A point counts from its first slip on.
    slipped = np.logical_or.accumulate(np.abs(run.iterate.status) == 1, axis=1)
    still = _stand_still(run)
    counted = slipped[problem.contacts.on_surfaces & ~still]
    if not len(counted):
        return np.zeros(slipped.shape[1])
    return np.asarray(counted.mean(axis=0))


def _stand_still(run: FinishedRun) -> Flags:
    """Mask of points that are held and never slip, shape (n_points,)."""
    contacts = run.problem.contacts
    is_held = []
    for law in contacts.laws.values():
        is_free = ~are_clamped(run.problem, law)
        is_held.append(law.by_point(is_free.astype(float)) == 0.0)
    has_slipped = np.any(np.abs(run.iterate.status) == 1, axis=1)
    return np.asarray(contacts.of_points(is_held) & ~has_slipped)


def are_clamped(problem: Problem, law: Contact) -> Flags:
    """Mask of pairs with tangential displacement prescribed on all sides."""
    held = [problem.is_held[rows] for rows in law.tangent.sides]
    return np.asarray(np.all(held, axis=0))


def _at_first_slip(run: FinishedRun, values: Array, at: float | None) -> float:
    """Value at the first instant at which a share of the points, or any, has slipped.

    The values have shape (n_instants,). Infinite where no such instant comes.
    """
    share = _slipped_shares(run)
    slips = (share > 0.0) & (share >= (at or 0.0))
    if slips.any():
        return float(values[np.argmax(slips)])
    return math.inf


@quantity("Time of the first slip", "s", parameter=SHARE)
def first_slip_time(run: FinishedRun, at: float | None) -> float:
    """Time of the first slip, s; infinite if no point slips."""
    return _at_first_slip(run, run.problem.instants, at)


@quantity(
    "Displacement at the first slip", "m", parameter=SHARE, applies=_over_a_displacement
)
def first_slip_displacement(run: FinishedRun, at: float | None) -> float:
    """Displacement of the loop at the first slip, m; infinite if no point slips."""
    return _at_first_slip(run, run.displacement, at)
