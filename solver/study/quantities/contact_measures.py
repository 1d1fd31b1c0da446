"""Quantities of what a run came to: displacement, slip, forces, pressure, stress, its loop."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from operator import attrgetter
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from solver.arrays import RESIDUE, Array
from solver.discrete.plane.stack import Stack
from solver.discrete.probes import AxialForce, reaction
from solver.discrete.rods.rods import Rods
from solver.laws import OPEN
from solver.reference.distance import determinate_forces
from solver.settings.scene import Settings
from solver.study.quantities.cycles import instants_of
from solver.study.quantities.finished import (
    EQUAL,
    FinishedRun,
    figures_of,
    first_largest,
    largest_load,
)
from solver.study.quantities.quantity import CYCLE, Parameter, Quantity, quantity

AT = Parameter(" after {:.0%} of the interval", (0.0, 1.0))
SHARE = Parameter(" of a share {:g} of the points", (0.0, 1.0))
ENDS: tuple[Literal["left"], Literal["right"]] = "left", "right"
UNLOADED = 1e-3
"""Share of the largest force below which a structure counts as unloaded."""
_opens = attrgetter("opens")
_over_a_displacement = attrgetter("loop_is_over_displacement")


def _rubs_by_mu(settings: Settings) -> bool:
    """Whether friction is mu N at most, whatever has slipped."""
    law = settings.law
    return law.cohesion == 0.0 and math.isinf(law.cap) and law.strength is None


def _has_no_wires_around(settings: Settings) -> bool:
    """Whether the loop is no moment over a curvature."""
    return settings.kind != "helices"


def _in_the_plane(settings: Settings) -> bool:
    return settings.kind == "plane"


@quantity("Largest displacement", "m")
def peak_displacement(run: FinishedRun) -> float:
    """Largest displacement of any node at any instant, m.

    Where a body lies on its image, it is that of a point over the one across from it,
    which moves along as much the other way, and alike across.
    """
    inside = run.problem.inside
    moved = run.problem.at_rest(run.iterate.displacement)
    if inside is None:
        return float(np.abs(moved).max())
    every = inside.displacement(moved, slice(None))
    ratio = max(law.slip_ratio for law in run.problem.rubbing.values())
    if ratio > 1.0:
        return ratio * float(np.abs(every[:, 0]).max())
    return float(np.linalg.norm(every, axis=1).max())


def _of_loop(run: FinishedRun, name: str, at: float | None) -> float:
    """Key figure of the loop: largest in size, or at a share of the interval; NaN without it."""
    for figure in figures_of(run):
        if figure.name == name:
            if at is None:
                return figure.largest
            return figure.at(_instant_at(run, at))
    return math.nan


@quantity(
    "Largest displacement of the loop", "m", parameter=AT, applies=_has_no_wires_around
)
def displacement(run: FinishedRun, at: float | None) -> float:
    """Displacement of the loop that is largest in size, m; NaN where it is over something else."""
    return _of_loop(run, "displacement", at)


@quantity("Largest force of the loop", "N", parameter=AT, applies=_has_no_wires_around)
def force(run: FinishedRun, at: float | None) -> float:
    """Force of the loop that is largest in size, N; NaN where it shows something else."""
    return _of_loop(run, "force", at)


def _axial_force(run: FinishedRun) -> Array:
    """Axial force in all elements, and at both ends, pull positive, (n_places, n_instants), N.

    In the middle of the last element friction has taken its part of the force at the
    end.
    """
    rods = run.settings.structure()
    assert isinstance(rods, Rods)
    left, right = (rods.end_force(run.problem, side).of(run.iterate) for side in ENDS)
    return np.vstack([AxialForce(run.problem)(run.iterate.displacement), -left, right])


def _most_axial_force(run: FinishedRun, at: float | None) -> int:
    """Instant at a share of the interval, or that of the largest axial force."""
    if at is None:
        return first_largest(np.abs(_axial_force(run)).max(axis=0))
    return _instant_at(run, at)


def _instant_at(run: FinishedRun, share: float) -> int:
    """Instant that is nearest to a share of the interval."""
    times = run.problem.instants
    return int(np.abs(times - share * times[-1]).argmin())


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
    return float(force[first_largest(force)])


def _force_at(side: str) -> Quantity:
    """Largest force that holds a side, or pulls the end of a rod there."""

    def force(run: FinishedRun) -> float:
        problem = run.problem
        structure = run.settings.structure()
        if isinstance(structure, Rods):
            end = structure.end_force(problem, "right" if side == "right" else "left")
            values = end.of(run.iterate)
            return float(values[first_largest(values)])
        along, up = (reaction(problem, side, axis).of(run.iterate) for axis in (0, 1))
        return float(np.hypot(along, up).max())

    title = f"Largest force at the {side}"
    return Quantity(
        f"{side}_force",
        title,
        "N",
        force,
        applies=lambda own: side in holding_sides(own),
    )


def holding_sides(settings: Settings) -> Collection[str]:
    """Sides that have a force to tell: ends of a rod, and sides of prescribed displacement."""
    if settings.kind == "rod":
        return "left", "right"
    structure = settings.structure()
    if not isinstance(structure, Stack):
        return []
    sides = structure.sides.items()
    return [side for side, given in sides if any(each.prescribed for each in given)]


left_force, right_force, top_force, bottom_force = map(
    _force_at, ("left", "right", "top", "bottom")
)
"""N; of a rod's end along it, positive to the right, and in the plane its size."""


