"""Cases of published numbers: a shoe on a rigid plane, slip on an interface in an infinite body."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from solver.arrays import Array
from solver.laws.contact import NO_SLIP
from solver.reference.closed_forms.slip_front import (
    front_over_diffusion,
    slip_under_growing_strength,
)
from solver.study.proof.case import PUBLISHED, Answer, KnownCase, Number

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


def published_cases() -> list[KnownCase]:
    """Cases, none of them solved yet."""
    return [_shoe(), *map(_driven_by_fluid, (0.1, 0.3, 0.5, 0.7, 0.9)), _growing_strength()]


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
