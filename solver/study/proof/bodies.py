"""Cases of bodies in the plane: contacts, a slope, a leaf spring, faults, walls of bricks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.discrete.contact_groups import NO_SLIP
from solver.reference.closed_forms.elastic_bodies import (
    HalfPlane,
    TwoLeaves,
    cantilever,
    leaf_spring,
)
from solver.reference.closed_forms.fluid_driven_slip import (
    front_over_diffusion,
    slip_under_growing_strength,
)
from solver.study.proof.known_case import PUBLISHED, Answer, KnownCase, Number

JOHNSON = "K. L. Johnson, Contact Mechanics, Cambridge 1985, section"
HERTZ = f"{JOHNSON} 4.2 (Hertz)"
MINDLIN = f"{JOHNSON} 7.2 and 7.4 (Cattaneo, Mindlin)"
SLOPE = "Equilibrium of a rigid block: its weight along the slope, less or more its friction"
PILE = (
    "R. K. Livesley, Limit analysis of structures formed from rigid blocks, Int. J. Numer. Meth. "
    "Eng. 12, 1978: a pile slides where friction ends, and tips about its toe"
)
BEAM = "J. M. Gere, S. P. Timoshenko, Mechanics of Materials, 1997, section 12: Timoshenko's beam"
GOODMAN = (
    "L. E. Goodman, J. H. Klumpp, Analysis of slip damping with reference to turbine-blade "
    "vibration, J. Appl. Mech. 23, 421-429, 1956"
)
LEAVES = "From first principles: beams whose deflections agree where the shorter ones end"
BALANCE = "Balance: the ground carries what weighs and presses"
SHOE = (
    "code_aster, V6.04.503: SSNV503, Patin glissant sur un plan rigide, section 2 (reference "
    "solution, analytical; the shoe's own deformation neglected); E and nu of its input file"
)
VIESCA = (
    "R. C. Viesca, Self-similar fault slip in response to fluid injection, J. Fluid Mech. 928, "
    "A29, 2021 (arXiv:2102.03123)"
)
BUERGMANN = (
    "R. Buergmann, D. D. Pollard, S. J. Martel, Slip distributions on faults: effects of stress "
    "gradients, inelastic deformation, heterogeneous host-rock stiffness, and fault interaction, "
    "J. Struct. Geol. 16, 1675-1690, 1994"
)
STEPS = 6
"""Instants of a quarter of a cycle of shear."""
PRESSED = {
    **{"gap": "parabola", "radius": 10.0, "length": 1.0, "height": 1.0, "friction": 0.0},
    **{"elements": 80, "elements_up": 80, "instants": 1, "top": "traction"},
    "top_normal_traction": -181.246e6,
}
"""By the pressure of which half the contact is a tenth of the body's length."""
SHEAR = 6.59647e6
"""Pa: half of what friction carries on a half-width of a tenth of the length."""
SHEARED = {
    **{"gap": "parabola", "radius": 5.0, "length": 0.1, "height": 0.1, "poisson": 0.4999},
    **{"friction": 0.3, "elements": 120, "elements_up": 60, "top": "pushed"},
    **{"duration": 6.0, "instants": 6 * STEPS + 1},
    "top_normal_load": [[0.0, 0.0], [1.0, -3.31e-5]],
    "top_tangential_load": [[1.0, 0.0], [2.0, SHEAR], [4.0, -SHEAR], [6.0, SHEAR]],
}
THREE = {
    **{"layers": 3, "length": 0.5, "thickness": 0.01, "plane": "stress"},
    **{"elements": 48, "elements_up": 2, "instants": 3, "deflection": 1e-4},
    "bend_load": [[0.0, 0.0], [0.5, 0.0], [1.0, 1e-4]],
}
FREE = {**THREE, "friction": 0.0, "pressure": 1e5, "pressure_load": [[0.0, 1e5], [1.0, 1e5]]}
GLUED = {**THREE, "friction": 10.0, "pressure": 1e6, "pressure_load": [[0.0, 1e6], [1.0, 1e6]]}
TWO = TwoLeaves(0.5, 0.01, 210e9, 0.0, 0.3 * 2e6)
MOST = 2.0 * TWO.first_slip
"""Force on two leaves, back and forth, N/m."""
DAMPED = {
    **{"layers": 2, "length": 0.5, "thickness": 0.01, "plane": "stress", "poisson": 0.0},
    **{"elements": 32, "instants": 41, "pressure_load": [[0.0, 2e6]], "bending": "force"},
    "bend_load": [[0.0, 0.0], [0.2, MOST], [0.6, -MOST], [1.0, MOST]],
}
GRADUATED = {
    **{"layers": 3, "length": 0.5, "thickness": 0.005, "plane": "stress", "friction": 0.0},
    **{"layer_lengths": "graduated", "pressure": 0.0, "elements": 48, "instants": 3},
    **{"bending": "force", "force": 100.0, "bend_load": "ramp"},
}
"""Three leaves of which each is shorter, on each other without friction or pressure."""
PATIN = {
    **{"friction": 0.3, "gap": [[0.0, 2e-3], [0.04, 2e-3]], "spring": 4e6, "accuracy": 1e-3},
    **{"top": "traction", "top_normal_traction": -300e6, "top_normal_load": [[0.0, -300e6]]},
    "right": "traction",
    "right_normal_load": [[1.0, 0.0], [2.0, -178.2e6], [3.0, -181.8e6]],
    **{"duration": 3.0, "instants": 4, "length": 0.04, "height": 0.02, "poisson": 0.0},
    **{"elements": 8, "elements_up": 4, "substructures": 1, "substructures_up": 1},
}
"""A shoe pressed over its gap, then pushed to 0.99 and 1.01 of what friction holds."""
FRICTION, NORMAL, FLUID, SPREADS = 0.6, 1e7, 8e6, 0.1
"""Of a fault: coefficient, Pa, Pa and m^2/s."""
LENGTH, REACHED = 600.0, 0.25
"""m: of the body; and the share of it that the front reaches."""
FAULT: dict[str, Any] = {
    **{"friction": FRICTION, "normal_stress": NORMAL, "diffusivity": SPREADS},
    **{"length": LENGTH, "height": LENGTH, "elements": 96, "elements_up": 48},
    **{"substructures": 8, "substructures_up": 4, "accuracy": 1e-3},
}
ZONE, STRENGTH, DROP = 10, FRICTION * NORMAL, 6e5
"""Elements that slip under a strength that grows; that in the middle, and what it grows by, Pa."""
HALF = ZONE * LENGTH / 96
GROWING = {
    **{**FAULT, "overpressure": 0.0, "shear_stress": STRENGTH + DROP, "instants": 1},
    "normal_profile": [
        [0.0, 1.0],
        [HALF, 1.0 + DROP / STRENGTH],
        # The last node that slips has no part of its share, half an element, that sticks.
        [HALF * (1.0 + 0.5 / ZONE), 1.0 + DROP / STRENGTH],
        [HALF * (1.0 + 0.501 / ZONE), 2.0],
    ],
}
BRICKS = {
    **{"bond": "stack", "length": 0.25, "height": 0.12, "unit_weight": 2e4, "pressure": 1e6},
    **{"friction": 0.3, "elements": 8, "elements_up": 4, "instants": 21, "accuracy": 1e-3},
}
SLIDES = {"bricks": 1, "courses": 2, "top_load": [[0.0, 0.0], [0.25, 0.0], [1.0, 3e-4]]}
TIPS = {"bricks": 1, "courses": 3, "top_load": [[0.0, 0.0], [0.25, 0.0], [1.0, 3e-3]]}
RUNNING = {"bond": "running", "bricks": 4, "courses": 4, "displacement": 5e-5}


