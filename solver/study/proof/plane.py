"""Cases of bodies in the plane: Hertz, Cattaneo and Mindlin, a slope, a leaf spring."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from solver.reference.closed_forms.elastic_bodies import HalfPlane, cantilever
from solver.scenes import loop_of
from solver.study.proof.case import Answer, KnownCase, KnownNumber

JOHNSON = "K. L. Johnson, Contact Mechanics, Cambridge 1985, section"
HERTZ = f"{JOHNSON} 4.2 (Hertz)"
MINDLIN = f"{JOHNSON} 7.2 and 7.4 (Cattaneo, Mindlin)"
SLOPE = "Equilibrium of a rigid block: its weight along the slope, less or more its friction"
BEAM = "J. M. Gere, S. P. Timoshenko, Mechanics of Materials, 1997, section 12: Timoshenko's beam"
DEFLECTION = 1e-4
STEPS = 6
"""Instants of a quarter of a cycle of shear."""


def _half_plane(settings: Any, total: float) -> HalfPlane:
    return HalfPlane(total, settings.radius, settings.young / (1.0 - settings.poisson**2))


def _pressed(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
    law = answer.problem.rubbing["support"]
    force = answer.fields.contact("support").normal_force
    assert force is not None
    force = force[:, -1]
    pressure = force / law.by_point(law.weights[:, None])[:, 0]
    total = float(force.sum())
    exact = _half_plane(settings, total)
    yield KnownNumber("largest pressure", "Pa", exact.peak, float(pressure.max()))
    second = force @ (law.positions - law.positions @ force / total) ** 2 / total
    yield KnownNumber("half-width of contact", "m", exact.half_width, float(2.0 * np.sqrt(second)))


def _sheared(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
    contact = answer.fields.contact("support")
    yield from _partly_slipped(settings, answer)
    slip = np.diff(contact.slip, axis=1)[:, 2 * STEPS :]
    taken = -np.sum(contact.tangential_force[:, 2 * STEPS + 1 :] * slip)
    assert contact.normal_force is not None
    total = float(contact.normal_force[:, -1].sum())
    share = abs(float(contact.tangential_force[:, -1].sum())) / (settings.friction * total)
    exact = _half_plane(settings, total).energy(settings.friction, share)
    yield KnownNumber("energy of a cycle", "J/m", exact, float(taken))


def _partly_slipped(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
    """Compare what sticks as the shear has its first peak.

    Its half-width from the second moments of pressure and friction, as of two square roots: a count
    of nodes would be coarse.
    """
    law, contact = answer.problem.rubbing["support"], answer.fields.contact("support")
    assert contact.normal_force is not None
    pressing, shear = (
        np.abs(one[:, 2 * STEPS]) for one in (contact.normal_force, contact.tangential_force)
    )
    total, carried = float(pressing.sum()), settings.friction * float(pressing.sum())
    exact = _half_plane(settings, total)
    share = float(shear.sum()) / carried
    square = (law.positions - law.positions @ pressing / total) ** 2
    moments = settings.friction * float(square @ pressing) - float(square @ shear)
    found = 2.0 * np.sqrt(moments / (carried - shear.sum()))
    yield KnownNumber("half-width of stick", "m", exact.stuck(share), float(found))
    middle = int(np.argmax(pressing))
    traction = shear[middle] / law.by_point(law.weights[:, None])[middle, 0]
    place = law.positions[middle : middle + 1] - law.positions @ pressing / total
    known = float(exact.traction(place, settings.friction, share)[0])
    yield KnownNumber("shear traction in the middle", "Pa", known, float(traction))


def _tilted(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
    loop = loop_of(settings, answer.problem)
    angle = np.radians(loop.displacement(answer.fields.displacement))
    assert callable(loop.force)
    force = loop.force(answer.fields)
    down, across = settings.weight * np.sin(angle), settings.weight * np.cos(angle)
    top = int(np.argmax(angle))
    carried = down[top] - settings.friction * across[top]
    yield KnownNumber("force of the spring, up", "N", float(carried), float(force[top]))
    returning = down + settings.friction * across
    back = top + int(np.argmax(returning[top:] < 0.9 * carried))
    yield KnownNumber("force of the spring, back", "N", float(returning[back]), float(force[back]))


def _leaves(*, are_glued: bool) -> KnownCase:
    pressure = 1e6 if are_glued else 1e5
    values = {
        "layers": 3,
        "friction": 10.0 if are_glued else 0.0,
        "elements": 48,
        "elements_up": 2,
        "plane": "stress",
        "length": 0.5,
        "thickness": 0.01,
        "pressure": pressure,
        "pressure_load": [[0.0, pressure], [1.0, pressure]],
        "deflection": DEFLECTION,
        "bend_load": [[0.0, 0.0], [0.5, 0.0], [1.0, DEFLECTION]],
        "instants": 3,
    }

    def numbers(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
        force = loop_of(settings, answer.problem).force
        assert callable(force)
        found = np.diff(force(answer.fields)[-2:])[0] / DEFLECTION
        beams, height = (1, 3 * 0.01) if are_glued else (3, 0.01)
        exact = beams * cantilever(0.5, height, settings.young, settings.poisson)
        yield KnownNumber("bending stiffness", "N/m", exact, abs(float(found)))

    title = "three layers that friction glues" if are_glued else "three layers without friction"
    return KnownCase(title, BEAM, 5e-3, "layers", values, numbers)


def plane_cases() -> Iterator[KnownCase]:
    """Cases, none of them solved yet."""
    total = np.pi * 210e9 / (1.0 - 0.3**2) * 0.1**2 / (4.0 * 10.0)
    body = {"gap": "parabola", "radius": 10.0, "length": 1.0, "height": 1.0}
    pressed = {
        **body,
        "elements": 80,
        "elements_up": 80,
        "friction": 0.0,
        "instants": 1,
        "top": "traction",
        "top_normal_traction": -float(f"{total:.6g}"),
    }
    yield KnownCase("parabola pressed on a plane", HERTZ, 2e-2, "block", pressed, _pressed)
    half_width, radius, friction, length = 0.01, 5.0, 0.3, 0.1
    modulus = 210e9 / (1.0 - 0.4999**2)
    shear = float(f"{0.125 * friction * np.pi * modulus * half_width**2 / radius / length:.6g}")
    sheared = {
        "gap": "parabola",
        "radius": radius,
        "length": length,
        "height": length,
        "poisson": 0.4999,
        "friction": friction,
        "elements": 120,
        "elements_up": 60,
        "duration": 6.0,
        "instants": 6 * STEPS + 1,
        "top": "pushed",
        "top_normal_load": [[0.0, 0.0], [1.0, -3.31e-5]],
        "top_tangential_load": [[1.0, 0.0], [2.0, shear], [4.0, -shear], [6.0, shear]],
    }
    yield KnownCase("parabola sheared to and fro", MINDLIN, 7e-2, "block", sheared, _sheared)
    slope = {"elements": 12, "elements_up": 6, "instants": 41}
    yield KnownCase("block on a slope, caught by a spring", SLOPE, 1e-7, "incline", slope, _tilted)
    yield _leaves(are_glued=False)
    yield _leaves(are_glued=True)