@quantity("Largest slip", "m")
def peak_slip(run: FinishedRun) -> float:
    """Farthest that any point in contact has come along what it rubs on, m."""
    contacts = map(run.iterate.contact, run.problem.surfaces)
    return float(
        max(np.abs(part.slip * (part.status != OPEN)).max() for part in contacts)
    )


@quantity("Largest friction, all points", "N")
def peak_friction(run: FinishedRun) -> float:
    """Largest sum over all points of the sizes of the friction force, N."""
    total = np.zeros(run.problem.n_instants)
    for name, law in run.problem.rubbing.items():
        force = run.iterate.contact(name).tangential_force
        total += law.copies * np.abs(force).sum(axis=0)
    return float(total.max())


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

    Force of a point over its tributary length, one metre thick. A spring has a force
    and no pressure.
    """
    lengths = _lengths(run).items()
    peaks = (
        float((_pressing(run, name) / own[:, None]).max()) for name, own in lengths
    )
    return max(peaks, default=math.nan)


@quantity("Largest length in contact", "m", applies=_opens)
def contact_width(run: FinishedRun) -> float:
    """Largest length over which bodies touch at once, m."""
    length, status = _touching(run)
    return float((length[:, None] * (status != OPEN)).sum(axis=0).max())


def _lengths(run: FinishedRun) -> dict[str, Array]:
    """Tributary lengths of the points of all surfaces, m."""
    return {
        name: law.by_point(law.weights) for name, law in run.problem.surfaces.items()
    }


def _touching(run: FinishedRun) -> tuple[Array, NDArray[np.int8]]:
    """Length and status of the points of these interfaces, one interface after the other."""
    lengths = _lengths(run)
    status = [run.iterate.contact(name).status for name in lengths]
    return np.concatenate(list(lengths.values())), np.concatenate(status)


def _peak_stress(name: str, title: str, unit: str, place: int) -> Quantity:
    """Largest von Mises stress at the centre of an element, or where that is; NaN without any."""
    return Quantity(
        name, title, unit, lambda run: run.peak_stress[place], applies=_in_the_plane
    )


peak_stress = _peak_stress("peak_stress", "Largest von Mises stress", "Pa", 0)
peak_stress_x = _peak_stress("peak_stress_x", "x of the largest stress", "m", 1)
peak_stress_y = _peak_stress("peak_stress_y", "y of the largest stress", "m", 2)


@quantity(
    "Largest force in the spring", "N", applies=lambda settings: settings.has("spring")
)
def spring_force(run: FinishedRun) -> float:
    """Largest force in the spring, N."""
    return float(_pressing(run, "spring").max())


@dataclass(frozen=True, eq=False)
class _Hold:
    """How far an interface as a whole is from sliding, at every instant, (n_instants,).

    Attributes
    ----------
    pressing
        All that presses, N; where mu varies, by its factors.
    carried
        All its friction, N.
    slides
        Whether all its points slip one way.
    """

    pressing: Array
    carried: Array
    slides: NDArray[np.bool_]

    @property
    def needed(self) -> Array:
        """Coefficient of friction that is in use; 0 where nothing presses."""
        nothing = np.zeros_like(self.pressing)
        return np.divide(
            np.abs(self.carried), self.pressing, nothing, where=self.pressing > 0.0
        )

    def sliding(self, friction: float, instants: Array) -> Array:
        """All that presses while it slides, N: at its instants, and as it begins to slide.

        It begins between two instants, where all its friction, if it grows on as
        before, comes to mu times all that presses.
        """
        pressing = self.pressing
        carried = np.abs(self.carried)
        step = np.diff(instants)
        begins = np.flatnonzero(self.slides[2:] & ~self.slides[1:-1]) + 2
        before = begins - 1
        pace = (carried[before] - carried[before - 1]) / step[before - 1]
        growth = pace * step[before]
        rise = pressing[begins] - pressing[before]
        lacks = friction * pressing[before] - carried[before]
        closes = growth - friction * rise
        share = np.divide(lacks, closes, np.ones_like(lacks), where=closes > 0.0)
        at_onset = pressing[before] + np.clip(share, 0.0, 1.0) * rise
        return np.concatenate([pressing[self.slides], at_onset])


def _holds(run: FinishedRun) -> list[_Hold]:
    """Interfaces with friction, each as a whole."""
    problem = run.problem
    friction = run.settings.friction
    # A point that a clamp holds, too, never slips.
    determinate = determinate_forces(problem)
    holds = []
    for name, law in problem.surfaces.items():
        contact = run.iterate.contact(name)
        *_, tangential = problem.contact_places[name]
        if contact.normal_force is None:
            bound = law.by_point(law.tangential.bound) * problem.scales.force
            pressing = np.broadcast_to(bound / friction, contact.status.shape)
        else:
            share = law.mean_by_point(law.tangential.friction) / friction
            pressing = share[:, None] * contact.normal_force
        status = contact.status
        is_free = (status == OPEN) | ~determinate[tangential] | (pressing <= 0.0)
        forward = ((status == 1) | is_free).all(axis=0)
        backward = ((status == -1) | is_free).all(axis=0)
        slides = (forward | backward) & ~is_free.all(axis=0)
        carried = contact.tangential_force.sum(axis=0)
        holds.append(_Hold(pressing.sum(axis=0), carried, slides))
    return holds


@quantity("Smallest friction that holds", applies=_rubs_by_mu)
def holding_friction(run: FinishedRun) -> float:
    """Smallest coefficient of friction at which no interface slides as a whole.

    All its friction over all that presses, at the worst instant; where mu varies, by
    its factors. NaN where one slides: the run then cannot tell how much more it would
    take.
    """
    if not run.settings.friction:
        return math.nan
    holds = _holds(run)
    if any(hold.slides.any() for hold in holds):
        return math.nan
    needed = max(float(hold.needed.max(initial=0.0)) for hold in holds)
    return needed if needed > RESIDUE else 0.0


@quantity("Largest force that friction could hold", "N", applies=_rubs_by_mu)
def holding_force(run: FinishedRun) -> float:
    """Largest force that friction could hold at an interface that comes nearest to sliding, N.

    That is mu times all that presses. Where interfaces slide as a whole, it is the
    largest while they do, from where they begin to; else that at the interface and the
    instant of which the largest share is in use, and the largest of several.
    """
    friction = float(run.settings.friction)
    if not friction:
        return 0.0
    holds = _holds(run)
    instants = run.problem.instants
    forces = [hold.sliding(friction, instants) for hold in holds if hold.slides.any()]
    if not forces:
        most = max(float(hold.needed.max(initial=0.0)) for hold in holds)
        forces = [hold.pressing[hold.needed >= (1.0 - EQUAL) * most] for hold in holds]
    return friction * float(np.concatenate(forces).max(initial=0.0))


@quantity(
    "Displacement at the largest load",
    "m",
    applies=_over_a_displacement,
    when=largest_load,
)
def end_displacement(run: FinishedRun, instant: int) -> float:
    """Displacement of the loop where its force is largest, m: the largest while that stands."""
    return float(run.displacement[instant])


@quantity("Displacement left without load", "m", applies=_over_a_displacement)
def residual_displacement(run: FinishedRun) -> float:
    """What is left of the loop's displacement without load, m; NaN if the end is loaded."""
    size = np.abs(run.force)
    if size[-1] > UNLOADED * size.max():
        return math.nan
    return float(run.displacement[-1])


