"""Cases of published numbers: a shoe on a rigid plane, slip on an interface in an infinite body."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

import numpy as np
from scipy.special import erfc

from solver.arrays import Array
from solver.discrete.stack.data import Given, Side, Spring, Support
from solver.discrete.stack.stack import Stack
from solver.latin import Accuracy, Auto, Iterations, Latin
from solver.laws.contact import NO_SLIP
from solver.reference.closed_forms.slip_front import (
    front_over_diffusion,
    slip_under_growing_strength,
)
from solver.study.proof.case import Answer, KnownCase, KnownNumber, ProofPart

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
YOUNG, POISSON = 1e9, 0.3
STRENGTH, LOSS, DROP = 1e6, 5e5, 1e5
"""Pa: of the interface, its largest loss by the fluid, the drop of stress in the middle."""
HALF_LENGTH, WIDE = 1.0, 10.0
"""m: of what slips at last, and of the body, along and up, in these; twice as much along with its
mirror image."""
ELEMENTS, INSTANTS = 100, 11
STUCK = 1e3
"""Strength of what must not slip, over that of what may."""


def published_cases() -> Iterator[KnownCase]:
    """Give the cases, none of them solved yet."""
    yield _shoe()
    for stress in (0.3, 0.5, 0.7):
        yield _driven_by_fluid(stress)
    yield _growing_strength()


def _method() -> Latin:
    return Latin(direction=Auto(), stop=Accuracy(0.001) | Iterations(400))


def _case(
    title: str,
    source: str,
    mesh: str,
    allowed: float,
    body: Stack,
    numbers: Callable[[Answer], Iterable[KnownNumber]],
) -> KnownCase:
    """Make a case of a structure that no scene shows."""
    return KnownCase(
        title, source, mesh, allowed, body.discretise, _method, numbers, part=ProofPart.PUBLISHED
    )


def _shoe() -> KnownCase:
    """Press a shoe over its gap, then push it to 0.99 and 1.01 of what friction holds."""
    instants = np.array([1.0, 2.0, 3.0])
    none, pressure = np.zeros(3), np.full(3, 300e6)
    push = np.array([0.0, 178.2e6, 181.8e6])
    length, height, gap = 0.04, 0.02, 2e-3
    shoe = Stack(
        length=length,
        height=height,
        elements=(8, 4),
        substructures=(1, 1),
        young=2.1e11,
        poisson=0.0,
        instants=instants,
        duration=3.0,
        support=Support(np.full(9, gap), 0.3),
        sides={
            "top": Side(Given(False, none), Given(False, -pressure)),
            "right": Side(Given(False, -push), Given(False, none)),
        },
        spring=Spring(0.0, 4e6),
    )

    def numbers(answer: Answer) -> Iterator[KnownNumber]:
        contact = answer.fields.contact("support")
        assert contact.normal_force is not None
        pressed, held = contact.normal_force.sum(axis=0), contact.tangential_force.sum(axis=0)
        yield KnownNumber("normal reaction", "N/m", 12e6, float(pressed[0]))
        yield KnownNumber("friction at 0.99", "N/m", 3.564e6, float(held[1]))
        yield KnownNumber("displacement at 1.01", "m", 9e-3, float(-contact.slip[:, 2].mean()))

    mesh = "8 x 4 elements, 3 instants"
    return _case("shoe on a rigid plane (SSNV503)", SHOE, mesh, 1e-2, shoe, numbers)


def _half_space(shear: float, bound: Array, instants: Array) -> Stack:
    """Make the right upper quarter of a body under uniform shear, on an interface of given bound.

    What lies below is its image turned by half a turn, so that no pressure changes on the
    interface: it slips by twice what this half moves. Left is the other image, which moves along as
    much and across the other way round.
    """
    size = WIDE * HALF_LENGTH
    whole = np.ones(len(instants))
    none, sheared = Given(False, 0.0 * whole), Given(False, shear * whole)
    level = Given(True, 0.0 * whole)
    moved = 2.0 * (1.0 + POISSON) * shear / YOUNG * size
    return Stack(
        length=size,
        height=size,
        elements=(ELEMENTS, ELEMENTS),
        substructures=(5, 5),
        young=YOUNG,
        poisson=POISSON,
        instants=instants,
        duration=1.0,
        support=Support(np.zeros(ELEMENTS + 1), 0.0, bound),
        sides={
            "left": Side(none, level),
            "right": Side(none, sheared),
            "top": Side(Given(True, moved * whole), level),
        },
    )


MESH = f"{ELEMENTS} x {ELEMENTS} elements, the body {WIDE:g} times what slips on either side, "
"""The right upper quarter of what is meant."""


def _driven_by_fluid(stress: float) -> KnownCase:
    exact = front_over_diffusion(stress)
    diffused = np.linspace(0.5, 1.0, INSTANTS) * HALF_LENGTH / exact
    place = np.linspace(0.0, WIDE * HALF_LENGTH, ELEMENTS + 1)
    bound = STRENGTH - LOSS * erfc(place[:, None] / diffused)
    body = _half_space(STRENGTH - stress * LOSS, bound, np.linspace(0.5, 1.0, INSTANTS) ** 2)

    def numbers(answer: Answer) -> Iterator[KnownNumber]:
        slip = np.abs(answer.fields.contact("support").slip)
        fronts = np.array([_front(place, one) for one in slip.T])
        found = float(fronts @ diffused / (diffused @ diffused))
        yield KnownNumber("front over sqrt(4 alpha t)", "-", exact, found)

    title = f"slip front driven by a fluid, T = {stress:g}"
    return _case(title, VIESCA, f"{MESH}{INSTANTS} instants", 2e-2, body, numbers)


def _front(place: Array, slip: Array) -> float:
    """Find where slip ends: towards there its power 2/3 falls evenly, as nothing is singular."""
    last = np.flatnonzero(slip > NO_SLIP * slip.max())[-1]
    near = slice(last - 2, last + 1)
    slope, level = np.polyfit(place[near], slip[near] ** (2.0 / 3.0), 1)
    return float(-level / slope)


def _growing_strength() -> KnownCase:
    place = np.linspace(0.0, WIDE * HALF_LENGTH, ELEMENTS + 1)
    slips = np.arange(ELEMENTS + 1) < round(ELEMENTS / WIDE)
    bound = np.where(slips, STRENGTH + DROP * place / HALF_LENGTH, STUCK * STRENGTH)[:, None]
    body = _half_space(STRENGTH + DROP, bound, np.ones(1))
    stiffness = 0.5 * YOUNG / (1.0 + POISSON) / (1.0 - POISSON)
    exact = slip_under_growing_strength(place, HALF_LENGTH, DROP, stiffness)

    def numbers(answer: Answer) -> Iterator[KnownNumber]:
        slip = 2.0 * np.abs(answer.fields.contact("support").slip[:, -1])
        yield KnownNumber("slip in the middle", "m", float(exact[0]), float(slip[0]))
        half = round(0.5 * ELEMENTS / WIDE)
        yield KnownNumber("slip half-way to the end", "m", float(exact[half]), float(slip[half]))

    title = "slip under a strength that grows from the middle"
    return _case(title, BUERGMANN, f"{MESH}1 instant", 4e-2, body, numbers)