def body_cases() -> list[KnownCase]:
    """Cases, none of them solved yet."""
    slope = {"elements": 12, "elements_up": 6, "instants": 41}
    leaf = "leaf spring whose leaves touch at their ends"
    grows = "slip under a strength that grows from the middle"
    tips = {**BRICKS, **TIPS, "friction": 0.9}
    return [
        KnownCase("parabola pressed on a plane", HERTZ, 2e-2, "block", PRESSED, _pressed),
        KnownCase("parabola sheared to and fro", MINDLIN, 7e-2, "block", SHEARED, _sheared),
        KnownCase("block on a slope, caught by a spring", SLOPE, 1e-7, "incline", slope, _tilted),
        KnownCase("three layers without friction", BEAM, 5e-3, "layers", FREE, _bent),
        KnownCase("three layers that friction glues", BEAM, 5e-3, "layers", GLUED, _bent),
        KnownCase("spring of two leaves", GOODMAN, 1e-2, "layers", DAMPED, _damped),
        KnownCase(leaf, LEAVES, 5e-3, "layers", GRADUATED, _graduated),
        KnownCase(
            "shoe on a rigid plane (SSNV503)", SHOE, 1e-2, "block", PATIN, _pushed, PUBLISHED
        ),
        *map(_driven_by_fluid, (0.1, 0.3, 0.5, 0.7, 0.9)),
        KnownCase(grows, BUERGMANN, 4e-2, "fault", GROWING, _grown, PUBLISHED),
        KnownCase(
            "pile of two bricks that slides", PILE, 1e-8, "wall", {**BRICKS, **SLIDES}, _slid
        ),
        KnownCase("pile of three bricks that tips", PILE, 1e-8, "wall", tips, _tipped),
        KnownCase("wall in running bond", BALANCE, 1e-8, "wall", {**BRICKS, **RUNNING}, _carried),
    ]


