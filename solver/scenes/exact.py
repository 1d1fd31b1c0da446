"""Closed forms of rods and of bodies in the plane, as curves for their plots."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from solver.arrays import Array
from solver.discrete.plane.rectangles.rigid_stack import rigid_slide, wrench
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.probes import LoopFields
from solver.discrete.problem import Problem
from solver.discrete.rods.rods import Rods
from solver.laws import FrictionLaw, SlipFactor
from solver.reference.closed_forms import ExactCurve
from solver.reference.closed_forms.elastic_bodies import (
    HalfPlane,
    TwoLeaves,
    cantilever,
    leaf_spring,
)
from solver.reference.closed_forms.masing import masing
from solver.reference.closed_forms.pulled_bar import (
    closed_form,
    pulled_changing_bar,
    pulled_compliant_bar,
)

SMALL = 0.12
"""Largest half-width of a contact, over the length and the height of its body, for
which a half-plane holds: to some 2 % (tests/reference/test_hertz_and_cattaneo.py)."""
UNCOUPLED = 0.49
"""Smallest Poisson's ratio, in plane strain, for which pressure and friction on a rigid
support are taken as uncoupled."""
RIGID = 50.0
"""Smallest ratio of the slide of a body to its largest deformation for which the
deformation is left out: it is 2 % of the slide."""
STEADY = 0.01
"""Largest change of the pressing force, as a share, that counts as none."""


def exact_bar(bar: Rods, problem: Problem) -> Iterator[ExactCurve]:
    """Friction along the bar, and the loop of its end."""
    # Under a known pressure, friction by pressure and cohesion are one known strength.
    law = replace(bar.friction_law, cohesion=0.0, cap=np.inf)
    bar = replace(
        bar, strength=bar.friction_law.bound_before_slip(bar.strength), friction_law=law
    )
    closed = closed_form(bar)
    if closed is not None:
        friction = problem.friction
        density = closed.friction_force / friction.by_point(friction.weights)[:, None]
        yield ExactCurve("friction", bar.nodes, density)
        yield ExactCurve("loop", closed.end_displacement, bar.load)
    elif _is_even(bar) and law == FrictionLaw(stiffness=law.stiffness):
        given = bar.length, bar.stiffness, float(bar.strength[0]), law.stiffness
        grown = masing(bar.load, lambda force: pulled_compliant_bar(force, *given)[0])
        yield ExactCurve("loop", grown, bar.load)
    elif (
        _is_even(bar)
        and law.slip_factor
        and law == FrictionLaw(slip_factor=law.slip_factor)
    ):
        yield from _grown(bar, law.slip_factor)


def _grown(bar: Rods, slip_factor: SlipFactor) -> Iterator[ExactCurve]:
    """Loop under a growing load, while friction changes at every slipping point.

    Where friction softens, the load must stay below the largest one that the bar bears.
    """
    (_, slip_length, *_) = slip_factor.slips
    (_, ratio, *_) = slip_factor.factors
    strength = float(bar.strength[0])
    slope = abs(ratio - 1.0) / slip_length
    if not slope or np.any(np.diff(bar.load, prepend=0.0) < 0.0):
        return
    gamma = np.sqrt(strength * slope / bar.stiffness)
    share = float(bar.load[-1]) * gamma / strength
    if ratio > 1.0:
        zone = np.arcsinh(share)
    else:
        zone = np.arcsin(min(share, 1.0))
    if (share >= 1.0 and ratio < 1.0) or zone > gamma * bar.length:
        return
    given = bar.stiffness, strength, ratio, slip_length
    end = np.array([pulled_changing_bar(force, *given) for force in bar.load.tolist()])
    if end[-1] <= slip_length:
        yield ExactCurve("loop", end, bar.load)


def _is_even(bar: Rods) -> bool:
    """Check whether the bar is uniform, and only a force at its end moves it."""
    is_uniform = (
        bar.section is None and bar.strength.ndim == 1 and not np.ptp(bar.strength)
    )
    return bar.is_only_pulled and is_uniform


def _is_coulombs(body: Stack) -> bool:
    """Check whether friction on the support is Coulomb's, mu N, with a uniform mu."""
    assert body.support is not None
    return body.friction_law == FrictionLaw() and not np.ptp(body.support.friction)


