"""Quantities of what a run came to: displacement, slip, forces, pressure, stress, its loop."""

from __future__ import annotations

import math
from collections.abc import Collection
from operator import attrgetter
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from solver.arrays import RESIDUE, Array
from solver.discrete.probes import AxialForce, reaction
from solver.discrete.rods import Rods
from solver.discrete.stack import Stack
from solver.laws import OPEN
from solver.reference.distance import determinate_forces
from solver.settings import Settings
from solver.study.quantities.cycles import instants_of
from solver.study.quantities.finished import FinishedRun, largest_load
from solver.study.quantities.quantity import CYCLE, Parameter, Quantity, quantity

AT = Parameter(" after {:.0%} of the interval", (0.0, 1.0))
SHARE = Parameter(" of a share {:g} of the points", (0.0, 1.0))
ENDS: tuple[Literal["left"], Literal["right"]] = "left", "right"
UNLOADED = 1e-3
"""Share of the largest force below which a structure counts as unloaded."""
_opens = attrgetter("opens")
_over_a_displacement = attrgetter("loop_is_over_displacement")


def _rubs_by_mu(settings: Settings) -> bool:
    """Whether friction before slip is mu N."""
    law = settings.law
    return law.cohesion == 0.0 and math.isinf(law.cap)


def _in_the_plane(settings: Settings) -> bool:
    return settings.kind == "plane"


@quantity("Largest displacement", "m")
def peak_displacement(run: FinishedRun) -> float:
    """Largest displacement of any node at any instant, m."""
    inside, moved = run.problem.inside, run.problem.at_rest(run.iterate.displacement)
    if inside is None:
        return float(np.abs(moved).max())
    return float(np.linalg.norm(inside.displacement(moved, slice(None)), axis=1).max())


def _axial_force(run: FinishedRun) -> Array:
    """Axial force in all elements, and at both ends, pull positive, (n_places, n_instants), N.

    In the middle of the last element friction has taken its part of the force at the end.
    """
    rods = run.settings.structure()
    assert isinstance(rods, Rods)
    left, right = (rods.end_force(run.problem, side).of(run.iterate) for side in ENDS)
    return np.vstack([AxialForce(run.problem)(run.iterate.displacement), -left, right])


def _most_axial_force(run: FinishedRun, at: float | None) -> int:
    """Instant at a share of the interval, or that of the largest axial force."""
    times = run.problem.instants
    if at is None:
        return int(np.abs(_axial_force(run)).max(axis=0).argmax())
    return int(np.abs(times - at * times[-1]).argmin())


@quantity(
    "Largest axial force",
    "N",
    parameter=AT,
    applies=lambda settings: settings.kind in ("rod", "wires"),
    when=_most_axial_force,
)
def axial_force(run: FinishedRun, instant: int) -> float:
    """Largest axial force along rods at an instant, their ends included, N, pull positive."""
    force = _axial_force(run)[:, instant]
    return float(force[np.abs(force).argmax()])


def _force_at(side: str) -> Quantity:
    """Largest force that holds a side, or pulls the end of a rod there."""

    def force(run: FinishedRun) -> float:
        problem, structure = run.problem, run.settings.structure()
        if isinstance(structure, Rods):
            end = structure.end_force(problem, "right" if side == "right" else "left")
            values = end.of(run.iterate)
            return float(values[np.abs(values).argmax()])
        along, up = (reaction(problem, side, axis).of(run.iterate) for axis in (0, 1))
        return float(np.hypot(along, up).max())

    title, applies = f"Largest force at the {side}", lambda own: side in holding_sides(own)
    return Quantity(f"{side}_force", title, "N", force, applies=applies)


def holding_sides(settings: Settings) -> Collection[str]:
    """Sides that have a force to tell: ends of a rod, and sides of prescribed displacement."""
    if settings.kind == "rod":
        return "left", "right"
    structure = settings.structure()
    sides = structure.sides.items() if isinstance(structure, Stack) else ()
    return [side for side, given in sides if any(each.prescribed for each in given)]


left_force, right_force, top_force, bottom_force = map(
    _force_at, ("left", "right", "top", "bottom")
)
"""N; of a rod's end along it, positive to the right, and in the plane its size."""


