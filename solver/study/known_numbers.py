"""Numbers that are known of runs, beside those of an answer: functions of `known_numbers.toml`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import erfc

from solver.arrays import Array
from solver.discrete.contacts import NO_SLIP
from solver.discrete.probes import reaction, reaction_moment
from solver.discrete.problem import Problem
from solver.discrete.rods.rods import Rods
from solver.discrete.structure import Loop, LoopFields
from solver.latin import Solution
from solver.reference.closed_forms.elastic_bodies import HalfPlane
from solver.reference.closed_forms.fluid_driven_slip import (
    fronts,
    slip_under_growing_strength,
)
from solver.reference.closed_forms.pulled_bar import broken_wire
from solver.study.quantities.cycles import turning_points

WORKS = {"m": "J", "1/m": "J/m"}
"""Unit of what a loop encloses, by that of what it goes over, where it is work."""


@dataclass(frozen=True, eq=False)
class Answer:
    """A problem with its settings, and what a run or a reference has for it."""

    settings: Any
    problem: Problem
    fields: LoopFields
    solution: Solution | None = None

    @property
    def support(self) -> tuple[Array, Array]:
        """Pressing force and friction on a support, N, each of shape (n_points, n_instants)."""
        contact = self.fields.contact("support")
        assert contact.normal_force is not None
        return contact.normal_force, contact.tangential_force

    @property
    def slip(self) -> Array:
        """Slip on a support, m, same shape."""
        return self.fields.contact("support").slip

    @property
    def loop(self) -> Loop:
        """Loop that the scene shows."""
        loop: Loop = self.settings.structure().loop(self.problem)
        return loop


Number = tuple[str, str, float, float]
"""Quantity, unit, what is known, and what an answer has."""


def loop(answer: Answer) -> Iterator[Number]:
    """Largest and last value that a loop finds, and the work that it encloses from the first on.

    Both beside the closed form over the same path.
    """
    curves = answer.settings.exact(answer.problem, answer.fields)
    (exact,) = [curve for curve in curves if curve.of == "loop"]
    loop = answer.loop
    across, up = loop.along(answer.fields)
    known = exact.across
    found = across
    given = up
    named = loop.across
    if loop.finds_force(answer.problem):
        known = exact.up
        found = up
        given = across
        named = loop.up
    sizes = np.abs(known)
    places = {"largest": int(sizes.argmax()), "last": len(sizes) - 1}
    for word, place in places.items():
        if word == "largest" or 0.01 < sizes[place] / sizes.max() < 0.99:
            yield (
                f"{word} {named[0].lower()}",
                named[1],
                float(known[place]),
                float(found[place]),
            )
    if turning_points(given) and (unit := WORKS.get(loop.across[1])):
        start = int(np.argmax(given))
        exact_work, work = (
            float(abs(np.trapezoid(force[start:], over[start:])))
            for force, over in ((exact.up, exact.across), (up, across))
        )
        yield "energy of a cycle", unit, exact_work, work


def opening(answer: Answer) -> Iterator[Number]:
    """Opening of the break of a wire."""
    strand = answer.settings.structure()
    assert isinstance(strand, Rods)
    exact = broken_wire(strand)
    assert exact is not None
    assert strand.broken is not None
    wire, node = strand.broken
    before = (wire - 1) * (strand.elements + 1) + node
    moved = answer.fields.displacement[before : before + 2, -1]
    slip = exact.slip[node:, -1]
    yield (
        "opening of the break",
        "m",
        float(slip[1] - slip[0]),
        float(moved[1] - moved[0]),
    )


def _half_plane(answer: Answer, total: float) -> HalfPlane:
    settings = answer.settings
    return HalfPlane(
        total, settings.radius, settings.young / (1.0 - settings.poisson**2)
    )


def _places(answer: Answer, force: Array) -> tuple[Array, Array]:
    """Lengths of the points of a support, and their places from the middle of a force."""
    law = answer.problem.rubbing["support"]
    middle = law.positions @ force / force.sum()
    return law.by_point(law.weights[:, None])[:, 0], law.positions - middle


def pressed_parabola(answer: Answer) -> Iterator[Number]:
    """Largest pressure, and half-width by the second moment of the pressure."""
    force = answer.support[0][:, -1]
    lengths, places = _places(answer, force)
    exact = _half_plane(answer, float(force.sum()))
    yield "largest pressure", "Pa", exact.peak, (force / lengths).max()
    second = float(force @ places**2 / force.sum())
    yield "half-width of contact", "m", exact.half_width, 2.0 * float(np.sqrt(second))


def sheared_parabola(answer: Answer) -> Iterator[Number]:
    """What sticks as the shear has its first peak, and what a cycle takes.

    The half-width is from the second moments of pressure and friction, as of two square
    roots: a count of nodes would be coarse.
    """
    (pressing, shear) = answer.support
    friction = answer.settings.friction
    first = (answer.settings.instants - 1) // 3
    pressed, held = (np.abs(force[:, first]) for force in (pressing, shear))
    lengths, places = _places(answer, pressed)
    total = float(pressed.sum())
    carried = friction * float(pressed.sum())
    exact = _half_plane(answer, total)
    share = float(held.sum()) / carried
    moments = friction * float(places**2 @ pressed) - float(places**2 @ held)
    stuck = 2.0 * np.sqrt(moments / (carried - held.sum()))
    yield "half-width of stick", "m", exact.stuck(share), stuck
    middle = int(np.argmax(pressed))
    known = float(exact.traction(places[middle : middle + 1], friction, share)[0])
    yield "shear traction in the middle", "Pa", known, held[middle] / lengths[middle]
    slip = np.diff(answer.slip, axis=1)[:, first:]
    total = float(pressing[:, -1].sum())
    share = abs(float(shear[:, -1].sum())) / (friction * total)
    energy = _half_plane(answer, total).energy(friction, share)
    yield "energy of a cycle", "J/m", energy, -np.sum(shear[:, first + 1 :] * slip)


def shoe(answer: Answer) -> Iterator[Number]:
    """Shoe that is pressed over its gap, then pushed to 0.99 and 1.01 of what friction holds."""
    pressed, held = (force.sum(axis=0) for force in answer.support)
    yield "normal reaction", "N/m", 12e6, pressed[1]
    yield "friction at 0.99", "N/m", 3.564e6, held[2]
    yield "displacement at 1.01", "m", 9e-3, -answer.slip[:, 3].mean()


def driven_by_fluid(answer: Answer) -> Iterator[Number]:
    """Front of slip that a fluid drives, over how far this has diffused."""
    own = answer.settings
    lack = own.normal_stress - own.shear_stress / own.friction
    late = slice(own.instants // 2, None)
    diffused = np.sqrt(4.0 * own.diffusivity * own.times()[late])
    place = answer.problem.rubbing["support"].positions
    slip = np.abs(answer.slip[:, late])
    reached = np.array([_front(place, at_instant) for at_instant in slip.T])
    # The pressure is DP erfc(x / sqrt(4 alpha t)) (R. C. Viesca, J. Fluid Mech. 928,
    # A29, 2021).
    far = np.linspace(0.0, 20.0, 20_001)
    (exact,) = fronts(far, (lack / own.overpressure - erfc(far))[:, None])
    yield (
        "front over sqrt(4 alpha t)",
        "-",
        exact,
        reached @ diffused / (diffused @ diffused),
    )


def _front(place: Array, slip: Array) -> float:
    """Where slip ends: towards there its power 2/3 falls evenly, as nothing is singular."""
    last = np.flatnonzero(slip > NO_SLIP * slip.max())[-1]
    near = slice(last - 2, last + 1)
    slope, level = np.polyfit(place[near], slip[near] ** (2.0 / 3.0), 1)
    return float(-level / slope)


def growing_strength(answer: Answer) -> Iterator[Number]:
    """Slip under a strength that grows from the middle, where it is exceeded by all that it grows.

    The last node that slips has no part of its share, half an element, that sticks.
    """
    own = answer.settings
    place = answer.problem.rubbing["support"].positions
    half_length = own.normal_profile[1][0]
    strength = own.friction * own.normal_stress
    stiffness = 0.5 * own.young / (1.0 - own.poisson**2)
    exact = slip_under_growing_strength(
        place, half_length, own.shear_stress - strength, stiffness
    )
    slip = np.abs(answer.slip[:, -1])
    middle = int(np.argmin(np.abs(place - half_length / 2)))
    yield "slip in the middle", "m", exact[0], slip[0]
    yield "slip half-way to the end", "m", exact[middle], slip[middle]


def joint(answer: Answer) -> Iterator[Number]:
    """Slip at the well of a fault that gives way like a joint, and the stiffness that it shows.

    Both bodies are in series with it, and their far sides stay where they are.
    """
    own = answer.settings
    law = answer.problem.rubbing["support"]
    height = own.height
    modulus = 0.5 * own.young / (1.0 + own.poisson)
    stiffness = own.tangential_stiffness
    alone = own.shear_stress / stiffness
    slip = answer.slip[:, -1]
    held = -answer.fields.contact("support").tangential_force[:, -1]
    areas = law.by_point(law.weights)
    exact = alone / (1.0 + modulus / (2.0 * stiffness * height))
    yield "slip at the well", "m", exact, float(slip[0])
    yield (
        "friction per area over slip",
        "N/m^3",
        stiffness,
        float((held / areas / slip).max()),
    )


def _forces(answer: Answer) -> tuple[float, float]:
    """What presses on a brick, and its weight, N/m."""
    settings = answer.settings
    weight = settings.unit_weight * settings.length * settings.height
    return settings.pressure * settings.length, weight


def pile(answer: Answer) -> Iterator[Number]:
    """Shear force of a pile of bricks, which slides at its top, or tips about its toe.

    About the toe what presses, and the weight of the bricks, have half a length.
    """
    settings = answer.settings
    (pressed, brick) = _forces(answer)
    slides = settings.friction * (pressed + brick)
    count = settings.courses
    tips = 0.5 * settings.length * (pressed + count * brick) / (count * settings.height)
    yield (
        "shear force",
        "N/m",
        min(slides, tips),
        float(answer.loop.along(answer.fields)[1][-1]),
    )


def weighed_wall(answer: Answer) -> Iterator[Number]:
    """What the ground carries of a wall."""
    pressed, brick = _forces(answer)
    grounds = [name for name in answer.problem.rubbing if name.startswith("support")]
    across = [answer.fields.contact(name).normal_force for name in grounds]
    force = sum(float(own[:, -1].sum()) for own in across if own is not None)
    yield "force on the ground", "N/m", 4.0 * (pressed + 4.0 * brick), force


def moved_end(answer: Answer) -> Iterator[Number]:
    """Force that moves an end of a rod whose other end is free: sqrt(2 E S mu p u)."""
    rods = answer.settings.structure()
    assert isinstance(rods, Rods)
    assert rods.right.displacement is not None
    bound = float(rods.bound.max())
    known = np.sqrt(2.0 * rods.stiffness * bound * float(rods.right.displacement[-1]))
    found = rods.end_force(answer.problem, "right").of(answer.fields)
    yield "force at the moved end", "N", float(known), float(found[-1])


def on_slope(answer: Answer) -> Iterator[Number]:
    """Part of the weight that presses on a slope where it is steepest, whatever a spring pulls."""
    own = answer.settings
    angle = np.radians(own.path("slope_load"))
    steepest = int(angle.argmax())
    known = own.weight * float(np.cos(angle[steepest]))
    yield "pressing force", "N/m", known, float(answer.support[0][:, steepest].sum())


def pushed_block(answer: Answer) -> Iterator[Number]:
    """Forces and moments of the side that pushes a block under pressure, and of its support."""
    own = answer.settings
    problem = answer.problem
    fields = answer.fields
    load = -own.top_normal_traction * own.length
    pressing = answer.support[0][:, -1]
    push = reaction(problem, "left", 0).of(fields)
    moment = reaction_moment(problem, "left").of(fields)
    around_foot = float(moment[-1] + problem.rubbing["support"].positions @ pressing)
    yield "force at the pushed side", "N/m", own.friction * load, float(push[-1])
    yield "pressing force", "N/m", load, float(pressing.sum())
    yield "moment of both about the foot", "N", 0.5 * load * own.length, around_foot