def is_coupled(poisson: float, state: str) -> bool:
    """Check whether pressure and friction on a rigid support are coupled.

    Plane stress is plane strain with Poisson's ratio nu / (1 + nu), a third at most.
    """
    if state == "stress":
        poisson = poisson / (1.0 + poisson)
    return poisson < UNCOUPLED


def contact_modulus(young: float, poisson: float, state: str) -> float:
    """Modulus of a body that is pressed along a line, in the unit of E."""
    if state == "stress":
        return young
    return young / (1.0 - poisson**2)


def exact_parabola(
    body: Stack, radius: float, problem: Problem, solution: LoopFields
) -> Iterator[ExactCurve]:
    """Pressure of Hertz, friction of Cattaneo and Mindlin, for a solution's forces."""
    positions = problem.contacts["support"].positions
    contact = solution.contact("support")
    assert contact.normal_force is not None
    assert body.support is not None
    total = contact.normal_force.sum(axis=0)
    largest = float(total.max())
    friction = float(np.max(body.support.friction))
    if friction and is_coupled(body.poisson, body.state):
        return
    if largest <= 0.0 or not _is_coulombs(body):
        return
    modulus = contact_modulus(body.young, body.poisson, body.state)
    half_width = HalfPlane(largest, radius, modulus).half_width
    if half_width > SMALL * min(body.length, body.height):
        return
    pressure = hertz(positions, contact.normal_force, radius, modulus)
    yield ExactCurve("pressure", positions, pressure)
    shear = contact.tangential_force.sum(axis=0)
    begins = _begins(shear, total, friction)
    if begins is not None:
        steady = float(total[begins:].mean())
        middle = float(positions @ contact.normal_force[:, -1] / total[-1])
        exact = HalfPlane(steady, radius, modulus)
        traction = exact.traction_over(positions - middle, friction, shear)
        yield ExactCurve("friction", positions, traction)


def hertz(
    positions: Array, normal_force: Array, radius: float, modulus: float
) -> Array:
    """Pressure of Hertz about the middle of the forces, (n_points, n_instants), Pa.

    Parameters
    ----------
    positions
        Positions of the points, (n_points,), m.
    normal_force
        Forces of the points, (n_points, n_instants), N.
    radius
        Radius of the parabola, m.
    modulus
        Modulus of the half-plane, Pa.
    """
    total = normal_force.sum(axis=0)
    pressed = np.maximum(total, float(total.max()) * np.finfo(float).eps)
    distances = positions[:, None] - positions @ normal_force / pressed
    pressures = []
    for force, from_middle in zip(pressed, distances.T, strict=True):
        exact = HalfPlane(float(force), radius, modulus)
        pressures.append(exact.pressure(from_middle))
    return np.stack(pressures, axis=1)


def _begins(shear: Array, total: Array, friction: float) -> int | None:
    """Last instant before any shear, if the pressing force is constant afterwards.

    Shear and total pressing force have shape (n_instants,), N.
    """
    acts = np.flatnonzero(np.abs(shear) > STEADY * friction * total.max())
    if not friction or not len(acts):
        return None
    first = max(int(acts[0]) - 1, 0)
    is_steady = np.ptp(total[first:]) <= STEADY * total.max()
    return first if is_steady else None