@quantity("Largest slip", "m")
def peak_slip(run: FinishedRun) -> float:
    """Farthest that any point in contact has come along what it rubs on, m."""
    contacts = map(run.iterate.contact, run.problem.surfaces)
    return float(max(np.abs(part.slip * (part.status != OPEN)).max() for part in contacts))


@quantity("Largest friction, all points", "N")
def peak_friction(run: FinishedRun) -> float:
    """Largest sum over all points of the sizes of the friction force, N."""
    return float(np.abs(run.iterate.friction_force).sum(axis=0).max())


def _pressing(run: FinishedRun, name: str) -> Array:
    """Pressing force at an interface, which is an unknown in scenes whose contacts open."""
    force = run.iterate.contact(name).normal_force
    assert force is not None
    return force


@quantity("Largest pressing force, all points", "N", applies=_opens)
def peak_pressing(run: FinishedRun) -> float:
    """Largest sum over all points of the pressing force, N."""
    forces = [_pressing(run, name).sum(axis=0) for name in run.problem.surfaces]
    return float(np.sum(forces, axis=0).max())


@quantity("Largest pressure", "Pa", applies=_opens)
def peak_pressure(run: FinishedRun) -> float:
    """Largest pressure at any point of an interface, Pa.

    Force of a point over its tributary length, one metre thick. A spring has a force and no
    pressure.
    """
    lengths = _lengths(run).items()
    peaks = (float((_pressing(run, name) / own[:, None]).max()) for name, own in lengths)
    return max(peaks, default=math.nan)


@quantity("Largest length in contact", "m", applies=_opens)
def contact_width(run: FinishedRun) -> float:
    """Largest length over which bodies touch at once, m."""
    length, status = _touching(run)
    return float((length[:, None] * (status != OPEN)).sum(axis=0).max())


def _lengths(run: FinishedRun) -> dict[str, Array]:
    """Tributary lengths of the points of all surfaces, m."""
    return {name: law.by_point(law.weights) for name, law in run.problem.surfaces.items()}


def _touching(run: FinishedRun) -> tuple[Array, NDArray[np.int8]]:
    """Length and status of the points of these interfaces, one interface after the other."""
    lengths = _lengths(run)
    status = [run.iterate.contact(name).status for name in lengths]
    return np.concatenate(list(lengths.values())), np.concatenate(status)


def _peak_stress(name: str, title: str, unit: str, place: int) -> Quantity:
    """Largest von Mises stress at the centre of an element, or where that is; NaN without any."""
    return Quantity(name, title, unit, lambda run: run.peak_stress[place], applies=_in_the_plane)


peak_stress = _peak_stress("peak_stress", "Largest von Mises stress", "Pa", 0)
peak_stress_x = _peak_stress("peak_stress_x", "x of the largest stress", "m", 1)
peak_stress_y = _peak_stress("peak_stress_y", "y of the largest stress", "m", 2)


@quantity("Largest force in the spring", "N", applies=lambda settings: settings.has("spring"))
def spring_force(run: FinishedRun) -> float:
    """Largest force in the spring, N."""
    return float(_pressing(run, "spring").max())


@quantity("Smallest friction that holds", applies=_rubs_by_mu)
def holding_friction(run: FinishedRun) -> float:
    """Smallest coefficient of friction at which no interface slides as a whole.

    All its friction over all that presses, at the worst instant; where mu varies, by its factors.
    NaN where one slides: the run then cannot tell how much more it would take.
    """
    if not run.settings.friction:
        return math.nan
    # A point that a clamp holds, too, never slips.
    determinate = determinate_forces(run.problem)
    for name in run.problem.surfaces:
        status = run.iterate.contact(name).status
        *_, tangential = run.problem.contact_places[name]
        is_free = (status == OPEN) | ~determinate[tangential]
        ways = [(status == way) | is_free for way in (-1, 1)]
        if any((way.all(axis=0) & ~is_free.all(axis=0)).any() for way in ways):
            return math.nan
    needed, _ = _nearest_to_sliding(run)
    return needed if needed > RESIDUE else 0.0


@quantity("Force that friction could hold", "N", applies=_rubs_by_mu)
def holding_force(run: FinishedRun) -> float:
    """Largest force that friction could hold at an interface, N, where and when it is nearest to.

    That is mu times all that presses; beyond it the interface slides as a whole.
    """
    friction = float(run.settings.friction)
    return friction and friction * _nearest_to_sliding(run)[1]


