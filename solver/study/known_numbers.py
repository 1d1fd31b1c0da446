"""Known numbers and computed ones: the functions named in `known_numbers.toml`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from solver.arrays import Array
from solver.discrete.contact_groups import NO_SLIP
from solver.discrete.probes import LoopFields, reaction, reaction_moment
from solver.discrete.problem import Problem
from solver.discrete.structure import Loop
from solver.latin import Solution
from solver.laws import Contact
from solver.reference.closed_forms.elastic_bodies import HalfPlane
from solver.reference.closed_forms.fluid_driven_slip import (
    fronts,
    slip_under_growing_strength,
)
from solver.reference.closed_forms.pulled_bar import broken_wire
from solver.study.quantities.cycles import turning_points

WORKS = {"m": "J", "1/m": "J/m"}
"""Unit of the area of a loop by the unit of its abscissa, where the area is work."""


@dataclass(frozen=True, eq=False)
class SolvedCase:
    """A problem with its settings, and the fields of a run or of a reference."""

    settings: Any
    problem: Problem
    fields: LoopFields
    solution: Solution | None = None

    @property
    def support(self) -> tuple[Array, Array]:
        """Pressing force and friction on a support, (n_points, n_instants) each, N."""
        contact = self.fields.contact("support")
        return self.pressing("support"), contact.tangential_force

    def pressing(self, name: str) -> Array:
        """Pressing force of an interface that opens, (n_points, n_instants), N."""
        force = self.fields.contact(name).normal_force
        assert force is not None
        return force

    @property
    def slip(self) -> Array:
        """Slip on a support, shape (n_points, n_instants), m."""
        return self.fields.contact("support").slip

    @property
    def loop(self) -> Loop:
        """Loop that the scene shows."""
        loop: Loop = self.settings.structure().loop(self.problem)
        return loop


Number = tuple[str, str, float, float]
"""Quantity, unit, known value, and value of an answer."""


def loop(answer: SolvedCase) -> Iterator[Number]:
    """Largest and last value of the found quantity of a loop, and its work in a cycle.

    The cycle begins at the first largest value of the prescribed quantity.
    """
    curves = answer.settings.exact(answer.problem, answer.fields)
    (exact,) = [curve for curve in curves if curve.of == "loop"]
    loop = answer.loop
    across, up = loop.along(answer.fields)
    if loop.finds_force(answer.problem):
        yield from _values_of_loop(*loop.up, exact.up, up)
        given = across
    else:
        yield from _values_of_loop(*loop.across, exact.across, across)
        given = up
    unit = WORKS.get(loop.across[1])
    if turning_points(given) and unit:
        # From the first peak on the path repeats; the first loading is no part of a
        # cycle.
        start = int(np.argmax(given))
        known = _area(exact.up, exact.across, start)
        found = _area(up, across, start)
        yield "energy of a cycle", unit, known, found


def _values_of_loop(
    title: str, unit: str, known: Array, found: Array
) -> Iterator[Number]:
    """Largest and last value of a quantity, known and found, (n_instants,) each."""
    name = title.lower()
    sizes = np.abs(known)
    largest = int(sizes.argmax())
    yield f"largest {name}", unit, float(known[largest]), float(found[largest])
    # A last value that is zero, or the largest one again, is no test.
    if 0.01 < sizes[-1] / sizes.max() < 0.99:
        yield f"last {name}", unit, float(known[-1]), float(found[-1])


def _area(force: Array, over: Array, start: int) -> float:
    """Work of a force over its abscissa, (n_instants,) each, from an instant on."""
    return float(abs(np.trapezoid(force[start:], over[start:])))


def opening(answer: SolvedCase) -> Iterator[Number]:
    """Opening of the break of a wire, known and found."""
    strand = answer.settings.structure()
    exact = broken_wire(strand)
    assert exact is not None
    wire, node = strand.broken
    # Both nodes of the break stand one after the other.
    before = (wire - 1) * (strand.elements + 1) + node
    displacement = answer.fields.displacement[before : before + 2, -1]
    slip = exact.slip[node:, -1]
    known = float(slip[1] - slip[0])
    found = float(displacement[1] - displacement[0])
    yield "opening of the break", "m", known, found


def _half_plane(answer: SolvedCase, total: float) -> HalfPlane:
    """Closed form of a cylinder on a half-plane under a total force, N/m."""
    settings = answer.settings
    modulus = settings.young / (1.0 - settings.poisson**2)
    return HalfPlane(total, settings.radius, modulus)


def _points(law: Contact, force: Array) -> tuple[Array, Array]:
    """Tributary lengths of a contact's points, and distances from a force's centre.

    The force has shape (n_points,), and so have both results, m.
    """
    middle = law.positions @ force / force.sum()
    return law.by_point(law.weights[:, None])[:, 0], law.positions - middle


def pressed_parabola(answer: SolvedCase) -> Iterator[Number]:
    """Largest pressure, and half-width of contact, of a cylinder on a half-plane."""
    force = answer.support[0][:, -1]
    exact = _half_plane(answer, float(force.sum()))
    yield from _pressed(answer.problem.contacts["support"], force, exact)


def _pressed(law: Contact, force: Array, exact: HalfPlane) -> Iterator[Number]:
    """Largest pressure, and half-width by the second moment of the pressure.

    The pressing force of the points of a contact has the shape (n_points,), N/m.
    """
    lengths, distances = _points(law, force)
    yield "largest pressure", "Pa", exact.peak, float((force / lengths).max())
    found = _half_width(distances, force)
    yield "half-width of contact", "m", exact.half_width, found


def _half_width(distances: Array, force: Array) -> float:
    """Half-width of an elliptic distribution of forces, m, by their second moment.

    A count of nodes would be coarse. The distances from the middle, m, and the forces
    have the shape (n_points,).
    """
    return float(2.0 * np.sqrt(force @ distances**2 / force.sum()))


def sheared_parabola(answer: SolvedCase) -> Iterator[Number]:
    """Stick zone and traction at the first peak of the shear, and energy of a cycle."""
    # A third of the instants leads to the first peak, and a cycle follows.
    first = (answer.settings.instants - 1) // 3
    yield from _peak_of_shear(answer, first)
    yield _energy_of_shear(answer, first)


def _peak_of_shear(answer: SolvedCase, first: int) -> Iterator[Number]:
    """Half-width of stick, and traction in the middle, at a peak of the shear."""
    pressing, shear = answer.support
    friction = answer.settings.friction
    pressed = np.abs(pressing[:, first])
    held = np.abs(shear[:, first])
    lengths, distances = _points(answer.problem.contacts["support"], pressed)
    exact = _half_plane(answer, float(pressed.sum()))
    share = float(held.sum()) / (friction * float(pressed.sum()))
    # Friction lacks an ellipse as wide as the stick zone to its bound.
    stuck = _half_width(distances, friction * pressed - held)
    yield "half-width of stick", "m", exact.stuck(share), stuck
    middle = int(np.argmax(pressed))
    tractions = exact.traction(distances[middle : middle + 1], friction, share)
    found = held[middle] / lengths[middle]
    yield "shear traction in the middle", "Pa", float(tractions[0]), found


def _energy_of_shear(answer: SolvedCase, first: int) -> Number:
    """Energy of a cycle of the shear, after its first peak."""
    pressing, shear = answer.support
    friction = answer.settings.friction
    # Friction works on the slip of each instant, against it.
    slip = np.diff(answer.slip, axis=1)[:, first:]
    total = float(pressing[:, -1].sum())
    share = abs(float(shear[:, -1].sum())) / (friction * total)
    known = _half_plane(answer, total).energy(friction, share)
    found = -np.sum(shear[:, first + 1 :] * slip)
    return "energy of a cycle", "J/m", known, found


def shoe(answer: SolvedCase) -> Iterator[Number]:
    """Shoe pressed over its gap, then pushed to 0.99 and 1.01 of the friction bound."""
    pressed, held = (force.sum(axis=0) for force in answer.support)
    yield "normal reaction", "N/m", 12e6, pressed[1]
    yield "friction at 0.99", "N/m", 3.564e6, held[2]
    yield "displacement at 1.01", "m", 9e-3, -answer.slip[:, 3].mean()


def driven_by_fluid(answer: SolvedCase) -> Iterator[Number]:
    """Front of fluid-driven slip over the diffusion length."""
    settings = answer.settings
    late = slice(settings.instants // 2, None)
    diffused = np.sqrt(4.0 * settings.diffusivity * settings.times()[late])
    positions = answer.problem.contacts["support"].positions
    slip = np.abs(answer.slip[:, late])
    found = np.array([_front(positions, at_instant) for at_instant in slip.T])
    ratio = found @ diffused / (diffused @ diffused)
    yield "front over sqrt(4 alpha t)", "-", _known_front(settings), ratio


def _known_front(settings: Any) -> float:
    """Front of slip over sqrt(4 alpha t).

    The pressure is DP erfc(x / sqrt(4 alpha t)).
    R. C. Viesca, J. Fluid Mech. 928, A29, 2021.
    """
    reserve = settings.normal_stress - settings.shear_stress / settings.friction
    positions = np.linspace(0.0, 20.0, 20_001)
    strength = reserve / settings.overpressure - scipy.special.erfc(positions)
    (front,) = fronts(positions, strength[:, None])
    return float(front)


def _front(positions: Array, slip: Array) -> float:
    """Position where slip ends, m: linear extrapolation of its power 2/3 to zero.

    Positions, m, and slip, m, have shape (n_points,). The power is straight near the
    front, where no stress is singular.
    """
    last = np.flatnonzero(slip > NO_SLIP * slip.max())[-1]
    near = slice(last - 2, last + 1)
    slope, level = np.polyfit(positions[near], slip[near] ** (2.0 / 3.0), 1)
    return float(-level / slope)


def growing_strength(answer: SolvedCase) -> Iterator[Number]:
    """Slip of a zone whose strength grows from the middle beyond the load.

    The closed form leaves out that the last node that slips represents half an element
    that sticks.
    """
    settings = answer.settings
    positions = answer.problem.contacts["support"].positions
    half_length = settings.normal_profile[1][0]
    strength = settings.friction * settings.normal_stress
    excess = settings.shear_stress - strength
    stiffness = 0.5 * settings.young / (1.0 - settings.poisson**2)
    exact = slip_under_growing_strength(positions, half_length, excess, stiffness)
    slip = np.abs(answer.slip[:, -1])
    middle = int(np.argmin(np.abs(positions - half_length / 2)))
    yield "slip in the middle", "m", exact[0], slip[0]
    yield "slip half-way to the end", "m", exact[middle], slip[middle]


def joint(answer: SolvedCase) -> Iterator[Number]:
    """Slip at the well of a fault with compliant contact, and its stiffness.

    Both bodies are in series with the joint, and their far sides do not move.
    """
    settings = answer.settings
    law = answer.problem.contacts["support"]
    modulus = 0.5 * settings.young / (1.0 + settings.poisson)
    stiffness = settings.tangential_stiffness
    alone = settings.shear_stress / stiffness
    slip = answer.slip[:, -1]
    held = -answer.fields.contact("support").tangential_force[:, -1]
    areas = law.by_point(law.weights)
    known = alone / (1.0 + modulus / (2.0 * stiffness * settings.height))
    yield "slip at the well", "m", known, float(slip[0])
    found = float((held / areas / slip).max())
    yield "friction per area over slip", "N/m^3", stiffness, found


def _forces(answer: SolvedCase) -> tuple[float, float]:
    """Pressing force on a brick, and weight of a brick, N/m."""
    settings = answer.settings
    weight = settings.unit_weight * settings.length * settings.height
    return settings.pressure * settings.length, weight


def pile(answer: SolvedCase) -> Iterator[Number]:
    """Shear force of a pile of bricks, which slides at the top, or tips.

    About the toe the pressing force, and the weight of the bricks, have a lever of half
    a length.
    """
    settings = answer.settings
    pressing, brick = _forces(answer)
    # The top brick presses least, so it slides first.
    slides = settings.friction * (pressing + brick)
    count = settings.courses
    total = pressing + count * brick
    tips = 0.5 * settings.length * total / (count * settings.height)
    _, force = answer.loop.along(answer.fields)
    yield "shear force", "N/m", min(slides, tips), float(force[-1])


def weighed_wall(answer: SolvedCase) -> Iterator[Number]:
    """Force of a wall on the ground, under its weight and a pressure."""
    pressing, brick = _forces(answer)
    found = 0.0
    for name in answer.problem.contacts:
        if name.startswith("support"):
            found += float(answer.pressing(name)[:, -1].sum())
    yield "force on the ground", "N/m", 4.0 * (pressing + 4.0 * brick), found


def corbelled_wall(answer: SolvedCase) -> Iterator[Number]:
    """Force on settled ground below n bricks of a wall in running bond.

    Each course reaches over the gap by half a brick at both ends, held down by what
    presses on it: n bricks of the lowest course fall with the ground, n - 1 of the next
    one, and so on, as long as the arch passes above them: in four courses over three
    bricks it passes through the tip of this triangle, and holds a brick.
    """
    settings = answer.settings
    _, brick = _forces(answer)
    count = round(settings.settled_length / settings.length)
    _, force = answer.loop.along(answer.fields)
    known = 0.5 * count * (count + 1) * brick
    yield "force on the settled ground", "N/m", known, float(force[-1])


def arch_thrust(answer: SolvedCase) -> Iterator[Number]:
    """Thrust of an arch over its weight, after a large movement of an abutment.

    The least where it has moved apart, the largest where it has moved inwards.
    """
    moved, thrust = answer.loop.along(answer.fields)
    weight = answer.settings.structure().downwards[-1]
    known, largest = answer.settings.statics.thrusts()
    if moved[-1] < 0.0:
        known = largest
    yield "thrust over weight", "", known, float(thrust[-1] / weight)


def tensions(answer: SolvedCase) -> Iterator[Number]:
    """Tension of a band at the end of the run: at both ends, largest and smallest."""
    curves = answer.settings.exact(answer.problem, answer.fields)
    (exact,) = [curve for curve in curves if curve.of == "axial force"]
    band = answer.settings.structure()
    found = band.tensions(answer.problem, answer.fields)[:, -1]
    known = exact.up[:, -1]
    # The spans carry the tensions of the ends.
    yield "tension of the tail", "N", float(known[0]), float(found[0])
    yield "tension of the pulled end", "N", float(known[-1]), float(found[-1])
    yield "largest tension", "N", float(known.max()), float(found.max())


def pressed_wires(answer: SolvedCase) -> Iterator[Number]:
    """Largest pressure, and half-width, of the most loaded contact of two wires."""
    settings = answer.settings
    joints = settings.structure().joints
    forces = {}
    for joint in joints:
        if joint.below is not None and joint.above < settings.n_wires:
            forces[joint.name] = answer.pressing(joint.name)[:, -1]
    name = max(forces, key=lambda name: float(forces[name].sum()))
    exact = settings.hertz(float(forces[name].sum()))
    yield from _pressed(answer.problem.contacts[name], forces[name], exact)


def moved_end(answer: SolvedCase) -> Iterator[Number]:
    """Force that moves an end of a rod with a free other end: sqrt(2 E S mu p u)."""
    rods = answer.settings.structure()
    strength = float(rods.strength.max())
    known = np.sqrt(
        2.0 * rods.stiffness * strength * float(rods.right.displacement[-1])
    )
    found = rods.end_force(answer.problem, "right").of(answer.fields)
    yield "force at the moved end", "N", float(known), float(found[-1])


def on_slope(answer: SolvedCase) -> Iterator[Number]:
    """Normal force over the weight on a slope at its steepest.

    The pull of a spring along the slope does not change it.
    """
    settings = answer.settings
    angle = np.radians(settings.path("slope_load"))
    steepest = int(angle.argmax())
    known = settings.weight * float(np.cos(angle[steepest]))
    yield "pressing force", "N/m", known, float(answer.support[0][:, steepest].sum())


def pushed_block(answer: SolvedCase) -> Iterator[Number]:
    """Forces and moments of the pushed side of a block, and of its support."""
    settings = answer.settings
    problem = answer.problem
    fields = answer.fields
    load = -settings.top_normal_traction * settings.length
    pressing = answer.support[0][:, -1]
    push = reaction(problem, "left", 0).of(fields)
    moment = reaction_moment(problem, "left").of(fields)
    # The foot is at the origin, at the left end of the support.
    around_foot = float(moment[-1] + problem.contacts["support"].positions @ pressing)
    # The block slides, so its support carries all that friction can.
    held = settings.friction * load
    yield "force at the pushed side", "N/m", held, float(push[-1])
    yield "pressing force", "N/m", load, float(pressing.sum())
    known = 0.5 * load * settings.length
    yield "moment of both about the foot", "N", known, around_foot


def dovetail(answer: SolvedCase) -> Iterator[Number]:
    """Normal force on each flank of a dovetail that a known force pulls and lets go.

    Both flanks slip all along; the friction on the root points down while it is pulled,
    and up while it goes back.
    """
    settings = answer.settings
    tractions = settings.path("load")
    turned = int(tractions.argmax())
    back = turned + (len(tractions) - turned) * 4 // 5
    side = next(side for side in settings.parts.sides if side.name.startswith("top"))
    width = settings.parts.shapes[side.body].shares(side.nodes).sum()
    across, upward = np.abs(settings.parts.contacts[0].normals[0])
    for instant, sign, words in ((turned, 1.0, "pulled"), (back, -1.0, "let go")):
        carried = 2.0 * (upward + sign * settings.friction * across)
        known = tractions[instant] * width / carried
        found = _mean_of_flanks(answer, instant)
        yield f"normal force of a flank, {words}", "N", float(known), found


def _mean_of_flanks(answer: SolvedCase, instant: int) -> float:
    """Mean of the normal forces of all contacts of a mesh at an instant, N."""
    names = [contact.name for contact in answer.settings.parts.contacts]
    forces = [answer.pressing(name)[:, instant].sum() for name in names]
    return float(np.mean(forces))