@quantity("Largest load over its displacement", "N/m", applies=_over_a_displacement)
def stiffness(run: FinishedRun) -> float:
    """Largest force of the loop over its displacement, N/m."""
    instant = largest_load(run)
    moved = float(run.displacement[instant])
    if moved:
        return float(run.force[instant]) / moved
    return math.nan


@quantity("Energy dissipated", "J", parameter=CYCLE)
def dissipation(run: FinishedRun, at: float | None) -> float:
    """Energy that friction takes, J: of the whole run, or of a cycle; NaN if there are fewer."""
    some = instants_of(run.settings, at)
    if some is None:
        return math.nan
    return float(run.dissipated[some].sum())


@quantity("Share of the points that slip", is_share=True)
def slipped_share(run: FinishedRun) -> float:
    """Share of the points that slip at any instant, of those that can."""
    return float(_slipped_shares(run)[-1])


@quantity(
    "Share of the contact that sticks at the largest load",
    is_share=True,
    when=largest_load,
)
def stuck_share(run: FinishedRun, instant: int) -> float:
    """Share of what touches that sticks at the largest load, by length; NaN if nothing does.

    Points that are held and never move are left out.
    """
    length, every = _touching(run)
    still = _stand_still(run)
    length = length * ~np.concatenate([still[name] for name in _lengths(run)])
    status = every[:, instant]
    touching = length[status != OPEN].sum()
    if touching:
        return float(length[status == 0].sum() / touching)
    return math.nan