def _nearest_to_sliding(run: FinishedRun) -> tuple[float, float]:
    """Largest share of all friction at an interface in all that presses it, and the latter, N."""
    friction, every = run.settings.friction, [np.zeros((2, 0))]
    for name, law in run.problem.surfaces.items():
        contact = run.iterate.contact(name)
        if contact.normal_force is None:
            bound = law.tangential.bound.sum(axis=0) * run.problem.scales.force
            pressing = np.broadcast_to(bound / friction, run.problem.n_instants)
        else:
            share = law.mean_by_point(law.tangential.friction) / friction
            pressing = share @ contact.normal_force
        held, is_pressed = np.abs(contact.tangential_force.sum(axis=0)), pressing > 0.0
        every.append(np.array([held[is_pressed] / pressing[is_pressed], pressing[is_pressed]]))
    shares, forces = np.concatenate(every, axis=1)
    if not len(shares):
        return 0.0, 0.0
    nearest = shares.argmax()
    return float(shares[nearest]), float(forces[nearest])


@quantity("Displacement at the largest load", "m", applies=_over_a_displacement, when=largest_load)
def end_displacement(run: FinishedRun, instant: int) -> float:
    """Displacement of the loop where its force first is largest, m."""
    return float(run.displacement[instant])


@quantity("Displacement left without load", "m", applies=_over_a_displacement)
def residual_displacement(run: FinishedRun) -> float:
    """What is left of the loop's displacement without load, m; NaN if the end is loaded."""
    size = np.abs(run.force)
    return math.nan if size[-1] > UNLOADED * size.max() else float(run.displacement[-1])


@quantity("Largest load over its displacement", "N/m", applies=_over_a_displacement)
def stiffness(run: FinishedRun) -> float:
    """Largest force of the loop over its displacement, N/m."""
    instant = largest_load(run)
    moved = float(run.displacement[instant])
    return float(run.force[instant]) / moved if moved else math.nan


@quantity("Energy dissipated", "J", parameter=CYCLE)
def dissipation(run: FinishedRun, at: float | None) -> float:
    """Energy that friction takes, J: of the whole run, or of a cycle; NaN if there are fewer."""
    some = instants_of(run.settings, at)
    return math.nan if some is None else float(run.dissipated[some].sum())


@quantity("Share of the points that slip", is_share=True)
def slipped_share(run: FinishedRun) -> float:
    """Share of the points that slip at any instant."""
    return float(_has_slipped(run)[:, -1].mean())


@quantity("Share of the contact that sticks at the largest load", is_share=True, when=largest_load)
def stuck_share(run: FinishedRun, instant: int) -> float:
    """Share of what touches that sticks at the largest load, by length; NaN if nothing does."""
    length, every = _touching(run)
    status = every[:, instant]
    touching = length[status != OPEN].sum()
    return float(length[status == 0].sum() / touching) if touching else math.nan


def _has_slipped(run: FinishedRun) -> NDArray[np.bool_]:
    """Which points of surfaces have slipped by every instant, shape (n_points, n_instants)."""
    slips = np.abs(run.iterate.status[run.problem.on_surfaces]) == 1
    return np.logical_or.accumulate(slips, axis=1)


def _at_first_slip(run: FinishedRun, values: Array, at: float | None) -> float:
    """Value at the instant by which a share of the points, or any, has slipped; or infinite."""
    share = _has_slipped(run).mean(axis=0)
    slips = (share > 0.0) & (share >= (at or 0.0))
    return float(values[np.argmax(slips)]) if slips.any() else math.inf


@quantity("Time of the first slip", "s", parameter=SHARE)
def first_slip_time(run: FinishedRun, at: float | None) -> float:
    """First instant by which points have slipped, s; infinite if none do."""
    return _at_first_slip(run, run.problem.instants, at)


@quantity("Displacement at the first slip", "m", parameter=SHARE, applies=_over_a_displacement)
def first_slip_displacement(run: FinishedRun, at: float | None) -> float:
    """Displacement of the loop at that instant, m."""
    return _at_first_slip(run, run.displacement, at)