def exact_on_spring(body: Stack) -> Iterator[ExactCurve]:
    """Shear force of a block that a spring pulls back, as of a rigid block.

    The closed form holds for a block that slides much farther than it is deformed, and
    that no side holds.
    """
    is_held = any(side.is_moved for side in body.sides.values())
    if is_held or body.spring is None or not _is_coulombs(body):
        return
    slide = rigid_slide(body, body.spring)
    pushed, pressed, _ = wrench(body)
    stress = max(
        np.abs(pushed).max() / body.height, np.abs(pressed).max() / body.length
    )
    size = max(body.length, body.height)
    if np.abs(slide).max() < RIGID * stress / body.young * size:
        return
    pull = body.spring.stiffness * np.maximum(-slide - body.spring.slack, 0.0)
    yield ExactCurve("loop", slide, pushed + pull)


def exact_layers(
    body: Stack, problem: Problem, solution: LoopFields | None
) -> Iterator[ExactCurve]:
    """Force that bends layers: separately without friction, or as one beam if stuck."""
    given = body.sides["right"].y
    is_mixed = body.stiffness is not None and np.ptp(body.stiffness)
    if body.state != "stress" or is_mixed:
        return
    if not given.prescribed and not np.any(given.mean):
        return
    leaves = _two_leaves(body)
    if leaves is not None:
        if given.prescribed:
            yield ExactCurve("loop", given.mean, masing(given.mean, leaves.force))
        else:
            grown = masing(body.end_force, leaves.deflection)
            yield ExactCurve("loop", grown, body.end_force)
        return
    stiffness = _elastic_stiffness(body, problem, solution)
    if stiffness is None:
        return
    if given.prescribed:
        yield ExactCurve("loop", given.mean, stiffness * given.mean)
    else:
        yield ExactCurve("loop", body.end_force / stiffness, body.end_force)


def _elastic_stiffness(
    body: Stack, problem: Problem, solution: LoopFields | None
) -> float | None:
    """Bending stiffness of separate layers or of one beam, N/m; else None."""
    law = body.friction_law
    is_plain = law == replace(FrictionLaw(), slip_factor=law.slip_factor)
    is_graduated = bool(np.any(body.relative_lengths < 1.0))
    if is_plain and not np.any(body.friction):
        beams: float | None = 1.0 * len(body.relative_lengths)
        if is_graduated:
            beams = _leaves(body)
        if beams is None:
            return None
        return beams * cantilever(body.length, body.height, body.young, body.poisson)
    if solution is None or np.isfinite([law.stiffness, law.normal_stiffness]).any():
        return None
    if any(solution.contact(name).status.any() for name in problem.contacts):
        return None
    if is_graduated:
        return None
    return cantilever(body.length, body.size[1], body.young, body.poisson)


def _two_leaves(body: Stack) -> TwoLeaves | None:
    """Closed form of two equal leaves under a constant pressure, if it holds."""
    bent = body.sides["right"].y.mean
    given = body.sides["top"].y
    acts = np.flatnonzero(bent)
    is_plain = (
        body.friction_law == FrictionLaw()
        and np.any(body.friction)
        and not given.prescribed
    )
    if (
        not np.array_equal(body.relative_lengths, [1.0, 1.0])
        or not is_plain
        or not len(acts)
    ):
        return None
    pressure = -given.mean[max(acts[0] - 1, 0) :]
    mu = np.asarray(body.friction)
    if np.ptp(pressure) or np.ptp(mu) or pressure[0] <= 0.0:
        return None
    size = body.length, body.height, body.young, body.poisson
    return TwoLeaves(*size, float(mu.flat[0] * pressure[0]))


def _leaves(body: Stack) -> float | None:
    """Stiffness of a leaf spring over that of its longest leaf, or None.

    The closed form is for leaves that grow shorter in the direction of bending, and
    that no pressure holds together.
    """
    bent = body.sides["right"].y.mean
    steps = np.diff(body.relative_lengths)
    grows = np.all(steps < 0.0) and np.all(bent >= 0.0)
    falls = np.all(steps > 0.0) and np.all(bent <= 0.0)
    pressed = any(not body.sides[side].y.is_zero for side in ("top", "bottom"))
    if pressed or not (grows or falls):
        return None
    return leaf_spring(np.sort(body.length * body.relative_lengths)[::-1])