def _slipped_shares(run: FinishedRun) -> Array:
    """Share of the points of surfaces that have slipped by every instant, (n_instants,).

    Of those that can slip.
    """
    problem = run.problem
    slipped = np.logical_or.accumulate(np.abs(run.iterate.status) == 1, axis=1)
    still = np.concatenate(list(_stand_still(run).values()))
    counted = slipped[problem.on_surfaces & ~still]
    if not len(counted):
        return np.zeros(slipped.shape[1])
    return np.asarray(counted.mean(axis=0))


def _stand_still(run: FinishedRun) -> dict[str, NDArray[np.bool_]]:
    """Points of each interface that are held and never move, (n_points,): they cannot slip."""
    held = run.problem.is_held
    still = {}
    for name, law in run.problem.rubbing.items():
        is_held = np.all([held[rows] for rows in law.tangent.sides], axis=0)
        has_slipped = np.any(np.abs(run.iterate.contact(name).status) == 1, axis=1)
        still[name] = (law.by_point(1.0 * ~is_held) == 0.0) & ~has_slipped
    return still


def _at_first_slip(run: FinishedRun, values: Array, at: float | None) -> float:
    """Value at the instant by which a share of the points, or any, has slipped; or infinite."""
    share = _slipped_shares(run)
    slips = (share > 0.0) & (share >= (at or 0.0))
    if slips.any():
        return float(values[np.argmax(slips)])
    return math.inf


@quantity("Time of the first slip", "s", parameter=SHARE)
def first_slip_time(run: FinishedRun, at: float | None) -> float:
    """First instant by which points have slipped, s; infinite if none do."""
    return _at_first_slip(run, run.problem.instants, at)


@quantity(
    "Displacement at the first slip", "m", parameter=SHARE, applies=_over_a_displacement
)
def first_slip_displacement(run: FinishedRun, at: float | None) -> float:
    """Displacement of the loop at that instant, m."""
    return _at_first_slip(run, run.displacement, at)
