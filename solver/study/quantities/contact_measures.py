"""Quantities of contact: slip, friction, pressure, and shares that slip or stick."""

from __future__ import annotations

import math
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, Flags, without_residue
from solver.discrete.problem import Problem
from solver.laws import OPEN, Contact
from solver.study.quantities.body_measures import loop_is_over_displacement
from solver.study.quantities.cycles import instants_of_cycle
from solver.study.quantities.finished import FinishedRun, largest_load
from solver.study.quantities.held_ends import held_lengths
from solver.study.quantities.quantity import CYCLE, Parameter, quantity

SHARE = Parameter(" of a share {:g} of the points", (0.0, 1.0))
_opens = attrgetter("opens")


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
    """Largest length over which bodies touch at once, m.

    Held ends without points touch where the points beside them do.
    """
    length, status = _touching(run)
    surfaces = run.problem.contacts.surfaces
    held = np.concatenate([held_lengths(run, name) for name in surfaces])
    whole = length + held
    return float((whole[:, None] * (status != OPEN)).sum(axis=0).max())


def _lengths(run: FinishedRun) -> dict[str, Array]:
    """Tributary lengths of the points of each surface by name, shape (n_points,), m."""
    contacts = run.problem.contacts
    laws = contacts.laws.values()
    lengths = contacts.of_points([law.by_point(law.weights) for law in laws])
    return {name: lengths[contacts.points[name]] for name in contacts.surfaces}


def _touching(run: FinishedRun) -> tuple[Array, NDArray[np.int8]]:
    """Tributary length and status of all points of surfaces, one surface after another.

    The lengths have shape (n_points,), m, the statuses (n_points, n_instants). That of
    a point is the length of all points for which it stands.
    """
    lengths = _lengths(run)
    status = [run.iterate.contact(name).status for name in lengths]
    contacts = run.problem.contacts
    copies = contacts.copies[contacts.on_surfaces]
    return copies * np.concatenate(list(lengths.values())), np.concatenate(status)


@quantity(
    "Largest force in the spring", "N", applies=lambda settings: settings.has("spring")
)
def spring_force(run: FinishedRun) -> float:
    """Largest force in the spring, N."""
    return float(_pressing(run, "spring").max())


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

    Only points of surfaces that can slip count, each with all for which it stands.
    """
    problem = run.problem
    # A point counts from its first slip on.
    slipped = np.logical_or.accumulate(np.abs(run.iterate.status) == 1, axis=1)
    still = _stand_still(run)
    is_counted = problem.contacts.on_surfaces & ~still
    copies = problem.contacts.copies[is_counted]
    if not copies.size:
        return np.zeros(slipped.shape[1])
    return np.asarray(copies @ slipped[is_counted] / copies.sum())


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
    "Displacement at the first slip",
    "m",
    parameter=SHARE,
    applies=loop_is_over_displacement,
)
def first_slip_displacement(run: FinishedRun, at: float | None) -> float:
    """Displacement of the loop at the first slip, m; infinite if no point slips."""
    return _at_first_slip(run, run.displacement, at)
