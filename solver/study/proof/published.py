"""Cases of published numbers: a shoe on a rigid plane, slip on an interface in an infinite body."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.discrete.contact_groups import NO_SLIP
from solver.reference.closed_forms.fluid_driven_slip import (
    front_over_diffusion,
    slip_under_growing_strength,
)
from solver.study.proof.case import PUBLISHED, Answer, KnownCase, KnownNumber

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
    "friction": FRICTION,
    "normal_stress": PRESSED,
    "diffusivity": SPREADS,
    "length": LENGTH,
    "height": LENGTH,
    "elements": 96,
    "elements_up": 48,
    "substructures": 8,
    "substructures_up": 4,
    "accuracy": 1e-3,
}
ZONE, STRENGTH, DROP = 10, FRICTION * PRESSED, 6e5
"""Elements that slip under a strength that grows; that in the middle, and what it grows by, Pa."""
STUCK = 2.0
"""Strength of what must not slip, over that of what may."""


def published_cases() -> Iterator[KnownCase]:
    """Cases, none of them solved yet."""
    yield _shoe()
    for stress in (0.1, 0.3, 0.5, 0.7, 0.9):
        yield _driven_by_fluid(stress)
    yield _growing_strength()


def _shoe() -> KnownCase:
    """Press a shoe over its gap, then push it to 0.99 and 1.01 of what friction holds."""
    length, gap = 0.04, 2e-3
    values = {
        "friction": 0.3,
        "gap": [[0.0, gap], [length, gap]],
        "spring": 4e6,
        "top": "traction",
        "top_normal_traction": -300e6,
        "top_normal_load": [[0.0, -300e6]],
        "right": "traction",
        "right_normal_load": [[1.0, 0.0], [2.0, -178.2e6], [3.0, -181.8e6]],
        "duration": 3.0,
        "instants": 4,
        "length": length,
        "height": 0.02,
        "poisson": 0.0,
        "elements": 8,
        "elements_up": 4,
        "substructures": 1,
        "substructures_up": 1,
        "accuracy": 1e-3,
    }

    def numbers(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
        contact = answer.fields.contact("support")
        assert contact.normal_force is not None
        pressed, held = contact.normal_force.sum(axis=0), contact.tangential_force.sum(axis=0)
        yield KnownNumber("normal reaction", "N/m", 12e6, float(pressed[1]))
        yield KnownNumber("friction at 0.99", "N/m", 3.564e6, float(held[2]))
        yield KnownNumber("displacement at 1.01", "m", 9e-3, float(-contact.slip[:, 3].mean()))

    title = "shoe on a rigid plane (SSNV503)"
    return KnownCase(title, SHOE, 1e-2, "block", values, numbers, PUBLISHED)


def _driven_by_fluid(stress: float) -> KnownCase:
    """Let a fluid in until the front has reached its share of the body."""
    exact = front_over_diffusion(stress)
    values = {
        **FAULT,
        "overpressure": FLUID,
        "shear_stress": FRICTION * (PRESSED - stress * FLUID),
        "duration": float(f"{(REACHED * LENGTH / exact) ** 2 / (4.0 * SPREADS):.6g}"),
        "instants": 41,
    }

    def numbers(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
        late = slice(settings.instants // 2, None)
        diffused = np.sqrt(4.0 * settings.diffusivity * settings.times()[late])
        place = answer.problem.rubbing["support"].positions
        slip = np.abs(answer.fields.contact("support").slip[:, late])
        reached = np.array([_front(place, one) for one in slip.T])
        found = float(reached @ diffused / (diffused @ diffused))
        yield KnownNumber("front over sqrt(4 alpha t)", "-", exact, found)

    title = f"slip front driven by a fluid, T = {stress:g}"
    return KnownCase(title, VIESCA, 1.2e-2, "fault", values, numbers, PUBLISHED)


def _front(place: Array, slip: Array) -> float:
    """Find where slip ends: towards there its power 2/3 falls evenly, as nothing is singular."""
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

    def numbers(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
        stiffness = 0.5 * settings.young / (1.0 - settings.poisson**2)
        place = answer.problem.rubbing["support"].positions
        exact = slip_under_growing_strength(place, half_length, DROP, stiffness)
        slip = 2.0 * np.abs(answer.fields.contact("support").slip[:, -1])
        yield KnownNumber("slip in the middle", "m", float(exact[0]), float(slip[0]))
        half = ZONE // 2
        yield KnownNumber("slip half-way to the end", "m", float(exact[half]), float(slip[half]))

    title = "slip under a strength that grows from the middle"
    return KnownCase(title, BUERGMANN, 4e-2, "fault", values, numbers, PUBLISHED)