def _half_plane(answer: Answer, total: float) -> HalfPlane:
    settings = answer.settings
    return HalfPlane(total, settings.radius, settings.young / (1.0 - settings.poisson**2))


def _places(answer: Answer, force: Array) -> tuple[Array, Array]:
    """Lengths of the points of a support, and their places from the middle of a force."""
    law = answer.problem.rubbing["support"]
    middle = law.positions @ force / force.sum()
    return law.by_point(law.weights[:, None])[:, 0], law.positions - middle


def _pressed(answer: Answer) -> Iterator[Number]:
    force = answer.support[0][:, -1]
    lengths, places = _places(answer, force)
    exact = _half_plane(answer, float(force.sum()))
    yield "largest pressure", "Pa", exact.peak, (force / lengths).max()
    second = force @ places**2 / force.sum()
    yield "half-width of contact", "m", exact.half_width, 2.0 * np.sqrt(second)


def _sheared(answer: Answer) -> Iterator[Number]:
    """What sticks as the shear has its first peak, and what a cycle takes.

    The half-width is from the second moments of pressure and friction, as of two square roots: a
    count of nodes would be coarse.
    """
    (pressing, shear), friction = answer.support, answer.settings.friction
    pressed, held = (np.abs(force[:, 2 * STEPS]) for force in (pressing, shear))
    lengths, places = _places(answer, pressed)
    total, carried = float(pressed.sum()), friction * float(pressed.sum())
    exact, share = _half_plane(answer, total), float(held.sum()) / carried
    moments = friction * float(places**2 @ pressed) - float(places**2 @ held)
    stuck = 2.0 * np.sqrt(moments / (carried - held.sum()))
    yield "half-width of stick", "m", exact.stuck(share), stuck
    middle = int(np.argmax(pressed))
    known = float(exact.traction(places[middle : middle + 1], friction, share)[0])
    yield "shear traction in the middle", "Pa", known, held[middle] / lengths[middle]
    slip = np.diff(answer.slip, axis=1)[:, 2 * STEPS :]
    total = float(pressing[:, -1].sum())
    share = abs(float(shear[:, -1].sum())) / (friction * total)
    energy = _half_plane(answer, total).energy(friction, share)
    yield "energy of a cycle", "J/m", energy, -np.sum(shear[:, 2 * STEPS + 1 :] * slip)


def _tilted(answer: Answer) -> Iterator[Number]:
    settings, force = answer.settings, answer.loop_force
    angle = np.radians(answer.loop_displacement)
    down, across = settings.weight * np.sin(angle), settings.weight * np.cos(angle)
    top = int(np.argmax(angle))
    carried = down[top] - settings.friction * across[top]
    yield "force of the spring, up", "N", carried, force[top]
    returning = down + settings.friction * across
    back = top + int(np.argmax(returning[top:] < 0.9 * carried))
    yield "force of the spring, back", "N", returning[back], force[back]


def _bent(answer: Answer) -> Iterator[Number]:
    """Layers that friction glues are one beam."""
    settings, (before, bent) = answer.settings, answer.loop_force[-2:]
    beams, height = (1, 3 * settings.thickness) if settings.friction else (3, settings.thickness)
    exact = beams * cantilever(settings.length, height, settings.young, settings.poisson)
    yield "bending stiffness", "N/m", exact, abs(bent - before) / settings.deflection


