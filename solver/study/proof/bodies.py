"""Cases of bodies in the plane: contacts, a slope, a leaf spring, faults."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from solver.arrays import Array
from solver.discrete.contacts import NO_SLIP
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
from solver.scenes import loop_of
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
DEFLECTION = 1e-4
STEPS = 6
"""Instants of a quarter of a cycle of shear."""
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
FRICTION, PRESSED, FLUID, SPREADS = 0.6, 1e7, 8e6, 0.1
"""Coefficient, Pa, Pa and m^2/s."""
LENGTH, REACHED = 600.0, 0.25
"""m: of the body; and the share of it that the front reaches."""
FAULT = {
    **{"friction": FRICTION, "normal_stress": PRESSED, "diffusivity": SPREADS},
    **{"length": LENGTH, "height": LENGTH, "elements": 96, "elements_up": 48},
    **{"substructures": 8, "substructures_up": 4},
    "accuracy": 1e-3,
}
ZONE, STRENGTH, DROP = 10, FRICTION * PRESSED, 6e5
"""Elements that slip under a strength that grows; that in the middle, and what it grows by, Pa."""
STUCK = 2.0
"""Strength of what must not slip, over that of what may."""


def body_cases() -> list[KnownCase]:
    """Cases, none of them solved yet."""
    total = np.pi * 210e9 / (1.0 - 0.3**2) * 0.1**2 / (4.0 * 10.0)
    pressed = {
        **{"gap": "parabola", "radius": 10.0, "length": 1.0, "height": 1.0},
        **{"elements": 80, "elements_up": 80, "friction": 0.0, "instants": 1},
        **{"top": "traction", "top_normal_traction": -float(f"{total:.6g}")},
    }
    half_width, radius, friction, length = 0.01, 5.0, 0.3, 0.1
    modulus = 210e9 / (1.0 - 0.4999**2)
    shear = float(f"{0.125 * friction * np.pi * modulus * half_width**2 / radius / length:.6g}")
    sheared = {
        **{"gap": "parabola", "radius": radius, "length": length, "height": length},
        **{"poisson": 0.4999, "friction": friction, "elements": 120, "elements_up": 60},
        **{"duration": 6.0, "instants": 6 * STEPS + 1, "top": "pushed"},
        "top_normal_load": [[0.0, 0.0], [1.0, -3.31e-5]],
        "top_tangential_load": [[1.0, 0.0], [2.0, shear], [4.0, -shear], [6.0, shear]],
    }
    slope = {"elements": 12, "elements_up": 6, "instants": 41}
    caught = "block on a slope, caught by a spring"
    return [
        KnownCase("parabola pressed on a plane", HERTZ, 2e-2, "block", pressed, _pressed),
        KnownCase("parabola sheared to and fro", MINDLIN, 7e-2, "block", sheared, _sheared),
        KnownCase(caught, SLOPE, 1e-7, "incline", slope, _tilted),
        _leaves(are_glued=False),
        _leaves(are_glued=True),
        _two_leaves(),
        _graduated(),
        _shoe(),
        *map(_driven_by_fluid, (0.1, 0.3, 0.5, 0.7, 0.9)),
        _growing_strength(),
        *_walls(),
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
    yield from _partly_slipped(answer)
    (pressing, shear), friction = answer.support, answer.settings.friction
    slip = np.diff(answer.fields.contact("support").slip, axis=1)[:, 2 * STEPS :]
    taken = -np.sum(shear[:, 2 * STEPS + 1 :] * slip)
    total = float(pressing[:, -1].sum())
    share = abs(float(shear[:, -1].sum())) / (friction * total)
    yield "energy of a cycle", "J/m", _half_plane(answer, total).energy(friction, share), taken


def _partly_slipped(answer: Answer) -> Iterator[Number]:
    """What sticks as the shear has its first peak.

    Its half-width from the second moments of pressure and friction, as of two square roots: a count
    of nodes would be coarse.
    """
    pressing, shear = (np.abs(force[:, 2 * STEPS]) for force in answer.support)
    friction = answer.settings.friction
    lengths, places = _places(answer, pressing)
    total, carried = float(pressing.sum()), friction * float(pressing.sum())
    exact = _half_plane(answer, total)
    share = float(shear.sum()) / carried
    moments = friction * float(places**2 @ pressing) - float(places**2 @ shear)
    found = 2.0 * np.sqrt(moments / (carried - shear.sum()))
    yield "half-width of stick", "m", exact.stuck(share), found
    middle = int(np.argmax(pressing))
    known = float(exact.traction(places[middle : middle + 1], friction, share)[0])
    yield "shear traction in the middle", "Pa", known, shear[middle] / lengths[middle]


def _tilted(answer: Answer) -> Iterator[Number]:
    settings, force = answer.settings, answer.loop_force
    angle = np.radians(loop_of(settings, answer.problem).displacement(answer.fields.displacement))
    down, across = settings.weight * np.sin(angle), settings.weight * np.cos(angle)
    top = int(np.argmax(angle))
    carried = down[top] - settings.friction * across[top]
    yield "force of the spring, up", "N", carried, force[top]
    returning = down + settings.friction * across
    back = top + int(np.argmax(returning[top:] < 0.9 * carried))
    yield "force of the spring, back", "N", returning[back], force[back]


def _leaves(*, are_glued: bool) -> KnownCase:
    pressure = 1e6 if are_glued else 1e5
    values = {
        **{"layers": 3, "friction": 10.0 if are_glued else 0.0, "length": 0.5, "thickness": 0.01},
        **{"elements": 48, "elements_up": 2, "plane": "stress", "instants": 3},
        **{"pressure": pressure, "pressure_load": [[0.0, pressure], [1.0, pressure]]},
        **{"deflection": DEFLECTION, "bend_load": [[0.0, 0.0], [0.5, 0.0], [1.0, DEFLECTION]]},
    }

    def numbers(answer: Answer) -> Iterator[Number]:
        before, bent = answer.loop_force[-2:]
        beams, height = (1, 3 * 0.01) if are_glued else (3, 0.01)
        exact = beams * cantilever(0.5, height, answer.settings.young, answer.settings.poisson)
        yield "bending stiffness", "N/m", exact, abs(bent - before) / DEFLECTION

    title = "three layers that friction glues" if are_glued else "three layers without friction"
    return KnownCase(title, BEAM, 5e-3, "layers", values, numbers)


def _two_leaves() -> KnownCase:
    """Two leaves under a force that goes to twice that of first slip, back and forth."""
    leaves = TwoLeaves(0.5, 0.01, 210e9, 0.0, 0.3 * 2e6)
    peak = 2.0 * leaves.first_slip
    values = {
        **{"layers": 2, "length": 0.5, "thickness": 0.01, "plane": "stress", "poisson": 0.0},
        **{"elements": 32, "instants": 41, "pressure_load": [[0.0, 2e6]], "bending": "force"},
        "bend_load": [[0.0, 0.0], [0.2, peak], [0.6, -peak], [1.0, peak]],
    }

    def numbers(answer: Answer) -> Iterator[Number]:
        loop = loop_of(answer.settings, answer.problem)
        bent, cycle = loop.displacement(answer.fields.displacement), answer.settings.times() >= 0.2
        force = answer.settings.path("bend_load")
        energy = abs(float(np.trapezoid(force[cycle], bent[cycle])))
        yield "energy of a cycle", "J/m", leaves.energy(peak), energy
        yield "largest deflection", "m", leaves.deflection(peak), float(bent.max())

    return KnownCase("spring of two leaves", GOODMAN, 1e-2, "layers", values, numbers)


def _graduated() -> KnownCase:
    """Three leaves of which each is shorter, on each other without friction or pressure."""
    values = {
        **{"layers": 3, "length": 0.5, "thickness": 0.005, "plane": "stress", "friction": 0.0},
        **{"layer_lengths": "graduated", "pressure": 0.0, "elements": 48, "instants": 3},
        **{"bending": "force", "force": 100.0, "bend_load": "ramp"},
    }

    def numbers(answer: Answer) -> Iterator[Number]:
        factor = leaf_spring(np.array([3.0, 2.0, 1.0]))
        assert factor is not None
        exact = factor * cantilever(0.5, 0.005, answer.settings.young, answer.settings.poisson)
        loop = loop_of(answer.settings, answer.problem)
        bent = float(loop.displacement(answer.fields.displacement)[-1])
        yield "stiffness", "N/m", exact, 100.0 / bent

    title = "leaf spring whose leaves touch at their ends"
    return KnownCase(title, LEAVES, 5e-3, "layers", values, numbers)


def _shoe() -> KnownCase:
    """A shoe pressed over its gap, then pushed to 0.99 and 1.01 of what friction holds."""
    length, gap = 0.04, 2e-3
    values = {
        **{"friction": 0.3, "gap": [[0.0, gap], [length, gap]], "spring": 4e6},
        **{"top": "traction", "top_normal_traction": -300e6, "top_normal_load": [[0.0, -300e6]]},
        "right": "traction",
        "right_normal_load": [[1.0, 0.0], [2.0, -178.2e6], [3.0, -181.8e6]],
        **{"duration": 3.0, "instants": 4, "length": length, "height": 0.02, "poisson": 0.0},
        **{"elements": 8, "elements_up": 4, "substructures": 1, "substructures_up": 1},
        "accuracy": 1e-3,
    }

    def numbers(answer: Answer) -> Iterator[Number]:
        pressed, held = (force.sum(axis=0) for force in answer.support)
        yield "normal reaction", "N/m", 12e6, pressed[1]
        yield "friction at 0.99", "N/m", 3.564e6, held[2]
        slip = answer.fields.contact("support").slip[:, 3]
        yield "displacement at 1.01", "m", 9e-3, -slip.mean()

    title = "shoe on a rigid plane (SSNV503)"
    return KnownCase(title, SHOE, 1e-2, "block", values, numbers, PUBLISHED)


def _driven_by_fluid(stress: float) -> KnownCase:
    """A fluid let in until the front has reached its share of the body."""
    exact = front_over_diffusion(stress)
    values = {
        **FAULT,
        "overpressure": FLUID,
        "shear_stress": FRICTION * (PRESSED - stress * FLUID),
        "duration": float(f"{(REACHED * LENGTH / exact) ** 2 / (4.0 * SPREADS):.6g}"),
        "instants": 41,
    }

    def numbers(answer: Answer) -> Iterator[Number]:
        late = slice(answer.settings.instants // 2, None)
        diffused = np.sqrt(4.0 * SPREADS * answer.settings.times()[late])
        place = answer.problem.rubbing["support"].positions
        slip = np.abs(answer.fields.contact("support").slip[:, late])
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


def _growing_strength() -> KnownCase:
    half_length = ZONE * LENGTH / int(FAULT["elements"])
    values = {
        **FAULT,
        "overpressure": 0.0,
        "shear_stress": STRENGTH + DROP,
        "normal_profile": [
            [0.0, 1.0],
            [half_length, 1.0 + DROP / STRENGTH],
            # The last node that slips has no part of its share, half an element, that sticks.
            [half_length * (1.0 + 0.5 / ZONE), 1.0 + DROP / STRENGTH],
            [half_length * (1.0 + 0.501 / ZONE), STUCK],
        ],
        "instants": 1,
    }

    def numbers(answer: Answer) -> Iterator[Number]:
        settings = answer.settings
        stiffness = 0.5 * settings.young / (1.0 - settings.poisson**2)
        place = answer.problem.rubbing["support"].positions
        exact = slip_under_growing_strength(place, half_length, DROP, stiffness)
        slip = 2.0 * np.abs(answer.fields.contact("support").slip[:, -1])
        yield "slip in the middle", "m", exact[0], slip[0]
        yield "slip half-way to the end", "m", exact[ZONE // 2], slip[ZONE // 2]

    title = "slip under a strength that grows from the middle"
    return KnownCase(title, BUERGMANN, 4e-2, "fault", values, numbers, PUBLISHED)


def _walls() -> Iterator[KnownCase]:
    """Piles of single bricks whose top is moved until they slide or tip, and a wall's weight."""
    pressure, unit_weight, length, height, friction = 1e6, 2e4, 0.25, 0.12, 0.3
    pressed, brick = pressure * length, unit_weight * length * height
    common = {
        **{"bond": "stack", "length": length, "height": height, "unit_weight": unit_weight},
        **{"pressure": pressure, "friction": friction, "elements": 8, "elements_up": 4},
        **{"instants": 21, "accuracy": 1e-3},
    }

    def pile(title: str, courses: int, mu: float, way: float, known: Number) -> KnownCase:
        moved = [[0.0, 0.0], [0.25, 0.0], [1.0, way]]
        size = {"bricks": 1, "courses": courses, "friction": mu, "top_load": moved}

        def numbers(answer: Answer) -> Iterator[Number]:
            yield *known[:3], answer.loop_force[-1]

        return KnownCase(title, PILE, 1e-8, "wall", {**common, **size}, numbers)

    slides = friction * (pressed + brick)
    known = "shear force", "N/m", slides, 0.0
    yield pile("pile of two bricks that slides", 2, friction, 3e-4, known)
    # Moments about the toe: what presses, and the weight, have half a length. It ends on one node.
    tips = 0.5 * length * (pressed + 3.0 * brick) / (3.0 * height)
    yield pile("pile of three bricks that tips", 3, 0.9, 3e-3, ("shear force", "N/m", tips, 0.0))

    def carried(answer: Answer) -> Iterator[Number]:
        grounds = [name for name in answer.problem.rubbing if name.startswith("support")]
        force = 0.0
        for name in grounds:
            across = answer.fields.contact(name).normal_force
            assert across is not None
            force += float(across[:, -1].sum())
        yield "force on the ground", "N/m", 4.0 * (pressed + 4.0 * brick), force

    values = {**common, "bond": "running", "bricks": 4, "courses": 4, "displacement": 5e-5}
    title, source = "wall in running bond", "Balance: the ground carries what weighs and presses"
    yield KnownCase(title, source, 1e-8, "wall", values, carried)