def _damped(answer: Answer) -> Iterator[Number]:
    bent, cycle = answer.loop_displacement, answer.settings.times() >= 0.2
    energy = abs(float(np.trapezoid(answer.settings.path("bend_load")[cycle], bent[cycle])))
    yield "energy of a cycle", "J/m", TWO.energy(MOST), energy
    yield "largest deflection", "m", TWO.deflection(MOST), float(bent.max())


def _graduated(answer: Answer) -> Iterator[Number]:
    settings, factor = answer.settings, leaf_spring(np.array([3.0, 2.0, 1.0]))
    assert factor is not None
    leaf = cantilever(settings.length, settings.thickness, settings.young, settings.poisson)
    yield "stiffness", "N/m", factor * leaf, settings.force / float(answer.loop_displacement[-1])


def _pushed(answer: Answer) -> Iterator[Number]:
    pressed, held = (force.sum(axis=0) for force in answer.support)
    yield "normal reaction", "N/m", 12e6, pressed[1]
    yield "friction at 0.99", "N/m", 3.564e6, held[2]
    yield "displacement at 1.01", "m", 9e-3, -answer.slip[:, 3].mean()


def _driven_by_fluid(stress: float) -> KnownCase:
    """A fluid let in until the front has reached its share of the body."""
    exact = front_over_diffusion(stress)
    values = {
        **{**FAULT, "overpressure": FLUID, "instants": 41},
        "shear_stress": FRICTION * (NORMAL - stress * FLUID),
        "duration": float(f"{(REACHED * LENGTH / exact) ** 2 / (4.0 * SPREADS):.6g}"),
    }

    def numbers(answer: Answer) -> Iterator[Number]:
        late = slice(answer.settings.instants // 2, None)
        diffused = np.sqrt(4.0 * SPREADS * answer.settings.times()[late])
        place, slip = answer.problem.rubbing["support"].positions, np.abs(answer.slip[:, late])
        reached = np.array([_front(place, own) for own in slip.T])
        yield "front over sqrt(4 alpha t)", "-", exact, reached @ diffused / (diffused @ diffused)

    title = f"slip front driven by a fluid, T = {stress:g}"
    return KnownCase(title, VIESCA, 1.2e-2, "fault", values, numbers, PUBLISHED)


def _front(place: Array, slip: Array) -> float:
    """Where slip ends: towards there its power 2/3 falls evenly, as nothing is singular."""
    last = np.flatnonzero(slip > NO_SLIP * slip.max())[-1]
    near = slice(last - 2, last + 1)
    slope, level = np.polyfit(place[near], slip[near] ** (2.0 / 3.0), 1)
    return float(-level / slope)


def _grown(answer: Answer) -> Iterator[Number]:
    stiffness = 0.5 * answer.settings.young / (1.0 - answer.settings.poisson**2)
    place = answer.problem.rubbing["support"].positions
    exact = slip_under_growing_strength(place, HALF, DROP, stiffness)
    slip = 2.0 * np.abs(answer.slip[:, -1])
    yield "slip in the middle", "m", exact[0], slip[0]
    yield "slip half-way to the end", "m", exact[ZONE // 2], slip[ZONE // 2]


def _forces(settings: Any) -> tuple[float, float]:
    """What presses on a brick, and its weight, N/m."""
    weight = settings.unit_weight * settings.length * settings.height
    return settings.pressure * settings.length, weight


def _slid(answer: Answer) -> Iterator[Number]:
    held = answer.settings.friction * sum(_forces(answer.settings))
    yield "shear force", "N/m", held, answer.loop_force[-1]


def _tipped(answer: Answer) -> Iterator[Number]:
    """Moments about the toe: what presses, and the weight, have half a length."""
    settings, (pressed, brick) = answer.settings, _forces(answer.settings)
    held = 0.5 * settings.length * (pressed + 3.0 * brick) / (3.0 * settings.height)
    yield "shear force", "N/m", held, answer.loop_force[-1]


def _carried(answer: Answer) -> Iterator[Number]:
    pressed, brick = _forces(answer.settings)
    grounds = [name for name in answer.problem.rubbing if name.startswith("support")]
    across = [answer.fields.contact(name).normal_force for name in grounds]
    force = sum(float(own[:, -1].sum()) for own in across if own is not None)
    yield "force on the ground", "N/m", 4.0 * (pressed + 4.0 * brick), force
